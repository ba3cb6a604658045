//! Faults as they are answered, without their sentences.

use nalgebra::DVector;

use crate::answers::{FaultKind, LeftOutRow, MeasurementFault};
use crate::diagnose::residuals::layout::Cell;
use crate::measurement::Complex;

use super::candidates::{Candidate, Place};

/// Half the width of a 95 % interval, in standard deviations.
const HALF_WIDTH: f64 = 1.96;

/// Rows that do not belong.
pub(super) fn bad_rows(rows: impl Iterator<Item = LeftOutRow>) -> MeasurementFault {
    MeasurementFault { left_out: rows.collect(), ..MeasurementFault::of(FaultKind::BadRows) }
}

/// A gain that differs by a relative `value`, or a phase that differs by `value` radians.
pub(super) fn sized(kind: FaultKind, value: f64, deviation: f64) -> MeasurementFault {
    let scaled = |value: f64| match kind {
        FaultKind::LevelGain | FaultKind::RunGain => 1.0 + value,
        _ => value.to_degrees(),
    };
    let ends = [-HALF_WIDTH, HALF_WIDTH].map(|width| scaled(value + width * deviation));
    MeasurementFault {
        value: Some(scaled(value)),
        interval95: Some(ends),
        ..MeasurementFault::of(kind)
    }
}

/// A response ahead of its input by a time, s.
pub(super) fn timed(seconds: f64, deviation: f64) -> MeasurementFault {
    let ends = [-HALF_WIDTH, HALF_WIDTH].map(|width| seconds + width * deviation);
    let fault = MeasurementFault::of(FaultKind::ChannelSkew);
    MeasurementFault { value: Some(seconds), interval95: Some(ends), ..fault }
}

/// Values that are peak values once multiplied by this factor.
pub(super) fn read_as_peak(factor: f64) -> MeasurementFault {
    MeasurementFault { value: Some(factor), ..MeasurementFault::of(FaultKind::AmplitudeConvention) }
}

/// The fault that a candidate is, with these values of its parameters; the first has this deviation, and
/// standard deviations are `scale` times as large as they are stated.
pub(super) fn found(
    candidate: &Candidate,
    cells: &[Cell],
    values: &DVector<f64>,
    [deviation, scale]: [f64; 2],
) -> MeasurementFault {
    let value = values[0];
    match candidate.place {
        Place::Row { experiment, order } => {
            let cell = cells.iter().find(|c| (c.experiment, c.order) == (experiment, order));
            bad_rows(cell.map(|cell| left_out(cell, values, scale)).into_iter())
        }
        Place::Level(magnitude) => MeasurementFault {
            magnitude: Some(magnitude),
            ..sized(candidate.kind, value, deviation)
        },
        Place::Run(experiment) => MeasurementFault {
            experiment: Some(experiment),
            ..sized(candidate.kind, value, deviation)
        },
        Place::All => {
            let fastest = cells.iter().map(|cell| cell.frequency_hz).fold(0.0, f64::max);
            let per_angle = 1.0 / (std::f64::consts::TAU * fastest);
            timed(value * per_angle, deviation * per_angle)
        }
    }
}

/// What a fault is and where: its kind, its magnitude and its experiment.
pub(super) fn place(fault: &MeasurementFault) -> (FaultKind, Option<f64>, Option<usize>) {
    (fault.fault, fault.magnitude, fault.experiment)
}

/// Adds a fault that was found beside others, which are mended. One of the same kind in the same
/// place is joined with it. Returns whether it is a new one.
pub(super) fn add(faults: &mut Vec<MeasurementFault>, new: MeasurementFault) -> bool {
    let Some(known) = faults.iter_mut().find(|known| place(known) == place(&new)) else {
        faults.push(new);
        return true;
    };
    let is_new = new.fault == FaultKind::BadRows;
    match new.fault {
        FaultKind::BadRows => known.left_out.extend(new.left_out),
        FaultKind::LevelGain
        | FaultKind::RunGain
        | FaultKind::StdFactor
        | FaultKind::AmplitudeConvention => {
            let factor = new.value.unwrap_or(1.0);
            let before = known.value.unwrap_or(1.0);
            let relative = new.interval95.map(|ends| ends.map(|end| end * before));
            known.value = Some(before * factor);
            known.interval95 = relative.or(known.interval95);
        }
        _ => {
            let before = known.value.unwrap_or(0.0);
            let moved = new.interval95.map(|ends| ends.map(|end| end + before));
            known.value = new.value.map(|value| value + before);
            known.interval95 = moved.or(known.interval95);
        }
    }
    is_new
}

/// Adds what remains of the sizes of faults that are known.
pub(super) fn add_all(faults: &mut Vec<MeasurementFault>, remainders: Vec<MeasurementFault>) {
    for remainder in remainders {
        add(faults, remainder);
    }
}

/// Whether the size of a fault is certainly not that of none; so if it has no size.
pub(super) fn is_sure(fault: &MeasurementFault) -> bool {
    !is_within(3.0, fault)
}

/// Whether the size of a fault is that of none to within so many standard deviations; never if it has no
/// size.
pub(super) fn is_within(deviations: f64, fault: &MeasurementFault) -> bool {
    let none = match fault.fault {
        FaultKind::LevelGain | FaultKind::RunGain => 1.0,
        FaultKind::LevelPhase | FaultKind::RunPhase | FaultKind::ChannelSkew => 0.0,
        _ => return false,
    };
    let Some([low, high]) = fault.interval95 else { return false };
    let (middle, half) = (0.5 * (low + high), 0.5 * (high - low) * deviations / HALF_WIDTH);
    (middle - none).abs() <= half
}

