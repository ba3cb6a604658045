//! An experiment prepared for simulation, with its data in scale.

use super::scales::Scales;
use super::unknown_input::UnknownInput;
use crate::measurement::{ChannelRange, Complex, Experiment, Loop, Metadata, ResponseKind};
use crate::simulate::Excitation;

/// One datum: a harmonic of the response.
#[derive(Debug, Clone, Copy)]
pub(in super::super) struct Target {
    /// Harmonic k.
    pub order: usize,
    /// Measured value, in scale.
    pub value: Complex,
    /// Factor from velocity to response: 1 (velocity), 1/(jkω) (position) or jkω (acceleration), in
    /// scale.
    pub per_velocity: Complex,
    /// Whether only the real part is compared (harmonic 0).
    pub real: bool,
    /// Whether this is not a datum but the constraint of the mean velocity of a position.
    pub constraint: bool,
}

/// One experiment, ready for simulation.
#[derive(Debug, Clone)]
pub(in super::super) struct Prepared {
    /// The input, in scale.
    pub excitation: Excitation,
    /// Highest harmonic that is compared.
    pub highest: usize,
    /// The harmonics that are compared.
    pub targets: Vec<Target>,
    /// The range of the channel of the response, if it cuts off, in scale.
    pub range: Option<ChannelRange>,
    /// Whether it is not known exactly how far a position ends its period from where it began.
    pub unknown_jump: bool,
    /// What is not known of the input.
    pub unknown_input: UnknownInput,
}

/// Factor from velocity to response at harmonic k of the fundamental frequency `omega`.
pub(in super::super) fn per_velocity(kind: ResponseKind, k: usize, omega: f64) -> Complex {
    let s = Complex::new(0.0, k as f64 * omega);
    match kind {
        ResponseKind::Velocity => Complex::new(1.0, 0.0),
        ResponseKind::Position => 1.0 / s,
        ResponseKind::Acceleration => s,
    }
}

pub(super) fn prepare(
    experiment: &Experiment,
    kind: ResponseKind,
    scales: &Scales,
    response_scale: f64,
    run_share: f64,
) -> Prepared {
    let omega = experiment.omega_rad_s / scales.omega;
    let input = experiment.input.iter().map(|u| u / scales.input).collect();
    let mut targets: Vec<Target> = experiment
        .response
        .iter()
        .filter(|harmonic| harmonic.order > 0 || kind == ResponseKind::Velocity)
        .map(|harmonic| Target {
            order: harmonic.order,
            value: harmonic.value / response_scale,
            per_velocity: per_velocity(kind, harmonic.order, omega),
            real: harmonic.order == 0,
            constraint: false,
        })
        .collect();
    if kind == ResponseKind::Position && experiment.input_mean_measured {
        // The mean velocity is known, mostly 0. That constrains the friction only if the mean of
        // the input was measured; otherwise the offset that balanced the friction is unknown.
        let value = Complex::new(experiment.mean_velocity / scales.velocity, 0.0);
        let one = Complex::new(1.0, 0.0);
        targets
            .insert(0, Target { order: 0, value, per_velocity: one, real: true, constraint: true });
    }
    let highest = targets.last().map_or(0, |target| target.order);
    let excitation = Excitation::new(omega, input).at_run_share(run_share);
    let range = experiment.range.map(|range| range.scaled(1.0 / response_scale));
    let unknown_input = UnknownInput::along(&experiment.unknown_input, scales.input);
    Prepared { excitation, highest, targets, range, unknown_jump: false, unknown_input }
}

/// Whether a single period of a position was recorded of an axis that no loop holds.
pub(super) fn has_unknown_jump(experiment: &Experiment, metadata: &Metadata) -> bool {
    experiment.from_record
        && experiment.repeats.is_empty()
        && metadata.response_kind == ResponseKind::Position
        && metadata.feedback != Some(Loop::Closed)
}
