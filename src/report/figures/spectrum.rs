//! Harmonics of the response, measured, simulated and the noise between them.

mod records;
mod stepped;

use servoscope_core::answers::{ComparedHarmonic, Comparison};

use super::canvas::{Canvas, Marker};
use super::panel::{Key, Look};
use super::series::{has_many_lines, size, unit_or};
use super::text;
use super::{NothingToDraw, Subject, comparison};
use records::records;
use stepped::stepped;

/// Panels at most: a few representative experiments say more than all.
const MOST_PANELS: usize = 4;

/// Decades shown below the largest amplitude, at most.
const MOST_DECADES: f64 = 10.0;

const LEFT: f64 = 64.0;

pub(super) fn draw(subject: &Subject<'_>) -> Result<Canvas, NothingToDraw> {
    let comparison = comparison(subject)?;
    if has_many_lines(comparison) {
        records(subject, comparison)
    } else {
        stepped(subject, comparison)
    }
}

/// Amplitudes from the largest down to a third of the noise or of the smallest.
fn amplitudes<'a>(harmonics: impl Iterator<Item = &'a ComparedHarmonic>) -> [f64; 2] {
    let (mut high, mut low): (f64, f64) = (0.0, f64::INFINITY);
    for harmonic in harmonics {
        let [measured, simulated] = [harmonic.measured, harmonic.simulated].map(size);
        high = high.max(measured).max(simulated);
        let sizes = [measured, simulated, harmonic.std];
        low = sizes.into_iter().filter(|value| *value > 0.0).fold(low, f64::min);
    }
    if high > 0.0 {
        [(low / 2.0).max(high * 10.0_f64.powf(-MOST_DECADES)), high * 2.0]
    } else {
        [0.1, 10.0]
    }
}

fn amplitude_name(comparison: &Comparison) -> String {
    let unit = unit_or(&comparison.response_unit, "response units");
    text::shorten(&format!("Amplitude ({unit})"), 11.5, 200.0)
}

fn keys(comparison: &Comparison) -> Vec<Key> {
    let noise =
        if comparison.std_estimated { "std, estimated from the residual" } else { "noise (std)" };
    vec![
        Key::new(Look::Marker(Marker::Circle), "key", "measured").toggling("measured"),
        Key::new(Look::Line("bar"), "key", "simulated").toggling("simulated"),
        Key::new(Look::Line("floor"), "key", noise).toggling("noise"),
    ]
}
