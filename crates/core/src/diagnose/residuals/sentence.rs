//! Describes departures in words that a test engineer uses.

mod numbers;
mod places;

use super::groups::Sizes;
use super::layout::Layout;
use super::regions::Region;
use numbers::percent;
pub(crate) use numbers::{rounded, short, span};
use places::{frequencies, harmonics, magnitudes};

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
}
