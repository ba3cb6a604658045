//! At which magnitudes, frequencies and harmonics an axis is measured.

use servoscope_core::measurement::formats::MAX_ROWS;
use servoscope_core::plant::Plant;

use crate::cli::Failure;

use super::positive;

/// Magnitudes where none are given, as multiples of the highest friction level:
/// the lowest moves the axis well, the highest all but hides the friction.
pub(super) const MAGNITUDES: [f64; 3] = [2.0, 4.0, 8.0];

/// Frequencies where none are given: from and to as multiples of a, and how many.
const FREQUENCIES: (f64, f64, usize) = (0.1, 10.0, 13);

/// Highest harmonic that makes sense: its size has fallen far below any noise.
const MAX_HARMONIC: usize = 1000;

/// At which magnitudes and frequencies is measured.
#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Design")]
pub(super) struct Design {
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

impl Design {
    /// Highest harmonic.
    pub(super) fn harmonics(&self) -> Result<usize, Failure> {
        let harmonics = self.harmonics;
        if !(1..=MAX_HARMONIC).contains(&harmonics) {
            let reason = format!("--harmonics: {harmonics} is outside 1 to {MAX_HARMONIC}");
            return Err(Failure::Input(reason));
        }
        Ok(harmonics)
    }

    /// Magnitudes, input units, and frequencies, rad/s, for this plant.
    pub(super) fn points(&self, plant: &Plant) -> Result<(Vec<f64>, Vec<f64>), Failure> {
        let friction = plant.friction;
        let level = match friction.fs_plus.max(friction.fs_minus) {
            0.0 => 1.0,
            level => level,
        };
        let magnitudes = match self.magnitudes.as_slice() {
            [] => MAGNITUDES.map(|factor| factor * level).to_vec(),
            given => positive("--magnitudes", given)?,
        };
        let (from, to, count) = FREQUENCIES;
        let a = plant.viscous_rate_rad_s;
        let usual = Range { low_rad_s: from * a, high_rad_s: to * a, count };
        let frequencies_rad_s = match self.frequencies_rad_s.as_slice() {
            [] => self.frequency_range.unwrap_or(usual).frequencies_rad_s(),
            given => positive("--frequencies-rad-s", given)?,
        };
        Ok((magnitudes, frequencies_rad_s))
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
