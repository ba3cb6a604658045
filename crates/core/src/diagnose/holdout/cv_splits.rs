//! Splits of a measurement for cross-validation.
//!
//! Repeats and periods of one excitation measure the same response again: holding them out would
//! test only the noise. So whole frequencies are held out, at every magnitude, or blocks of lines
//! of time records, or magnitudes.

use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::TAU;
use std::ops::Range;

use crate::measurement::{Experiment, Measurement};

use super::heldout_predictions::{FEWEST_LINES, Row, block};

/// Largest number of parts (folds).
const MOST_PARTS: usize = 4;

/// Fewest frequencies (or blocks of lines) and fewest magnitudes of which some can be held out.
const FEWEST_LEVELS: [usize; 2] = [5, 3];

/// Fewest groups from which the interval of a gain can be estimated.
const FEWEST_GROUPS: usize = 3;

/// One fold of the cross-validation.
#[derive(Debug)]
pub(crate) struct CvSplit {
    /// The rows that are held out, each with its group: a frequency, a block of lines, or (where
    /// magnitudes are held out) an experiment.
    pub rows: BTreeMap<Row, usize>,
}

/// All folds.
#[derive(Debug)]
pub(crate) struct CvSplits {
    /// The folds.
    pub parts: Vec<CvSplit>,
    /// What is held out, in words.
    pub what: String,
}

/// A scheme that divides a measurement; `None` where it does not apply.
type Scheme = fn(&[Experiment]) -> Option<Division>;

/// All schemes; the first that applies is used.
const SCHEMES: [Scheme; 3] = [frequencies, lines, magnitudes];

/// The rows that can be held out, and a description. The lowest and the highest level are not among
/// them: an effect with a threshold cannot be predicted outside the fitted range.
struct Division {
    places: BTreeMap<Row, Place>,
    what: String,
}

/// The place of a row.
#[derive(Debug, Clone, Copy)]
struct Place {
    /// Index of its frequency, block or magnitude. A level is held out together; neighbouring
    /// levels are in different parts.
    level: usize,
    /// Its group.
    group: usize,
}

impl CvSplit {
    /// Whether a harmonic of an experiment is held out.
    pub fn holds(&self, experiment: usize, order: usize) -> bool {
        self.rows.contains_key(&(experiment, order))
    }

    /// Whether any harmonic of an experiment is held out.
    pub fn holds_some(&self, experiment: usize) -> bool {
        self.rows.range((experiment, 0)..(experiment + 1, 0)).next().is_some()
    }
}

impl CvSplits {
    /// Divides a measurement by its design alone; `None` where it is too small.
    pub fn of(measurement: &Measurement) -> Option<Self> {
        let experiments = measurement.experiments();
        let Division { places, what } = SCHEMES.iter().find_map(|scheme| scheme(experiments))?;
        let levels: BTreeSet<usize> = places.values().map(|place| place.level).collect();
        let groups: BTreeSet<usize> = places.values().map(|place| place.group).collect();
        if groups.len() < FEWEST_GROUPS {
            return None;
        }
        let parts = MOST_PARTS.min(levels.len());
        let part = |part: usize| {
            let held = places.iter().filter(|(_, place)| place.level % parts == part);
            let rows: BTreeMap<Row, usize> = held.map(|(row, p)| (*row, p.group)).collect();
            CvSplit { rows }
        };
        let what = match parts {
            1 => format!("{what}, predicted from the rest"),
            _ => format!("{what}, in {parts} parts, each predicted from the rest"),
        };
        Some(Self { parts: (0..parts).map(part).collect(), what })
    }

    /// The part in which a harmonic of an experiment is held out, if any.
    pub fn part_of(&self, experiment: usize, order: usize) -> Option<usize> {
        self.parts.iter().position(|fold| fold.holds(experiment, order))
    }
}

