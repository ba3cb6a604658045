//! Fine scans over a spatial frequency, for torques that are sinusoidal in the position.
//!
//! Such a torque fits only if its spatial frequency is right to about a radian over the travel: the
//! misfit has a minimum for every radian. So a grid that fine is scanned. At each spatial frequency
//! the first-order responses to the sine and the cosine are computed once, and their sizes follow
//! from linear least squares.

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use crate::effects::{Effect, Range};
use crate::identify::FitSession;

use super::linearization::Linearization;
use super::score_tests::Tried;
use crate::diagnose::residuals::subspace::Subspace;
use crate::observer::Observer;

/// The change of the response by a sine and a cosine of size 1, at one spatial frequency.
pub(crate) struct Pitch {
    pitch: f64,
    changes: DMatrix<f64>,
}

/// The changes at every spatial frequency, beside the linearization's model.
pub(crate) fn pitches(
    session: &FitSession<'_>,
    linearization: &Linearization,
    effect: &'static dyn Effect,
    ranges: &[Range],
) -> Vec<Pitch> {
    let [low, high] = ranges[1].likely;
    let step = session.search().ripple_angle_step_rad / session.widest_travel();
    let next = |pitch: &f64| Some(pitch + step);
    let grid: Vec<f64> =
        std::iter::successors(Some(low), next).take_while(|pitch| *pitch < high).collect();
    let Some(by_torques) = session.torque_changes(&linearization.model) else {
        return Vec::new();
    };
    grid.par_iter()
        .filter_map(|pitch| {
            let settings = [0.0, std::f64::consts::FRAC_PI_2].map(|angle| vec![1.0, *pitch, angle]);
            let changes = by_torques.by(effect, &settings, *pitch)?;
            Some(Pitch { pitch: *pitch, changes: DMatrix::from_columns(&changes) })
        })
        .collect()
}

/// The peaks of the gain over spatial frequency, given the residuals `left`, and the
/// subspace of every spatial frequency. Once the observer cancels, some of these are missing.
pub(crate) fn peaks(
    observer: &dyn Observer,
    linearization: &Linearization,
    left: &DVector<f64>,
    ranges: &[Range],
    pitches: &[Pitch],
) -> (Vec<Tried>, Vec<Subspace>) {
    let spans: Vec<Subspace> = pitches
        .par_iter()
        .filter(|_| !observer.cancelled())
        .map(|pitch| Subspace::of(&linearization.fitted.complements(&pitch.changes)))
        .collect();
    let gains: Vec<f64> = spans.iter().map(|span| span.energy(left)).collect();
    let gain = |i: usize| gains.get(i).copied().unwrap_or(0.0);
    let peak = |i: &usize| gain(*i) >= gain(i + 1) && (*i == 0 || gain(*i) >= gain(i - 1));
    let mut peaks: Vec<usize> = (0..spans.len()).filter(peak).collect();
    peaks.sort_by(|a, b| gain(*b).total_cmp(&gain(*a)));
    let tried = |i: usize| {
        let Pitch { pitch, changes } = &pitches[i];
        let shown = linearization.fitted.complements(changes);
        let sizes = shown.tr_mul(&shown).cholesky()?.solve(&shown.tr_mul(left));
        let size = sizes.norm().min(ranges[0].likely[1]);
        let values = vec![size, *pitch, sizes[1].atan2(sizes[0])];
        let change: DVector<f64> = changes * sizes;
        Some(Tried { values, change, gain: gain(i) })
    };
    (peaks.into_iter().filter_map(tried).collect(), spans)
}

#[cfg(test)]
mod tests {
    use crate::answers::PlantRequest;
    use crate::diagnose::fixtures::{multisine_record, plant};
    use crate::identify::IdentifyRequest;
    use crate::machines::simulator::Effect;
    use crate::observer::Silent;

    // A multisine travels several times as far as its largest line.
    #[test]
    fn a_ripple_is_found_wherever_it_lies_between_two_spatial_frequencies_of_the_grid() {
        let plant_request = Some(PlantRequest { actuator_order: 1 });
        let request = IdentifyRequest { plant: plant_request, ..IdentifyRequest::default() };
        let found = |cycles_per_unit: f64| {
            let values =
                [("amplitude", 0.05), ("cycles_per_unit", cycles_per_unit), ("phase", 1.2)];
            let effect = Effect::new("cogging", values);
            let measurement = multisine_record(plant(), &[effect], None, 7);
            let answer = crate::diagnose::diagnose(&measurement, &request, &Silent).unwrap();
            answer.causes.first().map(|cause| cause.effect.clone())
        };
        for cycles_per_unit in [48.0, 60.0] {
            assert_eq!(found(cycles_per_unit).as_deref(), Some("cogging"), "{cycles_per_unit}");
        }
    }
}
