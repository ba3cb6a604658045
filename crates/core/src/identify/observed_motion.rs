//! How fast and how far the axis moved in a measurement.

use crate::measurement::{Complex, Experiment, Harmonic, ResponseKind, half_peak_to_peak};

use super::problem::per_velocity;

/// Largest velocity amplitude of any harmonic of an experiment, velocity units.
pub(super) fn largest_velocity(experiment: &Experiment, kind: ResponseKind) -> f64 {
    let velocities = moving(experiment).map(|h| velocity(h, experiment, kind).norm());
    velocities.fold(0.0, f64::max)
}

/// Highest velocity of any experiment, velocity units: under a cosine the largest amplitude of a
/// harmonic, under any other input half the peak-to-peak value. A multisine is several times as fast as
/// any of its lines.
pub(super) fn highest_velocity(experiments: &[Experiment], kind: ResponseKind) -> f64 {
    let of = |e: &Experiment| match e.pure_cosine().is_some() {
        true => largest_velocity(e, kind),
        false => half_range(e, |harmonic, e| velocity(harmonic, e, kind)),
    };
    experiments.iter().map(of).fold(0.0, f64::max)
}

/// Largest position amplitude of any harmonic, velocity units times second.
pub(super) fn largest_travel(experiments: &[Experiment], kind: ResponseKind) -> f64 {
    let of = |e: &Experiment| moving(e).map(|h| position(h, e, kind).norm()).fold(0.0, f64::max);
    experiments.iter().map(of).fold(0.0, f64::max)
}

/// Half the peak-to-peak position of the experiment in which that is largest, velocity units times
/// second.
pub(super) fn widest_travel(experiments: &[Experiment], kind: ResponseKind) -> f64 {
    let of = |e: &Experiment| half_range(e, |harmonic, e| position(harmonic, e, kind));
    experiments.iter().map(of).fold(0.0, f64::max)
}

/// Half the peak-to-peak value of a signal, given its harmonics.
fn half_range(experiment: &Experiment, value: impl Fn(&Harmonic, &Experiment) -> Complex) -> f64 {
    let mut lines = vec![Complex::new(0.0, 0.0); experiment.highest_harmonic() + 1];
    moving(experiment).for_each(|h| lines[h.order] = value(h, experiment));
    half_peak_to_peak(&lines)
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
