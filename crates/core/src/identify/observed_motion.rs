//! How fast and how far the axis moved in a measurement.

use crate::measurement::{Complex, Experiment, Harmonic, ResponseKind, half_peak_to_peak};

use super::problem::per_velocity;

/// Largest velocity amplitude of any harmonic of an experiment, velocity units.
pub(super) fn largest_velocity(experiment: &Experiment, kind: ResponseKind) -> f64 {
    let velocities = moving(experiment).map(|h| velocity(h, experiment, kind).norm());
    velocities.fold(0.0, f64::max)
}

/// Largest position amplitude of any harmonic, velocity units times second.
pub(super) fn largest_travel(experiments: &[Experiment], kind: ResponseKind) -> f64 {
    let of = |e: &Experiment| moving(e).map(|h| position(h, e, kind).norm()).fold(0.0, f64::max);
    experiments.iter().map(of).fold(0.0, f64::max)
}

/// Half the peak-to-peak position of the experiment in which that is largest, velocity units times
/// second.
pub(super) fn widest_travel(experiments: &[Experiment], kind: ResponseKind) -> f64 {
    let of = |e: &Experiment| {
        let mut lines = vec![Complex::new(0.0, 0.0); e.highest_harmonic() + 1];
        moving(e).for_each(|h| lines[h.order] = position(h, e, kind));
        half_peak_to_peak(&lines)
    };
    experiments.iter().map(of).fold(0.0, f64::max)
}

fn moving(experiment: &Experiment) -> impl Iterator<Item = &Harmonic> {
    experiment.response.iter().filter(|harmonic| harmonic.order > 0)
}

fn velocity(harmonic: &Harmonic, experiment: &Experiment, kind: ResponseKind) -> Complex {
    harmonic.value / per_velocity(kind, harmonic.order, experiment.omega_rad_s)
}

fn position(harmonic: &Harmonic, experiment: &Experiment, kind: ResponseKind) -> Complex {
    let turn = Complex::new(0.0, harmonic.order as f64 * experiment.omega_rad_s);
    velocity(harmonic, experiment, kind) / turn
}
