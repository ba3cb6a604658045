//! What a measurement would be without its faults.

use std::borrow::Cow;

use crate::answers::{FaultKind, MeasurementFault};
use crate::identify::DatumChange;
use crate::measurement::{
    Complex, Experiment, Intersample, InvalidMeasurement, Measurement, ResponseKind,
};

use super::repeats_left_out::without_repeats;
use super::{bad_samples, clipping};

/// Two magnitudes are the same if they differ by less than this, relative.
const SAME_MAGNITUDE: f64 = 1e-9;

/// Factor of the standard deviation of a row that is left out of a fit.
pub(super) const LEFT_OUT: f64 = 1e100;

/// A measurement without its faults.
pub(super) struct Mended {
    /// The measurement; of the experiments only those of which any row is left.
    pub measurement: Measurement,
    /// The index of each of its experiments in the measurement with the faults.
    pub experiments: Vec<usize>,
}

/// Whether a fault concerns this experiment.
fn concerns(fault: &MeasurementFault, index: usize, experiment: &Experiment) -> bool {
    let same = |magnitude: f64| {
        (magnitude - experiment.magnitude).abs() <= SAME_MAGNITUDE * magnitude.abs()
    };
    fault.magnitude.is_none_or(same) && fault.experiment.is_none_or(|own| own == index)
}

/// The factor by which a fault of the gain, the phase or the convention is undone at a harmonic.
fn factor(fault: &MeasurementFault, experiment: &Experiment, order: usize) -> Complex {
    let value = fault.value.unwrap_or(1.0);
    let turned = |angle: f64| Complex::from_polar(1.0, order as f64 * angle);
    match fault.fault {
        FaultKind::LevelGain | FaultKind::RunGain => Complex::new(1.0 / value, 0.0),
        FaultKind::LevelPhase | FaultKind::RunPhase => turned(-value.to_radians()),
        FaultKind::ChannelSkew => turned(-value * experiment.omega_rad_s),
        FaultKind::ReversedSign => Complex::new(-1.0, 0.0),
        FaultKind::AmplitudeConvention if order > 0 => Complex::new(value, 0.0),
        FaultKind::SineReference if order > 0 => Complex::i().powu((order as u32 - 1) % 4),
        _ => Complex::new(1.0, 0.0),
    }
}

fn mended_value(
    fault: &MeasurementFault,
    experiment: &Experiment,
    k: usize,
    z: Complex,
) -> Complex {
    match fault.fault {
        FaultKind::Conjugated => z.conj(),
        _ => z * factor(fault, experiment, k),
    }
}

fn std_factor(fault: &MeasurementFault, experiment: &Experiment, order: usize) -> f64 {
    match fault.fault {
        FaultKind::StdFactor => fault.value.unwrap_or(1.0),
        _ => factor(fault, experiment, order).norm(),
    }
}

fn leaves_out(fault: &MeasurementFault, experiment: usize, order: usize) -> bool {
    let is_whole = |row: &&crate::answers::LeftOutRow| row.repeat.is_none();
    let mut rows = fault.left_out.iter().filter(is_whole);
    rows.any(|row| (row.experiment, row.harmonic) == (experiment, order))
}

/// How a datum of a session changes where these faults are mended; the faults are none of those
/// that concern how a file is read.
pub(super) fn change(
    faults: &[MeasurementFault],
    experiments: &[Experiment],
    experiment: usize,
    order: usize,
) -> DatumChange {
    let mut change = DatumChange { factor: Complex::new(1.0, 0.0), deviation: 1.0 };
    let own = &experiments[experiment];
    for fault in faults.iter().filter(|fault| concerns(fault, experiment, own)) {
        if fault.fault == FaultKind::AmplitudeConvention {
            // The means instead of the harmonics: with these the gain of a fitted model remains.
            let of_mean = if order == 0 { 1.0 / fault.value.unwrap_or(1.0) } else { 1.0 };
            change.factor *= of_mean;
            change.deviation *= of_mean;
        } else {
            change.factor *= factor(fault, own, order);
            change.deviation *= std_factor(fault, own, order);
        }
        if leaves_out(fault, experiment, order) {
            change.deviation *= LEFT_OUT;
        }
    }
    change
}

/// How the input runs between its samples, if that is one of the faults.
pub(super) fn course(faults: &[MeasurementFault]) -> Option<Intersample> {
    faults.iter().find_map(|fault| match fault.fault {
        FaultKind::HeldInput => Some(Intersample::Hold),
        FaultKind::StraightInput => Some(Intersample::Linear),
        _ => None,
    })
}

/// The measurement without these faults. The indices in the faults are those of this measurement.
///
/// # Errors
/// If nothing is left.
pub(super) fn mended(
    measurement: &Measurement,
    faults: &[MeasurementFault],
) -> Result<Mended, InvalidMeasurement> {
    let mut metadata = measurement.metadata().clone();
    let kinds = faults.iter().filter_map(|fault| fault.response.as_deref());
    if let Some(kind) = kinds.filter_map(named_kind).next_back() {
        metadata.response_kind = kind;
    }
    let (mut experiments, mut indices) = (Vec::new(), Vec::new());
    for (index, experiment) in measurement.experiments().iter().enumerate() {
        if let Some(experiment) = mended_experiment(index, experiment, faults) {
            experiments.push(experiment);
            indices.push(index);
        }
    }
    let notes = measurement.notes().to_vec();
    let measurement =
        Measurement::new(metadata, experiments, notes, measurement.sha256().to_owned())?;
    Ok(Mended { measurement, experiments: indices })
}

