//! The result of a simulation, the reasons why there may be none, and the check of an axis's
//! parameters.

use super::last_motion::LastMotion;
use crate::effects::Axis;
use crate::measurement::Complex;
use crate::plant::Actuator;

/// Why there is no response with the excitation's own period.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum NoResponse {
    /// The motion from rest does not settle to the period of the input.
    #[error("the motion does not settle to the period of the input within {periods} periods")]
    NotPeriodic {
        /// Periods simulated.
        periods: usize,
    },
    /// A transient motion whose switching times accumulate.
    #[error("the motion switches so often that it cannot be followed")]
    Endless,
    /// A parameter is not a finite number or has no physical meaning.
    #[error("the plant has no response: {reason}")]
    Unphysical {
        /// Which parameter.
        reason: &'static str,
    },
}

/// Which periodic motions count as a response.
#[derive(Debug, Clone, Copy)]
pub enum Counts<'a> {
    /// The one reached from rest.
    FromRest,
    /// The one reached from rest or, where the motion from rest does not settle to the period of
    /// the input, an unstable motion of that period. For an optimiser: its path may cross such
    /// parameter values, and an error there would block it.
    EvenUnstable,
    /// The one to which Newton's method comes from the last motion, which is remembered here; if
    /// it comes to none, as [`Counts::EvenUnstable`]. For an optimiser, too. Effects without a
    /// return map ignore the last motion.
    Near(&'a LastMotion),
}

/// Velocity harmonics V₀ … V_H and their derivatives.
#[derive(Debug, Clone, PartialEq)]
pub struct Response {
    /// V₀ … V_H as the sensor reports them, response units.
    pub velocity: Vec<Complex>,
    /// Derivatives of V₀ … V_H, one row for each variable.
    pub sensitivities: Vec<Vec<Complex>>,
}

/// Checks that every parameter of an axis is physically possible.
///
/// # Errors
/// [`NoResponse::Unphysical`] names the first parameter that is not.
pub(super) fn check(axis: &Axis) -> Result<(), NoResponse> {
    let (plant, friction) = (&axis.plant, axis.levels());
    let unphysical = |reason| Err(NoResponse::Unphysical { reason });
    let positive = |value: f64| value > 0.0 && value.is_finite();
    if !axis.viscous_rates().into_iter().all(positive) {
        return unphysical("a must be positive and finite");
    }
    if !plant.constant.is_finite() {
        return unphysical("K must be finite");
    }
    let actuator_is_stable = match plant.actuator {
        Actuator::Direct => true,
        Actuator::FirstOrder { corner_rad_s } => positive(corner_rad_s),
        Actuator::SecondOrder { natural_frequency_rad_s, damping_ratio } => {
            positive(natural_frequency_rad_s) && positive(damping_ratio)
        }
    };
    if !actuator_is_stable {
        return unphysical("the actuator must be stable");
    }
    // Written so that a NaN fails too.
    if !(friction.fc_plus >= 0.0
        && friction.fc_minus >= 0.0
        && friction.fs_plus >= friction.fc_plus
        && friction.fs_minus >= friction.fc_minus)
        && axis.friction_curve.is_none()
    {
        return unphysical("friction levels must be 0 ≤ Fc ≤ Fs");
    }
    if let Some(mass) = axis.second_mass
        && !(positive(mass.load_inertia_fraction)
            && mass.load_inertia_fraction < 1.0
            && positive(mass.stiffness)
            && mass.damping >= 0.0
            && mass.gap >= 0.0)
    {
        return unphysical("a second mass needs 0 < ρ < 1, a stiffness, a damping and a gap ≥ 0");
    }
    if axis.bristle.is_some_and(|sigma| !positive(sigma)) {
        return unphysical("the bristles' stiffness must be positive");
    }
    if axis.rate_limit.is_some_and(|rate| !positive(rate)) {
        return unphysical("the rate limit must be positive");
    }
    if !(axis.delay.is_finite() && axis.sensor_lags.iter().all(|lag| *lag >= 0.0)) {
        return unphysical("a delay must be finite and a lag at least 0");
    }
    Ok(())
}
