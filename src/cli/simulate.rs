//! `servoscope simulate`

mod axis;
mod bench;
mod design;
mod scatter;

use std::collections::BTreeMap;
use std::path::PathBuf;

use servoscope_core::effects::{ActiveEffect, check_slots};
use servoscope_core::measurement::ResponseKind;
use servoscope_core::measurement::formats::{MAX_ROWS, write_harmonic_csv};

use super::{Failure, target, terminal};
use axis::Axis;
use bench::Bench;
use design::Design;
use scatter::Scatter;

/// Arguments of `simulate`.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    #[command(flatten)]
    axis: Axis,
    /// Adds an effect: its id, and its parameters by name; repeatable. An id alone lists its
    /// parameters, and an unknown id lists all ids.
    #[arg(long = "effect", value_name = "ID:NAME=VALUE,…", value_parser = effect)]
    #[arg(help_heading = "Axis")]
    effects: Vec<ActiveEffect>,
    #[command(flatten)]
    design: Design,
    #[command(flatten)]
    scatter: Scatter,
    /// What is measured.
    #[arg(long, value_name = "KIND", value_enum, default_value_t = Kind::Velocity)]
    #[arg(help_heading = "Output")]
    response: Kind,
    /// Writes this unit of the input to the file.
    #[arg(long, value_name = "UNIT", default_value = "", hide_default_value = true)]
    #[arg(help_heading = "Output")]
    input_unit: String,
    /// Writes this unit of the response to the file.
    #[arg(long, value_name = "UNIT", default_value = "", hide_default_value = true)]
    #[arg(help_heading = "Output")]
    response_unit: String,
    /// File to write [default: standard output].
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    output: Option<PathBuf>,
}

#[derive(Debug, Clone, Copy, PartialEq, clap::ValueEnum)]
enum Kind {
    Velocity,
    Position,
    Acceleration,
}

impl From<Kind> for ResponseKind {
    fn from(kind: Kind) -> Self {
        match kind {
            Kind::Velocity => ResponseKind::Velocity,
            Kind::Position => ResponseKind::Position,
            Kind::Acceleration => ResponseKind::Acceleration,
        }
    }
}

/// Simulates a measurement and writes it as a harmonic table.
pub(super) fn run(args: Args) -> Result<(), Failure> {
    args.output.as_deref().map_or(Ok(()), target::file)?;
    let (measurement, left_out) = bench(&args)?.measure().map_err(Failure::input)?;
    for point in left_out {
        eprintln!("left out: {point}");
    }
    let mut table = Vec::new();
    write_harmonic_csv(&measurement, &mut table).map_err(Failure::other)?;
    match &args.output {
        Some(path) => std::fs::write(path, table)
            .map_err(|error| Failure::Other(format!("{}: {error}", path.display()))),
        None => terminal::print_raw(&table),
    }
}

fn bench(args: &Args) -> Result<Bench, Failure> {
    let plant = args.axis.plant()?;
    let harmonics = args.design.harmonics()?;
    let (magnitudes, frequencies_rad_s) = args.design.points(&plant)?;
    let (noise, repeats) = args.scatter.noise()?;
    let experiments = magnitudes.len().saturating_mul(frequencies_rad_s.len());
    let rows = experiments.saturating_mul(harmonics + 1).saturating_mul(repeats.unwrap_or(1));
    if rows > MAX_ROWS {
        let reason = format!("the table would have {rows} rows; at most {MAX_ROWS} can be read");
        return Err(Failure::Input(reason));
    }
    let together: Vec<_> = args.effects.iter().map(ActiveEffect::effect).collect();
    check_slots(&together).map_err(|error| Failure::Input(format!("--effect: {error}")))?;
    Ok(Bench {
        plant,
        effects: args.effects.clone(),
        magnitudes,
        frequencies_rad_s,
        harmonics,
        response: args.response.into(),
        input_unit: args.input_unit.clone(),
        response_unit: args.response_unit.clone(),
        noise,
        repeats,
        seed: args.scatter.seed,
    })
}

fn positive(flag: &str, values: &[f64]) -> Result<Vec<f64>, Failure> {
    match values.iter().find(|value| !(**value > 0.0 && value.is_finite())) {
        Some(value) => Err(Failure::Input(format!("{flag}: {value} is not a positive number"))),
        None => Ok(values.to_vec()),
    }
}

fn effect(text: &str) -> Result<ActiveEffect, String> {
    let (id, list) = text.split_once(':').unwrap_or((text, ""));
    let mut parameters = BTreeMap::new();
    for assignment in list.split(',').filter(|assignment| !assignment.trim().is_empty()) {
        let parameter = assignment.split_once('=').and_then(|(name, value)| {
            Some((name.trim().to_owned(), value.trim().parse::<f64>().ok()?))
        });
        let Some((name, value)) = parameter else {
            let reason = format!("`{assignment}` is not NAME=VALUE, such as stiffness=0.8");
            return Err(reason);
        };
        if parameters.insert(name.clone(), value).is_some() {
            return Err(format!("`{name}` is given twice"));
        }
    }
    ActiveEffect::from_names(id.trim(), &parameters).map_err(|error| error.to_string())
}

