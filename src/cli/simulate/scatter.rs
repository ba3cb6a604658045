//! How noisy a measurement is, as asked for.

use crate::cli::Failure;

use super::bench::Noise;
use super::positive;

/// How noisy the measurement is.
#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Noise")]
pub(super) struct Scatter {
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
    pub(super) seed: u64,
}

impl Scatter {
    /// The noise, and how many repeats tell of it.
    pub(super) fn noise(&self) -> Result<(Noise, Option<usize>), Failure> {
        let noise = match (self.noise_db, self.noise_std) {
            (Some(decibels), _) if !decibels.is_finite() => {
                let reason = format!("--noise-db: {decibels} is not a finite number");
                return Err(Failure::Input(reason));
            }
            (Some(decibels), _) => Noise::Decibels(decibels),
            (None, Some(std)) => Noise::Std(positive("--noise-std", &[std])?[0]),
            (None, None) => Noise::None,
        };
        match self.repeats {
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
}