/// Holds out frequencies, each at every magnitude; a group is a frequency.
fn frequencies(experiments: &[Experiment]) -> Option<Division> {
    let (levels, of) = levels(experiments, |experiment| experiment.omega_rad_s);
    let inner = inner(levels.len(), FEWEST_LEVELS[0])?;
    let (lowest, highest) = (levels[inner.start] / TAU, levels[inner.end - 1] / TAU);
    Some(Division {
        what: format!(
            "{} frequencies from {lowest:.3} to {highest:.3} Hz, at every magnitude",
            inner.len()
        ),
        places: by_experiment(experiments, &of, inner, |_, level| level),
    })
}

/// Holds out magnitudes; a group is an experiment.
fn magnitudes(experiments: &[Experiment]) -> Option<Division> {
    let (levels, of) = levels(experiments, |experiment| experiment.magnitude);
    let inner = inner(levels.len(), FEWEST_LEVELS[1])?;
    Some(Division {
        what: format!("{} of {} magnitudes", inner.len(), levels.len()),
        places: by_experiment(experiments, &of, inner, |experiment, _| experiment),
    })
}

/// Holds out blocks of neighbouring lines of inputs with many lines; a group is a block.
fn lines(experiments: &[Experiment]) -> Option<Division> {
    let mut blocks = BTreeMap::new();
    for (index, experiment) in experiments.iter().enumerate() {
        let orders = || experiment.response.iter().map(|h| h.order).filter(|order| *order > 0);
        let first = orders().next().filter(|_| orders().count() >= FEWEST_LINES)?;
        let block = |order: usize| block(order as f64 / first as f64);
        blocks.extend(orders().map(|order| ((index, order), block(order))));
    }
    if experiments.iter().all(|experiment| experiment.pure_cosine().is_some()) {
        return None;
    }
    // Low in the band a block may be narrower than the spacing of lines, and contain none.
    let occupied: BTreeSet<usize> = blocks.values().copied().collect();
    let inner = inner(occupied.len(), FEWEST_LEVELS[0])?;
    let place = |(row, block): (Row, usize)| {
        let level = occupied.range(..block).count();
        inner.contains(&level).then_some((row, Place { level, group: level }))
    };
    let places: BTreeMap<Row, Place> = blocks.into_iter().filter_map(place).collect();
    let what = format!("{} lines in {} blocks over the band", places.len(), inner.len());
    Some(Division { places, what })
}

/// All levels but the first and the last; `None` if there are fewer than `fewest`.
fn inner(levels: usize, fewest: usize) -> Option<Range<usize>> {
    (levels >= fewest).then(|| 1..levels - 1)
}

/// Distinct values of a quantity, ascending, and the index of that of each experiment.
fn levels(
    experiments: &[Experiment],
    value: impl Fn(&Experiment) -> f64,
) -> (Vec<f64>, Vec<usize>) {
    let mut levels: Vec<f64> = experiments.iter().map(&value).collect();
    levels.sort_by(f64::total_cmp);
    // Values in files are rounded.
    levels.dedup_by(|b, a| (*b - *a).abs() <= 1e-6 * a.abs());
    let of = experiments.iter().map(|experiment| {
        let value = value(experiment);
        levels.partition_point(|level| *level <= value).saturating_sub(1)
    });
    let of = of.collect();
    (levels, of)
}

