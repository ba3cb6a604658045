//! Diagnoses a measurement: `cargo run --release -p servoscope-core --example diagnose FILE`.
//!
//! Settings of the search may follow, as `rival_share=0.02 records.single_starts=4`: to see what one
//! of them is worth on a record.

use servoscope_core::answers::Progress;
use servoscope_core::diagnose::diagnose;
use servoscope_core::identify::{IdentifyRequest, SearchSettings};
use servoscope_core::measurement::formats::{Source, read};
use servoscope_core::observer::Observer;

/// Prints how far the computation is, and never cancels it.
struct Terminal;

impl Observer for Terminal {
    fn progress(&self, progress: Progress) {
        eprint!("\r{:3.0} % {:<30}", 100.0 * progress.fraction, progress.stage);
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let path = std::env::args().nth(1).ok_or("give the file of a measurement")?;
    let bytes = std::fs::read(&path)?;
    let measurement = read(&[Source { name: &path, bytes: &bytes }])?;
    let search = changed(std::env::args().skip(2))?;
    let request = IdentifyRequest { search, ..IdentifyRequest::default() };
    let diagnosis = diagnose(&measurement, &request, &Terminal)?;
    eprintln!();
    println!("{:?}: {}", diagnosis.verdict, diagnosis.discrepancy.sentence);
    for cause in &diagnosis.causes {
        println!("cause: {} ({:.1} %)", cause.effect, 100.0 * cause.confidence);
    }
    let model = diagnosis.extended.as_ref().unwrap_or(&diagnosis.base);
    println!("left: {:.3} % of the response", 100.0 * model.fit.nrmse);
    for (name, parameter) in &model.parameters {
        match (parameter.value, parameter.interval95) {
            (Some(value), Some([low, high])) => {
                println!("{name} = {value} {} (95 % from {low} to {high})", parameter.unit);
            }
            (Some(value), None) => println!("{name} = {value} {}, not determined", parameter.unit),
            (None, _) => println!("{name} is not determined"),
        }
    }
    Ok(())
}

/// The settings of the search with these changes, each `NAME=VALUE`.
fn changed(
    changes: impl Iterator<Item = String>,
) -> Result<SearchSettings, Box<dyn std::error::Error>> {
    let mut settings = serde_json::to_value(SearchSettings::default())?;
    for change in changes {
        let (name, value) = change.split_once('=').ok_or("give settings as NAME=VALUE")?;
        let place = settings.pointer_mut(&format!("/{}", name.replace('.', "/")));
        *place.ok_or_else(|| format!("`{name}` is no setting"))? = serde_json::from_str(value)?;
    }
    Ok(serde_json::from_value(settings)?)
}
