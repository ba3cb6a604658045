//! A comparison as figures look at it: by magnitude, by line, in sigmas.

use std::f64::consts::TAU;

use servoscope_core::answers::{ComparedExperiment, ComparedHarmonic, Comparison};

use super::text;

/// Share of the power of an input that its excited lines carry.
const EXCITED_POWER: f64 = 0.99;

/// Excited lines above which an experiment is a record of many lines.
const FEW_LINES: usize = 3;

/// Deviations above which a measured value shows motion.
const SEEN: f64 = 3.0;

/// Relative difference of magnitudes that are meant to be the same.
const SAME: f64 = 1e-6;

/// Size of a complex number given as [re, im].
pub(super) fn size([re, im]: [f64; 2]) -> f64 {
    re.hypot(im)
}

/// Experiments of one magnitude, by frequency.
#[derive(Debug, Clone)]
pub(super) struct Group<'a> {
    pub magnitude: f64,
    pub experiments: Vec<&'a ComparedExperiment>,
}

/// Experiments by magnitude, the smallest first.
pub(super) fn by_magnitude(comparison: &Comparison) -> Vec<Group<'_>> {
    let mut sorted: Vec<&ComparedExperiment> = comparison.experiments.iter().collect();
    sorted.sort_by(|a, b| a.magnitude.total_cmp(&b.magnitude));
    let mut groups: Vec<Group<'_>> = Vec::new();
    for experiment in sorted {
        match groups.last_mut() {
            Some(group) if experiment.magnitude <= group.magnitude * (1.0 + SAME) => {
                group.experiments.push(experiment);
            }
            _ => groups
                .push(Group { magnitude: experiment.magnitude, experiments: vec![experiment] }),
        }
    }
    for group in &mut groups {
        group.experiments.sort_by(|a, b| a.omega_rad_s.total_cmp(&b.omega_rad_s));
    }
    groups
}

/// Frequency of harmonic `order`, hertz.
pub(super) fn frequency_hz(experiment: &ComparedExperiment, order: usize) -> f64 {
    experiment.omega_rad_s * order as f64 / TAU
}

/// Excited harmonics of an experiment, ascending: the strongest lines of its
/// input, as many as carry nearly all its power. What an amplifier adds between
/// and beyond them is too weak for a ratio of response to input.
pub(super) fn excited(experiment: &ComparedExperiment) -> Vec<&ComparedHarmonic> {
    let mut lines: Vec<&ComparedHarmonic> =
        experiment.harmonics.iter().filter(|h| h.order > 0 && size(h.input) > 0.0).collect();
    lines.sort_by(|a, b| size(b.input).total_cmp(&size(a.input)));
    let power: f64 = lines.iter().map(|h| size(h.input).powi(2)).sum();
    let mut carried = 0.0;
    lines.retain(|h| {
        let wanted = carried < EXCITED_POWER * power;
        carried += size(h.input).powi(2);
        wanted
    });
    lines.sort_by_key(|h| h.order);
    lines
}

/// Whether the comparison is of records whose input has many lines.
pub(super) fn has_many_lines(comparison: &Comparison) -> bool {
    comparison.experiments.iter().any(|experiment| excited(experiment).len() > FEW_LINES)
}

/// Whether a measured value shows motion: above the noise, or, where that is a
/// guess from the residual, not zero.
pub(super) fn is_seen(comparison: &Comparison, harmonic: &ComparedHarmonic, largest: f64) -> bool {
    let noise = if comparison.std_estimated { 0.0 } else { SEEN * harmonic.std };
    size(harmonic.measured) > noise.max(1e-9 * largest)
}

/// Largest measured amplitude.
pub(super) fn largest_measured(comparison: &Comparison) -> f64 {
    let harmonics = comparison.experiments.iter().flat_map(|e| &e.harmonics);
    harmonics.map(|h| size(h.measured)).fold(0.0, f64::max)
}

/// Root mean square of the real components of a residual in standard
/// deviations: 1 is noise. `None` without a deviation to compare with.
pub(super) fn sigmas(harmonic: &ComparedHarmonic) -> Option<f64> {
    let [re, im] = [0, 1].map(|i| harmonic.measured[i] - harmonic.simulated[i]);
    let rms = if harmonic.order == 0 { re.abs() } else { re.hypot(im) / f64::sqrt(2.0) };
    let value = rms / harmonic.std;
    (harmonic.std > 0.0 && value.is_finite()).then_some(value)
}

/// A unit as part of a fraction.
pub(super) fn in_fraction(unit: &str) -> String {
    if unit.contains(['/', ' ', '·', '*']) { format!("({unit})") } else { unit.to_owned() }
}

/// A unit, or in words whose unit it is.
pub(super) fn unit_or<'a>(unit: &'a str, words: &'a str) -> &'a str {
    if unit.is_empty() { words } else { unit }
}

/// A magnitude as a label.
pub(super) fn magnitude_label(magnitude: f64, comparison: &Comparison) -> String {
    match comparison.input_unit.as_str() {
        // A bare number would not say what it is the number of.
        "" => format!("magnitude {}", text::number(magnitude, 3)),
        unit => text::quantity(magnitude, 3, &text::shorten(unit, 12.0, 30.0)),
    }
}

/// An experiment as a label: its magnitude, and its number where others have
/// the same.
pub(super) fn experiment_label(experiment: &ComparedExperiment, comparison: &Comparison) -> String {
    let magnitude = experiment.magnitude;
    let label = magnitude_label(magnitude, comparison);
    let same =
        |other: &&ComparedExperiment| (other.magnitude - magnitude).abs() <= SAME * magnitude;
    match comparison.experiments.iter().filter(same).count() {
        0 | 1 => label,
        _ => format!("{label}, no. {}", experiment.experiment + 1),
    }
}

/// `count` things with the right form of the word.
pub(super) fn counted(count: usize, one: &str, many: &str) -> String {
    format!("{count} {}", if count == 1 { one } else { many })
}

/// At most `most` of the indices below `count`, evenly spread, both ends included.
pub(super) fn spread(count: usize, most: usize) -> Vec<usize> {
    if count <= most {
        return (0..count).collect();
    }
    (0..most).map(|i| (i * (count - 1) + (most - 1) / 2) / (most - 1).max(1)).collect()
}

/// A sentence on what the model has no response for, where there is any.
pub(super) fn left_out(comparison: &Comparison) -> Option<String> {
    let count = comparison.unanswered.len();
    let experiments = counted(count, "experiment", "experiments");
    (count > 0).then(|| {
        format!("Left out: {experiments} in which the model does not settle to the input's period.")
    })
}