fn by_experiment(
    experiments: &[Experiment],
    of: &[usize],
    inner: Range<usize>,
    group: impl Fn(usize, usize) -> usize,
) -> BTreeMap<Row, Place> {
    let mut places = BTreeMap::new();
    for (index, (experiment, level)) in experiments.iter().zip(of).enumerate() {
        if inner.contains(level) {
            let place = Place { level: *level, group: group(index, *level) };
            places.extend(experiment.response.iter().map(|h| ((index, h.order), place)));
        }
    }
    places
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::tests::{exact, noisy};
    use crate::machines::draw::NoiseStatement;
    use crate::measurement::{Complex, Harmonic, Metadata};

    fn measured(experiments: Vec<Experiment>) -> Measurement {
        Measurement::new(Metadata::default(), experiments, Vec::new(), String::new()).unwrap()
    }

    fn rows(measurement: &Measurement) -> Vec<Row> {
        let experiments = measurement.experiments().iter().enumerate();
        experiments.flat_map(|(i, e)| e.response.iter().map(move |h| (i, h.order))).collect()
    }

    /// A record of one period with this number of lines.
    fn record(lines: usize) -> Measurement {
        let mut experiment = exact().remove(0);
        experiment.input = vec![Complex::new(0.1, 0.0); lines + 1];
        let harmonic = |order| Harmonic { order, value: Complex::new(1.0, 0.0), std: None };
        experiment.response = (0..=lines).map(harmonic).collect();
        experiment.repeats = Vec::new();
        measured(vec![experiment])
    }

    #[test]
    fn every_inner_frequency_is_held_out_once_with_all_its_magnitudes_and_repeats() {
        let measurement = noisy(&exact(), NoiseStatement::Repeats(2), 1);
        let splits = CvSplits::of(&measurement).unwrap();
        let mut held: Vec<Row> = Vec::new();
        for fold in &splits.parts {
            held.extend(fold.rows.keys());
            for (index, experiment) in measurement.experiments().iter().enumerate() {
                let same = |other: &&Experiment| other.omega_rad_s == experiment.omega_rad_s;
                let held = |(i, e): (usize, &Experiment)| {
                    e.response.iter().filter(|h| fold.holds(i, h.order)).count()
                };
                let alike = measurement.experiments().iter().enumerate().filter(|(_, e)| same(e));
                let [some, all] = alike.fold([0, 0], |[some, all], (i, e)| {
                    [some + held((i, e)), all + e.response.len()]
                });
                assert_eq!(some, if fold.holds_some(index) { all } else { 0 });
            }
        }
        held.sort_unstable();
        held.dedup();
        // 6 of 8 frequencies are neither the lowest nor the highest.
        assert_eq!(4 * held.len(), 3 * rows(&measurement).len());
        assert!(splits.what.starts_with("6 frequencies from"), "{}", splits.what);
    }

    #[test]
    fn blocks_of_lines_of_a_record_are_held_out_and_its_mean_is_not() {
        let measurement = record(200);
        let splits = CvSplits::of(&measurement).unwrap();
        let mut held: Vec<usize> =
            splits.parts.iter().flat_map(|fold| fold.rows.keys().map(|row| row.1)).collect();
        held.sort_unstable();
        let (first, last) = (held[0], held[held.len() - 1]);
        assert_eq!(held, (first..=last).collect::<Vec<_>>());
        assert!(first == 2 && last > 180, "all but the ends: {first} to {last}");
        for fold in &splits.parts {
            assert!(!fold.holds(0, 0) && fold.holds_some(0));
            // Two neighbouring lines held out in one part belong to the same block.
            let of = |order: usize| fold.rows.get(&(0, order));
            assert!(
                (20..200).all(|k| of(k).is_none() || of(k + 1).is_none_or(|g| g == of(k).unwrap()))
            );
        }
    }

    #[test]
    fn where_frequencies_are_few_a_magnitude_is_held_out_instead() {
        let few = |frequencies: usize| {
            let mut experiments = exact();
            let (slow, _) = levels(&experiments, |experiment| experiment.omega_rad_s);
            experiments.retain(|e| e.omega_rad_s <= slow[frequencies - 1]);
            CvSplits::of(&measured(experiments))
        };
        let splits = few(3).unwrap();
        assert_eq!(splits.what, "1 of 3 magnitudes, predicted from the rest");
        let groups: BTreeSet<usize> = splits.parts[0].rows.values().copied().collect();
        assert_eq!(groups.len(), 3);
        // Two frequencies leave two groups at the held-out magnitude: too few.
        assert!(few(2).is_none());
    }
}