/// The experiment without these faults; `None` if no row of it is left.
fn mended_experiment(
    index: usize,
    experiment: &Experiment,
    faults: &[MeasurementFault],
) -> Option<Experiment> {
    let experiment = bad_samples::mended(experiment, faults).unwrap_or(experiment);
    let clipped = clipping::mended(experiment, faults);
    let experiment = clipped.as_ref().unwrap_or(experiment);
    let mut mended = without_repeats(index, experiment, faults);
    for fault in faults.iter().filter(|fault| concerns(fault, index, experiment)) {
        let orders: Vec<usize> = mended.response.iter().map(|harmonic| harmonic.order).collect();
        for repeat in &mut mended.repeats {
            for (z, order) in repeat.response.iter_mut().zip(&orders) {
                *z = mended_value(fault, experiment, *order, *z);
            }
        }
        for harmonic in &mut mended.response {
            let order = harmonic.order;
            harmonic.value = mended_value(fault, experiment, order, harmonic.value);
            harmonic.std = harmonic.std.map(|std| std * std_factor(fault, experiment, order));
        }
    }
    if let Some((course, samples)) = course(faults).zip(mended.open_samples) {
        mended.open_samples = None;
        let repeats = mended.repeats.iter_mut().map(|repeat| &mut repeat.input);
        let unknown = mended.unknown_input.iter_mut();
        for lines in repeats.chain([&mut mended.input]).chain(unknown) {
            lines.iter_mut().enumerate().for_each(|(k, line)| *line *= course.factor(k, samples));
        }
    }
    let keep = |order: usize| !faults.iter().any(|fault| leaves_out(fault, index, order));
    let kept: Vec<bool> = mended.response.iter().map(|harmonic| keep(harmonic.order)).collect();
    retain(&mut mended.response, &kept);
    for repeat in &mut mended.repeats {
        retain(&mut repeat.response, &kept);
    }
    (!mended.response.is_empty()).then_some(mended)
}

fn retain<T>(values: &mut Vec<T>, kept: &[bool]) {
    let mut kept = kept.iter();
    values.retain(|_| *kept.next().unwrap_or(&true));
}

/// The measurement as an answer understands it, with its rows that were left out: what a figure
/// shows beside the model.
///
/// # Errors
/// See [`Measurement::new`].
pub fn as_understood<'m>(
    measurement: &'m Measurement,
    faults: &[MeasurementFault],
) -> Result<Cow<'m, Measurement>, InvalidMeasurement> {
    if faults.is_empty() {
        return Ok(Cow::Borrowed(measurement));
    }
    let measurement = measurement.repeated();
    let shown: Vec<MeasurementFault> = faults
        .iter()
        .map(|fault| MeasurementFault { left_out: Vec::new(), ..fault.clone() })
        .collect();
    Ok(Cow::Owned(mended(&measurement, &shown)?.measurement))
}

fn named_kind(name: &str) -> Option<ResponseKind> {
    Some(match name {
        "velocity" => ResponseKind::Velocity,
        "position" => ResponseKind::Position,
        "acceleration" => ResponseKind::Acceleration,
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::super::fault;
    use super::*;
    use crate::answers::LeftOutRow;
    use crate::diagnose::tests::{exact, noisy};
    use crate::machines::draw::NoiseStatement;

    fn measurement() -> Measurement {
        noisy(&exact(), NoiseStatement::Repeats(3), 1)
    }

    fn row(experiment: usize, harmonic: usize, repeat: Option<usize>) -> MeasurementFault {
        let (line, off, sigmas) = (None, 0.2, 9.0);
        let row = LeftOutRow { experiment, harmonic, repeat, line, off, sigmas };
        fault::bad_rows([row].into_iter())
    }

    #[test]
    fn a_row_that_is_left_out_leaves_the_others_and_its_experiment_only_with_the_last() {
        let before = measurement();
        let orders = |m: &Measurement, index: usize| -> Vec<usize> {
            m.experiments()[index].response.iter().map(|harmonic| harmonic.order).collect()
        };
        let after = mended(&before, &[row(2, 1, None)]).unwrap();
        assert_eq!(orders(&after.measurement, 2), [0, 2, 3, 4, 5]);
        assert_eq!(orders(&after.measurement, 3), orders(&before, 3));
        let all: Vec<MeasurementFault> = (0..6).map(|order| row(2, order, None)).collect();
        let after = mended(&before, &all).unwrap();
        assert_eq!(after.measurement.experiments().len(), before.experiments().len() - 1);
        assert_eq!(after.experiments[..4], [0, 1, 3, 4]);
    }

    #[test]
    fn a_figure_shows_the_rows_that_were_left_out_but_no_other_fault() {
        let before = measurement();
        let faults = [row(2, 1, None), MeasurementFault::of(FaultKind::Conjugated)];
        let shown = as_understood(&before, &faults).unwrap();
        let of = |m: &Measurement| m.experiments()[2].harmonic(1).unwrap().value;
        assert_eq!(of(&shown), of(&before).conj());
        assert!(matches!(as_understood(&before, &[]).unwrap(), Cow::Borrowed(_)));
    }
}
