//! `servoscope simulate`

mod axis;
mod bench;

use std::collections::BTreeMap;
use std::path::PathBuf;

use servoscope_core::effects::{ActiveEffect, check_slots};
use servoscope_core::measurement::ResponseKind;
use servoscope_core::measurement::formats::{MAX_ROWS, write_harmonic_csv};

use super::{Failure, target, terminal};
use axis::Axis;
use bench::{Bench, Noise};

/// Magnitudes where none are given, as multiples of the highest friction level:
/// the lowest moves the axis well, the highest all but hides the friction.
const MAGNITUDES: [f64; 3] = [2.0, 4.0, 8.0];

/// Frequencies where none are given: from and to as multiples of a, and how many.
const FREQUENCIES: (f64, f64, usize) = (0.1, 10.0, 13);

/// Highest harmonic that makes sense: its size has fallen far below any noise.
const MAX_HARMONIC: usize = 1000;

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

/// At which magnitudes and frequencies is measured.
#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Design")]
struct Design {
    /// Magnitudes of the cosine input [default: 2, 4 and 8 times the highest friction level].
    #[arg(long, value_name = "M,…", value_delimiter = ',')]
    magnitudes: Vec<f64>,
    /// Frequencies, each measured at every magnitude, rad/s [default: as --frequency-range].
    #[arg(long, value_name = "W,…", value_delimiter = ',')]
    frequencies_rad_s: Vec<f64>,
    /// COUNT frequencies from LOW to HIGH, rad/s, evenly spaced on a logarithmic axis [default: 13
    /// from a tenth of the pole to ten times the pole].
    #[arg(long, value_name = "LOW:HIGH:COUNT", conflicts_with = "frequencies_rad_s")]
    #[arg(value_parser = frequency_range)]
    frequency_range: Option<Range>,
    /// Highest harmonic measured.
    #[arg(long, value_name = "H", default_value_t = 7)]
    harmonics: usize,
}

/// How noisy the measurement is.
#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Noise")]
struct Scatter {
    /// Standard deviation of the real and imaginary parts of every harmonic, in decibels below the
    /// median of the fundamentals [default: no noise].
    #[arg(long, value_name = "N", conflicts_with = "noise_std", allow_negative_numbers = true)]
    noise_db: Option<f64>,
    /// Standard deviation of the real and imaginary parts of every harmonic, response units
    /// [default: no noise].
    #[arg(long, value_name = "S")]
    noise_std: Option<f64>,
    /// Writes this many repeats of each point, whose mean has that deviation, instead of a column
    /// `std`.
    #[arg(long, value_name = "M")]
    repeats: Option<usize>,
    /// Seed of the noise.
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
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

/// Frequencies from `low` to `high`, rad/s.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Range {
    low_rad_s: f64,
    high_rad_s: f64,
    count: usize,
}

impl Range {
    fn frequencies_rad_s(self) -> Vec<f64> {
        let last = (self.count - 1).max(1) as f64;
        let ratio = self.high_rad_s / self.low_rad_s;
        (0..self.count).map(|i| self.low_rad_s * ratio.powf(i as f64 / last)).collect()
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
    let Design { harmonics, .. } = args.design;
    if !(1..=MAX_HARMONIC).contains(&harmonics) {
        let reason = format!("--harmonics: {harmonics} is outside 1 to {MAX_HARMONIC}");
        return Err(Failure::Input(reason));
    }
    let friction = plant.friction;
    let level = match friction.fs_plus.max(friction.fs_minus) {
        0.0 => 1.0,
        level => level,
    };
    let magnitudes = match args.design.magnitudes.as_slice() {
        [] => MAGNITUDES.map(|factor| factor * level).to_vec(),
        given => positive("--magnitudes", given)?,
    };
    let (from, to, count) = FREQUENCIES;
    let a = plant.viscous_rate_rad_s;
    let usual = Range { low_rad_s: from * a, high_rad_s: to * a, count };
    let frequencies_rad_s = match args.design.frequencies_rad_s.as_slice() {
        [] => args.design.frequency_range.unwrap_or(usual).frequencies_rad_s(),
        given => positive("--frequencies-rad-s", given)?,
    };
    let (noise, repeats) = scatter(&args.scatter)?;
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

fn scatter(asked: &Scatter) -> Result<(Noise, Option<usize>), Failure> {
    let noise = match (asked.noise_db, asked.noise_std) {
        (Some(decibels), _) if !decibels.is_finite() => {
            let reason = format!("--noise-db: {decibels} is not a finite number");
            return Err(Failure::Input(reason));
        }
        (Some(decibels), _) => Noise::Decibels(decibels),
        (None, Some(std)) => Noise::Std(positive("--noise-std", &[std])?[0]),
        (None, None) => Noise::None,
    };
    match asked.repeats {
        Some(0 | 1) => {
            Err(Failure::Input("--repeats: at least 2 are needed to tell the scatter".into()))
        }
        Some(_) if noise == Noise::None => Err(Failure::Input(
            "--repeats: without noise all repeats are the same; add --noise-db or --noise-std"
                .into(),
        )),
        repeats => Ok((noise, repeats)),
    }
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

fn frequency_range(text: &str) -> Result<Range, String> {
    let reason = || "LOW:HIGH:COUNT is needed, such as 1:100:16 (rad/s)".to_owned();
    let [low, high, count] = text.split(':').collect::<Vec<_>>()[..] else { return Err(reason()) };
    let number = |text: &str| text.trim().parse::<f64>().map_err(|_| reason());
    let (low_rad_s, high_rad_s) = (number(low)?, number(high)?);
    let count = count.trim().parse::<usize>().map_err(|_| reason())?;
    if !(low_rad_s > 0.0 && high_rad_s > low_rad_s && high_rad_s.is_finite()) {
        return Err(format!("{low} and {high} are not two positive frequencies, the lower first"));
    }
    if !(2..=MAX_ROWS).contains(&count) {
        return Err(format!("{count} frequencies do not span a range; give at least 2"));
    }
    Ok(Range { low_rad_s, high_rad_s, count })
}

#[cfg(test)]
mod tests {
    use clap::Parser;

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
