//! What the data says about where parameters can lie: the excited band, and levels of the input.

use super::scales::Scales;
use crate::identify::observed_motion::largest_velocity;
use crate::identify::parameters::Prior;
use crate::measurement::{Complex, EXCITED_SHARE, Experiment, ResponseKind, peak};

/// Peak input of an experiment: its magnitude (half its peak-to-peak value) plus the size of its
/// mean.
pub(super) fn peak_input(experiment: &Experiment) -> f64 {
    let mean = experiment.input.first().map_or(0.0, |u| u.re.abs());
    experiment.magnitude.max(experiment.pure_cosine().map_or(0.0, |u| u.norm())) + mean
}

/// Lowest and highest frequency (rad/s) that is both excited and observed.
pub(super) fn excited_band(experiment: &Experiment) -> (f64, f64) {
    let lines = experiment.input.iter().enumerate().skip(1);
    let largest = lines.clone().map(|(_, u)| u.norm()).fold(0.0, f64::max);
    let highest = experiment.highest_harmonic().max(1);
    let mut excited = lines
        .filter(|(k, u)| *k <= highest && u.norm() > EXCITED_SHARE * largest)
        .map(|(k, _)| k as f64 * experiment.omega_rad_s);
    let first = excited.next().unwrap_or(experiment.omega_rad_s);
    (first, excited.next_back().unwrap_or(first))
}

/// Largest rate of change of the input of an experiment, input units per second, of its lines up to
/// `omega_high`: those above are noise in most records.
pub(super) fn steepest_input(experiment: &Experiment, omega_high: f64) -> f64 {
    let rate = |(k, u): (usize, &Complex)| {
        let omega = k as f64 * experiment.omega_rad_s;
        // A line at the edge of the band belongs to it.
        if omega < omega_high * (1.0 + 1e-9) { u * Complex::new(0.0, omega) } else { Complex::ZERO }
    };
    let rates: Vec<Complex> = experiment.input.iter().enumerate().map(rate).collect();
    peak(&rates)
}

/// Frequency band and torque levels of the experiments, in scale.
pub(super) fn levels(
    experiments: &[Experiment],
    kind: ResponseKind,
    scales: &Scales,
    (low, high): (f64, f64),
) -> Prior {
    let mut prior = Prior {
        omega_low: low / scales.omega,
        omega_high: high / scales.omega,
        moving_level: f64::INFINITY,
        largest_level: 0.0,
    };
    // Noise gives even a resting axis some velocity. An experiment therefore counts as moving only
    // if its mobility, velocity per torque, is at least 0.02 of the largest one (tuned). The factor
    // 1 + ω/ω_ref makes mobilities comparable over frequency: it undoes the roll-off of a
    // first-order lag with its corner in the middle of the band.
    let mobility = |e: &Experiment| {
        largest_velocity(e, kind) / scales.velocity * (1.0 + e.omega_rad_s / scales.omega)
            / (peak_input(e) / scales.input).max(f64::MIN_POSITIVE)
    };
    let largest_mobility = experiments.iter().map(mobility).fold(0.0, f64::max);
    for experiment in experiments {
        let level = peak_input(experiment) / scales.input;
        prior.largest_level = prior.largest_level.max(level);
        if mobility(experiment) > 0.02 * largest_mobility {
            prior.moving_level = prior.moving_level.min(level);
        }
    }
    prior.moving_level = prior.moving_level.min(prior.largest_level);
    prior
}
