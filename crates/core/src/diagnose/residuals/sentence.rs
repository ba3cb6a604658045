//! Describes departures in words that a test engineer uses.

use super::groups::Sizes;
use super::layout::{LAST_HARMONIC, Layout, Span};
use super::regions::Region;

/// How the measurement departs from the simulation in a region.
pub(crate) struct Departure<'a> {
    /// Mean of |measured|/|simulated| − 1.
    pub relative_size: Option<f64>,
    /// Phase by which the measurement leads, degrees.
    pub phase_deg: Option<f64>,
    /// Mean of measured less simulated, response units; only for harmonic 0.
    pub mean: Option<f64>,
    /// Root mean square in standard deviations of the noise, if those are known.
    pub in_sigmas: Option<f64>,
    /// Sizes of the measured and simulated response and of their difference.
    pub sizes: &'a Sizes,
}

/// Mean excess of the measured over the simulated fundamental, as a share of the simulated one.
pub(crate) struct Change {
    /// In the first third of the runs.
    pub start: f64,
    /// In the last third of the runs.
    pub end: f64,
}

/// Share of the rms departure above which a change of mean, size or phase is mentioned. Tuned.
const MENTIONED_SHARE: f64 = 0.45;

/// The sentence for a region and the departure there.
pub(crate) fn of_region(layout: &Layout, region: &Region, departure: &Departure<'_>) -> String {
    let places = [magnitudes(layout, region), frequencies(layout, region)];
    let mut parts: Vec<String> = places.into_iter().flatten().collect();
    let (what, plural) = harmonics(layout, region);
    parts.push(format!("{what} {}", departure_phrase(layout, departure, plural)));
    let mut sentence = parts.join(", ");
    if let Some(sigmas) = departure.in_sigmas.filter(|sigmas| *sigmas >= 1.05) {
        sentence += &format!(" ({} times the noise)", short(sigmas));
    }
    sentence
}

