//! The axis moves in one direction all the time: friction is a constant in such data.

use std::f64::consts::FRAC_PI_4;

use super::finding::Finding;
use crate::measurement::{
    Complex, Experiment, Harmonic, Measurement, ResponseKind, half_peak_to_peak,
};

pub(super) fn check(measurement: &Measurement) -> Option<Finding> {
    let reverses = match measurement.metadata().response_kind {
        ResponseKind::Velocity => velocity_reverses,
        ResponseKind::Position => position_reverses,
        ResponseKind::Acceleration => return None,
    };
    let known: Vec<bool> = measurement.experiments().iter().filter_map(reverses).collect();
    let steady = known.iter().filter(|reverses| !**reverses).count();
    if steady == 0 {
        return None;
    }
    let where_ = match known.len() {
        all if all == steady => "in every experiment".to_owned(),
        all => format!("in {steady} of {all} experiments"),
    };
    Some(Finding {
        sentence: format!(
            "the axis moves in one direction {where_}: its velocity never crosses zero, so that \
             dry friction looks like a constant offset; its levels cannot be separated"
        ),
        remedy:
            "to measure friction, leave out the offset or base motion, so that the axis reverses; \
                 to keep it, state it in the column `bias` (a constant added to the input)"
                .into(),
    })
}

/// Whether the velocity of an experiment changes its sign; `None` if its mean is not known, or if it
/// does not move.
fn velocity_reverses(experiment: &Experiment) -> Option<bool> {
    let mean = experiment.harmonic(0)?.value.re.abs();
    let moving = experiment.response.iter().filter(|harmonic| harmonic.order > 0);
    let largest = moving.map(|harmonic| harmonic.value.norm()).fold(0.0, f64::max);
    // Half the peak-to-peak value is at least π/4 of any harmonic, with equality for a square wave.
    if largest > 0.0 && mean <= FRAC_PI_4 * largest {
        return Some(true);
    }
    let mut harmonics = vec![Complex::ZERO; experiment.highest_harmonic() + 1];
    experiment.response.iter().for_each(|harmonic| harmonics[harmonic.order] = harmonic.value);
    let amplitude = half_peak_to_peak(&harmonics);
    (amplitude > 0.0).then_some(mean <= amplitude)
}

/// The same of a position. Its velocity surely keeps its sign where the mean velocity is larger than
/// all its harmonics |jkωYₖ| together.
fn position_reverses(experiment: &Experiment) -> Option<bool> {
    let velocity = |harmonic: &Harmonic| {
        harmonic.order as f64 * experiment.omega_rad_s * harmonic.value.norm()
    };
    let largest: f64 = experiment.response.iter().map(velocity).sum();
    (largest > 0.0).then_some(experiment.mean_velocity.abs() <= largest)
}