/// A row that is left out, by these errors in standard deviations; those are `scale` times as large as
/// they are stated.
fn left_out(cell: &Cell, values: &DVector<f64>, scale: f64) -> LeftOutRow {
    let off = Complex::new(values[0], values.get(1).copied().unwrap_or(0.0));
    let expected = (cell.measured / cell.std - off).norm().max(f64::MIN_POSITIVE);
    let off = off.norm();
    LeftOutRow {
        experiment: cell.experiment,
        harmonic: cell.order,
        repeat: None,
        line: None,
        off: (off / expected).min(f64::MAX),
        sigmas: off / scale,
    }
}

/// Most faults that are accepted together, all rows counted as one; beside effects, one less. With prior
/// odds of one in twenty each, three faults at once, or two and an effect, are less likely than one effect
/// that the library lacks, which they can follow to within noise.
const MOST_ACCEPTED: usize = 2;

/// Whether a fault is found without a model of the machine, or whatever that is.
pub(super) fn is_certain(fault: &MeasurementFault) -> bool {
    use FaultKind::{BadRows, BadSamples, Conjugated, ResponseKind, ReversedSign, SineReference};
    match fault.fault {
        BadSamples | Conjugated | ReversedSign | SineReference | ResponseKind => true,
        BadRows => fault.left_out.iter().all(|row| row.repeat.is_some()),
        _ => false,
    }
}

/// Whether there are more faults than [`MOST_ACCEPTED`] beside those that are certain and, if effects
/// are named, a `std` wrong by a factor, which follows nothing. One experiment that is wrong counts with
/// the rows that are: neither follows what a library lacks over several experiments.
pub(super) fn are_too_many(faults: &[MeasurementFault], beside_effects: bool) -> bool {
    let has_wrong_experiment = faults.iter().any(|fault| fault.experiment.is_some());
    let is_free = |fault: &MeasurementFault| match fault.fault {
        FaultKind::StdFactor => beside_effects,
        FaultKind::BadRows if has_wrong_experiment => true,
        _ => is_certain(fault),
    };
    let counted = faults.iter().filter(|fault| !is_free(fault)).count();
    counted > MOST_ACCEPTED - usize::from(beside_effects)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn factors_of_faults_in_one_place_are_multiplied_and_angles_are_added() {
        let joined = |first: MeasurementFault, second: MeasurementFault| {
            let mut faults = vec![first];
            assert!(!add(&mut faults, second));
            let [fault] = faults.as_slice() else { panic!("{faults:?}") };
            fault.value.unwrap()
        };
        let product = joined(read_as_peak(0.5), read_as_peak(std::f64::consts::SQRT_2));
        // Two roundings.
        assert!((product * std::f64::consts::SQRT_2 - 1.0).abs() < 1e-15, "{product}");
        let phase = |rad| sized(FaultKind::LevelPhase, rad, 0.01);
        let sum = joined(phase(0.1), phase(0.2)).to_radians();
        assert!((sum / 0.3 - 1.0).abs() < 1e-14, "{sum}");
    }

    #[test]
    fn a_remainder_is_small_within_one_deviation_and_a_fault_sure_beyond_three() {
        let of = |deviations: f64| sized(FaultKind::LevelGain, 0.01 * deviations, 0.01);
        assert!(is_within(1.0, &of(0.9)) && is_within(1.0, &of(-0.9)) && !is_within(1.0, &of(1.1)));
        assert!(!is_sure(&of(2.9)) && is_sure(&of(3.1)) && is_sure(&of(-3.1)));
        assert!(is_sure(&read_as_peak(0.5)), "it has no interval");
    }

    #[test]
    fn three_faults_are_too_many_unless_one_of_them_is_certain() {
        let of = |kinds: &[FaultKind]| -> Vec<MeasurementFault> {
            kinds.iter().map(|kind| MeasurementFault::of(*kind)).collect()
        };
        let [gain, phase] = [FaultKind::LevelGain, FaultKind::LevelPhase];
        assert!(!are_too_many(&of(&[gain, phase]), false));
        assert!(are_too_many(&of(&[gain, phase, FaultKind::StdFactor]), false));
        assert!(!are_too_many(&of(&[gain, phase, FaultKind::Conjugated]), false));
    }

    #[test]
    fn wrong_rows_and_one_wrong_experiment_are_no_more_than_one_fault() {
        let row = LeftOutRow {
            experiment: 1,
            harmonic: 1,
            repeat: None,
            line: None,
            off: 0.2,
            sigmas: 20.0,
        };
        let rows = bad_rows(std::iter::once(row));
        let run = |experiment| {
            let experiment = Some(experiment);
            MeasurementFault { experiment, ..MeasurementFault::of(FaultKind::RunGain) }
        };
        assert!(!are_too_many(&[rows.clone(), run(3)], true));
        assert!(are_too_many(&[rows, run(3), run(5)], true));
    }

    #[test]
    fn beside_effects_two_faults_are_too_many_unless_one_of_them_is_the_size_of_the_noise() {
        let of = |kinds: &[FaultKind]| -> Vec<MeasurementFault> {
            kinds.iter().map(|kind| MeasurementFault::of(*kind)).collect()
        };
        let [gain, phase] = [FaultKind::LevelGain, FaultKind::LevelPhase];
        assert!(are_too_many(&of(&[gain, phase]), true));
        assert!(!are_too_many(&of(&[gain, FaultKind::StdFactor]), true));
        assert!(!are_too_many(&of(&[gain]), true));
    }
}