#[cfg(test)]
mod tests {
    use clap::Parser;

    use super::bench::Noise;
    use super::design::MAGNITUDES;
    use super::*;

    #[derive(Parser)]
    struct Line {
        #[command(flatten)]
        args: Args,
    }

    fn asked(line: &str) -> Result<Bench, String> {
        let words = std::iter::once("simulate").chain(line.split_whitespace());
        let line = Line::try_parse_from(words).map_err(|error| error.to_string())?;
        bench(&line.args).map_err(|failure| failure.to_string())
    }

    #[test]
    fn without_flags_it_is_the_first_system_of_the_paper() {
        let bench = asked("").unwrap();
        assert_eq!((bench.plant.viscous_rate_rad_s, bench.plant.constant), (10.0, 10.0));
        assert_eq!(bench.magnitudes, [1.0, 2.0, 4.0]);
        let (first, last) = (bench.frequencies_rad_s[0], bench.frequencies_rad_s[12]);
        assert!((first - 1.0).abs() < 1e-12 && (last - 100.0).abs() < 1e-10, "{first} {last}");
        assert_eq!(bench.noise, Noise::None);
    }

    #[test]
    fn the_design_follows_the_axis() {
        let bench = asked("--pole -3 --fc-plus 20 --fc-minus 10").unwrap();
        assert_eq!(bench.magnitudes, [40.0, 80.0, 160.0]);
        assert!((bench.frequencies_rad_s[12] - 30.0).abs() < 1e-10);
        let without_friction = asked("--fc-plus 0 --fc-minus 0").unwrap();
        assert_eq!(without_friction.magnitudes, MAGNITUDES);
    }

    #[test]
    fn a_range_is_evenly_spaced_on_a_logarithmic_axis() {
        let bench = asked("--frequency-range 1:100:3 --magnitudes 3").unwrap();
        let expected = [1.0, 10.0, 100.0];
        let pairs = bench.frequencies_rad_s.iter().zip(expected);
        assert!(pairs.clone().all(|(found, wanted)| (found / wanted - 1.0).abs() < 1e-12));
        assert_eq!(pairs.len(), 3);
    }

    #[test]
    fn effects_are_given_by_id_and_parameters() {
        let bench = asked(
            "--effect stribeck:fs_over_fc=1.6,stribeck_velocity=0.1 --effect slew_limit:rate=60",
        );
        let effects = bench.unwrap().effects;
        let found: Vec<_> = effects.iter().map(|e| (e.effect().id(), e.values())).collect();
        assert_eq!(found, [("stribeck", &[1.6, 0.1][..]), ("slew_limit", &[60.0][..])]);
        for (line, wanted) in [
            ("--effect friction", "there are static_friction, stribeck"),
            ("--effect spring", "`spring` needs `stiffness`"),
            ("--effect spring:k=1", "it has stiffness"),
            ("--effect spring:stiffness", "is not NAME=VALUE"),
            ("--effect spring:stiffness=1,stiffness=2", "`stiffness` is given twice"),
            (
                "--effect flexible_mode:load_inertia_fraction=0.3,stiffness=9,damping=0.1 \
                 --effect backlash:load_inertia_fraction=0.3,stiffness=9,damping=0.1,gap=0.1",
                "`flexible_mode` and `backlash` cannot act together",
            ),
            ("--effect spring:stiffness=-1", "at least 0"),
        ] {
            let refused = asked(line).unwrap_err();
            assert!(refused.contains(wanted), "{line}: {refused}");
        }
    }

    #[test]
    fn what_cannot_be_simulated_is_refused_by_its_flag() {
        let cases = [
            ("--magnitudes 1,-2", "--magnitudes: -2 is not a positive number"),
            ("--frequencies-rad-s 0", "--frequencies-rad-s: 0"),
            ("--frequencies-rad-s 1 --frequency-range 1:2:3", "cannot be used with"),
            ("--frequency-range 1:2", "LOW:HIGH:COUNT"),
            ("--frequency-range 2:1:5", "the lower first"),
            ("--frequency-range 1:2:1", "at least 2"),
            ("--harmonics 0", "--harmonics: 0 is outside"),
            ("--noise-std 0", "--noise-std: 0"),
            ("--noise-db nan", "--noise-db"),
            ("--repeats 6", "add --noise-db or --noise-std"),
            ("--noise-db 60 --repeats 1", "at least 2"),
            ("--noise-db 60 --repeats 10000", "rows"),
        ];
        for (line, wanted) in cases {
            let refused = asked(line).unwrap_err();
            assert!(refused.contains(wanted), "{line}: {refused}");
        }
    }
}