/// The sentence for a drift of the parameters.
pub(crate) fn of_drift(change: &Change) -> String {
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
fn harmonics(layout: &Layout, region: &Region) -> (String, bool) {
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

fn departure_phrase(layout: &Layout, departure: &Departure<'_>, plural: bool) -> String {
    let is = if plural { "are" } else { "is" };
    let sizes = departure.sizes;
    let unit =
        if layout.units.1.is_empty() { String::new() } else { format!(" {}", layout.units.1) };
    if let Some(mean) = departure.mean.filter(|mean| mean.abs() > MENTIONED_SHARE * sizes.rms_left)
    {
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
    } else if size.abs() > MENTIONED_SHARE * left {
        let word = if size > 0.0 { "larger" } else { "smaller" };
        words.push(format!("{is} {} {word} than simulated", percent(size.abs())));
    }
    if let Some(phase) =
        departure.phase_deg.filter(|p| p.to_radians().abs() > MENTIONED_SHARE * left)
    {
        let verb = if phase > 0.0 { "leads" } else { "lags" };
        words.push(format!("{verb} by {}°", short(phase.abs())));
    }
    if words.is_empty() {
        let verb = if plural { "depart" } else { "departs" };
        return format!("{verb} from the simulation by {} (rms)", percent(left));
    }
    words.join(" and ")
}

/// A number of one digit between two others or, if there is none, of two digits near them.
fn between(low: f64, high: f64) -> String {
    let middle = (low.max(0.25 * high) * high).sqrt();
    let inside = |text: &String| text.parse::<f64>().is_ok_and(|v| v > low && v < high);
    Some(rounded(middle, 1)).filter(inside).unwrap_or_else(|| rounded(middle, 2))
}

fn percent(share: f64) -> String {
    format!("{} %", short(100.0 * share))
}

/// A number with two significant digits, or all of its integer part.
pub(crate) fn short(value: f64) -> String {
    rounded(value, 2)
}

/// A number with this many significant digits, its whole integer part, and no trailing zeros.
pub(crate) fn rounded(value: f64, digits: i32) -> String {
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

/// A class of magnitudes: one number, or the smallest and the largest.
pub(crate) fn span(span: Span) -> String {
    match short(span[0]) == short(span[1]) {
        true => short(span[0]),
        false => format!("{} to {}", short(span[0]), short(span[1])),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Magnitudes 1, 2 and 4 A, 0.1 to 12.8 Hz, harmonics 0 to 5.
    fn layout() -> Layout {
        Layout {
            cells: Vec::new(),
            magnitudes: [1.0, 2.0, 4.0].map(|m| [m, m]).to_vec(),
            bands: (0..8).map(|i| [0.1 * f64::from(1 << i); 2]).collect(),
            harmonics: (0..6).collect(),
            many_lines: false,
            units: ("A".into(), "rad/s".into()),
        }
    }

    fn region(magnitudes: (usize, usize), bands: (usize, usize), harmonics: &[usize]) -> Region {
        Region { magnitudes, bands, harmonics: harmonics.to_vec() }
    }

    /// A simulated response of 1 rad/s rms, of which 0.1 rad/s is left.
    const SIZES: Sizes =
        Sizes { rms_sigmas: 12.3, rms_left: 0.1, rms_measured: 1.0, rms_simulated: 1.0 };

    fn larger(size: f64) -> Departure<'static> {
        Departure {
            relative_size: Some(size),
            phase_deg: None,
            mean: None,
            in_sigmas: Some(12.3),
            sizes: &SIZES,
        }
    }

    #[test]
    fn a_corner_is_said_by_its_ends() {
        let said = |magnitudes, bands| {
            let region = region(magnitudes, bands, &[3]);
            of_region(&layout(), &region, &larger(0.1)).replace(
                ", the third harmonic is 10 % larger than simulated (12 times the noise)",
                "",
            )
        };
        assert_eq!(said((0, 0), (0, 4)), "at the lowest magnitude (1 A), below 2 Hz");
        assert_eq!(said((2, 2), (5, 7)), "at the highest magnitude (4 A), above 2 Hz");
        assert_eq!(said((1, 1), (2, 3)), "at magnitude 2 A, between 0.3 and 1 Hz");
        assert_eq!(
            said((0, 1), (7, 7)),
            "at magnitudes up to 2 A, at the highest frequency (13 Hz)"
        );
        assert_eq!(
            said((1, 2), (0, 0)),
            "at magnitudes from 2 A up, at the lowest frequency (0.1 Hz)"
        );
        assert_eq!(said((0, 2), (0, 7)), "at every magnitude, at every frequency");
        assert_eq!(said((0, 2), (4, 4)), "at every magnitude, at 1.6 Hz");
    }

    #[test]
    fn harmonics_are_said_in_words() {
        let said =
            |harmonics: &[usize]| super::harmonics(&layout(), &region((0, 0), (0, 0), harmonics)).0;
        assert_eq!(said(&[]), "the response with all its harmonics");
        assert_eq!(said(&[0]), "the mean");
        assert_eq!(said(&[1]), "the fundamental");
        assert_eq!(said(&[5]), "the fifth harmonic");
        assert_eq!(said(&[2, 4]), "the even harmonics");
        assert_eq!(said(&[0, 2, 4]), "the mean and the even harmonics");
        assert_eq!(said(&[3, 5]), "the odd harmonics above the fundamental");
        assert_eq!(said(&[2, 3, 4, 5]), "the harmonics above the fundamental");
        let lines = Layout { harmonics: Vec::new(), many_lines: true, ..layout() };
        assert_eq!(super::harmonics(&lines, &region((0, 0), (0, 0), &[])).0, "the response");
    }

    #[test]
    fn a_departure_is_said_by_what_it_mostly_is() {
        let said = |departure: Departure<'_>| departure_phrase(&layout(), &departure, false);
        assert_eq!(said(larger(0.1)), "is 10 % larger than simulated");
        assert_eq!(said(larger(-0.083)), "is 8.3 % smaller than simulated");
        assert_eq!(said(larger(3.2)), "is 4.2 times as large as simulated");
        assert_eq!(said(larger(0.01)), "departs from the simulation by 10 % (rms)");
        let turned = Departure { phase_deg: Some(-5.0), ..larger(0.01) };
        assert_eq!(said(turned), "lags by 5°");
        let both = Departure { phase_deg: Some(4.0), ..larger(0.06) };
        assert_eq!(said(both), "is 6 % larger than simulated and leads by 4°");
        let shifted = Departure { mean: Some(-0.09), ..larger(0.0) };
        assert_eq!(said(shifted), "is 0.09 rad/s below the simulated one");
        let sizes = Sizes { rms_simulated: 0.01, rms_measured: 0.1, ..SIZES };
        let unknown = Departure { relative_size: None, sizes: &sizes, ..larger(0.0) };
        assert_eq!(said(unknown), "is 0.1 rad/s where the simulation has 0.01 rad/s");
        assert_eq!(
            departure_phrase(&layout(), &larger(0.01), true),
            "depart from the simulation by 10 % (rms)"
        );
    }

    #[test]
    fn a_drift_is_said_by_its_ends() {
        assert_eq!(
            of_drift(&Change { start: 0.02, end: -0.031 }),
            "the response falls during the acquisition: its fundamental goes from 2 % above the \
             simulated one in the first third of the runs to 3.1 % below it in the last"
        );
    }

    #[test]
    fn numbers_are_short() {
        let values = [0.0, 0.0123, 0.5, 1.0, 9.96, 12.3, 1234.5, 1.5e-7];
        let said = values.map(short);
        assert_eq!(said, ["0", "0.012", "0.5", "1", "10", "12", "1234", "1.5e-7"]);
        // No number of two digits lies between 52.0 and 52.3.
        assert_eq!([between(0.8, 1.6), between(52.0, 52.3)], ["1", "52"]);
    }
}
