//! Diagnoses a measurement: `cargo run --release -p servoscope-core --example diagnose FILE`.

use servoscope_core::answers::Progress;
use servoscope_core::diagnose::diagnose;
use servoscope_core::identify::IdentifyRequest;
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
    let diagnosis = diagnose(&measurement, &IdentifyRequest::default(), &Terminal)?;
    eprintln!();
    println!("{:?}: {}", diagnosis.verdict, diagnosis.discrepancy.sentence);
    for cause in &diagnosis.causes {
        println!("cause: {} ({:.1} %)", cause.effect, 100.0 * cause.confidence);
    }
    let model = diagnosis.extended.as_ref().unwrap_or(&diagnosis.base);
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
