//! Departures in words a test engineer uses.

use super::groups::Sizes;
use super::layout::{Layout, Span};
use super::regions::Region;

/// How the measurement departs from the simulation in a region.
pub(super) struct Departure<'a> {
    /// Mean of |measured|/|simulated| − 1.
    pub relative_size: Option<f64>,
    /// Phase by which the measurement leads, degrees.
    pub phase_deg: Option<f64>,
    /// Mean of measured less simulated, of means.
    pub mean: Option<f64>,
    /// Root mean square in standard deviations, where those are known.
    pub in_sigmas: Option<f64>,
    /// Sizes measured, simulated and left.
    pub sizes: &'a Sizes,
}

/// By which share the fundamental exceeds the simulated one, early and late.
pub(super) struct Change {
    /// In the first third of the runs.
    pub start: f64,
    /// In the last third.
    pub end: f64,
}

/// Share of what departs that its size or phase must make up to be worth naming.
const WORTH: f64 = 0.45;

/// A region and how the measurement departs there.
pub(super) fn of_region(layout: &Layout, region: &Region, departure: &Departure<'_>) -> String {
    let places = [magnitudes(layout, region), frequencies(layout, region)];
    let mut parts: Vec<String> = places.into_iter().flatten().collect();
    let (what, plural) = harmonics(layout, region);
    parts.push(format!("{what} {}", how(layout, departure, plural)));
    let mut sentence = parts.join(", ");
    if let Some(sigmas) = departure.in_sigmas.filter(|sigmas| *sigmas >= 1.05) {
        sentence += &format!(" ({} times the noise)", short(sigmas));
    }
    sentence
}

/// A drift of the parameters.
pub(super) fn of_drift(change: &Change) -> String {
    let verb = if change.end < change.start { "falls" } else { "grows" };
    let side = |offset: f64| {
        let word = if offset < 0.0 { "below" } else { "above" };
        format!("{} {word}", percent(offset.abs()))
    };
    format!(
        "the response {verb} during the acquisition: its fundamental goes from {} the simulated \
         one in the first third of the runs to {} it in the last",
        side(change.start),
        side(change.end)
    )
}

fn magnitudes(layout: &Layout, region: &Region) -> Option<String> {
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

fn frequencies(layout: &Layout, region: &Region) -> Option<String> {
    let (first, last) = region.bands;
    let top = layout.bands.len() - 1;
    let (low, high) = (layout.bands[first][0], layout.bands[last][1]);
    // A boundary lies between what is inside and what is not.
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

/// What departs, and whether it is many.
fn harmonics(layout: &Layout, region: &Region) -> (String, bool) {
    let set = &region.harmonics;
    let all_of =
        |keep: &dyn Fn(usize) -> bool| layout.harmonics.iter().filter(|h| keep(**h)).eq(set.iter());
    match set.as_slice() {
        [] => match layout.harmonics.as_slice() {
            [] | [_] => ("the response".into(), false),
            _ => ("the response with all its harmonics".into(), false),
        },
        [single] => (one(*single), false),
        _ if all_of(&|h| h >= 2) => ("the harmonics above the fundamental".into(), true),
        _ if all_of(&|h| h % 2 == 0) => ("the mean and the even harmonics".into(), true),
        _ if all_of(&|h| h % 2 == 0 && h > 0) => ("the even harmonics".into(), true),
        _ => ("the odd harmonics above the fundamental".into(), true),
    }
}

fn one(harmonic: usize) -> String {
    const ORDINALS: [&str; 9] =
        ["second", "third", "fourth", "fifth", "sixth", "seventh", "eighth", "ninth", "tenth"];
    match harmonic {
        0 => "the mean".into(),
        1 => "the fundamental".into(),
        2..=10 => format!("the {} harmonic", ORDINALS[harmonic - 2]),
        _ => format!("the harmonics from {harmonic} up"),
    }
}

fn how(layout: &Layout, departure: &Departure<'_>, plural: bool) -> String {
    let is = if plural { "are" } else { "is" };
    let sizes = departure.sizes;
    let unit =
        if layout.units.1.is_empty() { String::new() } else { format!(" {}", layout.units.1) };
    if let Some(mean) = departure.mean.filter(|mean| mean.abs() > WORTH * sizes.rms_left) {
        let word = if mean > 0.0 { "above" } else { "below" };
        return format!("{is} {}{unit} {word} the simulated one", short(mean.abs()));
    }
    let Some(size) = departure.relative_size else {
        let [measured, simulated] = [sizes.rms_measured, sizes.rms_simulated].map(short);
        return format!("{is} {measured}{unit} where the simulation has {simulated}{unit}");
    };
    let left = sizes.rms_left / sizes.rms_simulated;
    let mut words = Vec::new();
    if size > 2.0 {
        words.push(format!("{is} {} times as large as simulated", short(1.0 + size)));
    } else if size.abs() > WORTH * left {
        let word = if size > 0.0 { "larger" } else { "smaller" };
        words.push(format!("{is} {} {word} than simulated", percent(size.abs())));
    }
    if let Some(phase) = departure.phase_deg.filter(|p| p.to_radians().abs() > WORTH * left) {
        let verb = if phase > 0.0 { "leads" } else { "lags" };
        words.push(format!("{verb} by {}°", short(phase.abs())));
    }
    if words.is_empty() {
        let verb = if plural { "depart" } else { "departs" };
        return format!("{verb} from the simulation by {} (rms)", percent(left));
    }
    words.join(" and ")
}

/// A number of at most two digits between two others; where they are too close
/// for that, near them.
fn between(low: f64, high: f64) -> String {
    let middle = (low.max(0.25 * high) * high).sqrt();
    let inside = |text: &String| text.parse::<f64>().is_ok_and(|v| v > low && v < high);
    Some(rounded(middle, 1)).filter(inside).unwrap_or_else(|| rounded(middle, 2))
}

fn percent(share: f64) -> String {
    format!("{} %", short(100.0 * share))
}

/// A number as it is said: two significant digits, all of an integer part.
pub(super) fn short(value: f64) -> String {
    rounded(value, 2)
}

/// A number with so many significant digits at least, all of its integer part, and
/// no trailing zeros.
fn rounded(value: f64, digits: i32) -> String {
    if value == 0.0 || !value.is_finite() {
        return format!("{value}");
    }
    let exponent = value.abs().log10().floor() as i32;
    if !(-4..6).contains(&exponent) {
        return format!("{value:.*e}", (digits - 1).max(0) as usize);
    }
    let decimals = (digits - 1 - exponent).max(0) as usize;
    let text = format!("{value:.decimals$}");
    match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
        false => text,
    }
}

/// Where a region of one class of magnitudes is, for a sentence of its own.
pub(super) fn span(span: Span) -> String {
    match short(span[0]) == short(span[1]) {
        true => short(span[0]),
        false => format!("{} to {}", short(span[0]), short(span[1])),
    }
}
