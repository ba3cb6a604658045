//! Where a departure lies, in words: magnitudes, frequencies and harmonics.

use super::numbers::{between, short};
use crate::diagnose::residuals::layout::{LAST_HARMONIC, Layout};
use crate::diagnose::residuals::regions::Region;

pub(super) fn magnitudes(layout: &Layout, region: &Region) -> Option<String> {
    let (first, last) = region.magnitudes;
    let top = layout.magnitudes.len() - 1;
    let unit =
        if layout.units.0.is_empty() { String::new() } else { format!(" {}", layout.units.0) };
    let (low, high) = (layout.magnitudes[first][0], layout.magnitudes[last][1]);
    let single = short(low) == short(high);
    let range = match single {
        true => format!("{}{unit}", short(low)),
        false => format!("{} to {}{unit}", short(low), short(high)),
    };
    match (first == 0, last == top) {
        _ if top == 0 => None,
        (true, true) => Some("at every magnitude".into()),
        (true, false) if first == last => Some(format!("at the lowest magnitude ({range})")),
        (false, true) if first == last => Some(format!("at the highest magnitude ({range})")),
        (true, false) => Some(format!("at magnitudes up to {}{unit}", short(high))),
        (false, true) => Some(format!("at magnitudes from {}{unit} up", short(low))),
        (false, false) if single => Some(format!("at magnitude {range}")),
        (false, false) => Some(format!("at magnitudes {range}")),
    }
}

pub(super) fn frequencies(layout: &Layout, region: &Region) -> Option<String> {
    let (first, last) = region.bands;
    let top = layout.bands.len() - 1;
    let (low, high) = (layout.bands[first][0], layout.bands[last][1]);
    // A boundary lies between a frequency inside and one outside.
    let below = || between(layout.bands[last][1], layout.bands[last + 1][0]);
    let above = || between(layout.bands[first - 1][1], layout.bands[first][0]);
    match (first == 0, last == top) {
        _ if top == 0 => None,
        (true, true) => Some("at every frequency".into()),
        _ if high - low <= 1e-6 * high => Some(match (first, last) {
            (0, _) => format!("at the lowest frequency ({} Hz)", short(low)),
            (_, last) if last == top => format!("at the highest frequency ({} Hz)", short(low)),
            _ => format!("at {} Hz", short(low)),
        }),
        (true, false) => Some(format!("below {} Hz", below())),
        (false, true) => Some(format!("above {} Hz", above())),
        (false, false) => Some(format!("between {} and {} Hz", above(), below())),
    }
}

/// The harmonics of a region, and whether the noun is plural.
pub(super) fn harmonics(layout: &Layout, region: &Region) -> (String, bool) {
    let set = &region.harmonics;
    let all_of =
        |keep: &dyn Fn(usize) -> bool| layout.harmonics.iter().filter(|h| keep(**h)).eq(set.iter());
    match set.as_slice() {
        [] => match layout.harmonics.as_slice() {
            [] | [_] => ("the response".into(), false),
            _ => ("the response with all its harmonics".into(), false),
        },
        [single] => (harmonic_name(*single), *single >= LAST_HARMONIC),
        _ if all_of(&|h| h >= 2) => ("the harmonics above the fundamental".into(), true),
        _ if all_of(&|h| h % 2 == 0) => ("the mean and the even harmonics".into(), true),
        _ if all_of(&|h| h % 2 == 0 && h > 0) => ("the even harmonics".into(), true),
        _ => ("the odd harmonics above the fundamental".into(), true),
    }
}

fn harmonic_name(harmonic: usize) -> String {
    const ORDINALS: [&str; 9] =
        ["second", "third", "fourth", "fifth", "sixth", "seventh", "eighth", "ninth", "tenth"];
    match harmonic {
        0 => "the mean".into(),
        1 => "the fundamental".into(),
        2..=10 => format!("the {} harmonic", ORDINALS[harmonic - 2]),
        _ => format!("the harmonics from {harmonic} up"),
    }
}
