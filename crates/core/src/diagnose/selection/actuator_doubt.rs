//! What speaks against the actuator of a base model that was fitted to a record.

use crate::diagnose::residuals::{discrepancy, valid_band};
use crate::identify::{FitSession, Intervals, ModelFit};

/// An actuator with less damping resonates: its gain rises fivefold. Loops and filters of drives are
/// damped by design. Set by hand.
const SHARP_DAMPING_RATIO: f64 = 0.1;

/// A resonance is shown by data on both of its flanks: so far below and above it, as a ratio of
/// frequencies. Set by hand.
const FLANK: f64 = 1.25;

/// Why another order of the actuator must be tried.
pub(super) enum ActuatorDoubt {
    /// The pole is at a bound: the actuator stands for the mechanics, and no effect can be found
    /// beside it.
    NoAxis,
    /// A sharp resonance lies beyond the band that is excited, or where the model departs from the
    /// measurement. It serves what the model lacks elsewhere.
    UnshownResonance {
        /// What to tell the user.
        sentence: String,
    },
}

impl ActuatorDoubt {
    /// What speaks against the actuator of a session's base model, if anything does. Nothing does
    /// where the model leaves only noise.
    pub fn of(session: &FitSession<'_>, seed: u64) -> Option<Self> {
        let leaves_more = |_: &Self| !discrepancy::leaves_noise(session, session.base(), seed);
        Self::beside_more_than_noise(session).filter(leaves_more)
    }

    fn beside_more_than_noise(session: &FitSession<'_>) -> Option<Self> {
        let fit = session.judge(session.base(), Intervals::Curvature).ok()?;
        let parameters = &fit.identification.parameters;
        if parameters.get("pole").is_some_and(|pole| pole.at_bound) {
            return Some(Self::NoAxis);
        }
        let value = |name: &str| parameters.get(name).and_then(|estimate| estimate.value);
        let damping_ratio = value("damping_ratio")?;
        let hz = value("natural_frequency")? / std::f64::consts::TAU;
        let is_unshown = damping_ratio < SHARP_DAMPING_RATIO && !shows(&fit, hz);
        is_unshown.then(|| Self::UnshownResonance {
            sentence: format!(
                "without effects, an actuator with a resonance at {hz:.3} Hz fits best (damping ratio \
                 {damping_ratio:.2}), but the data do not show that resonance; lower orders were taken"
            ),
        })
    }
}

/// Whether the model may be used on both sides of this frequency.
fn shows(fit: &ModelFit, hz: f64) -> bool {
    let usable = valid_band::of(fit).and_then(|band| band.usable_hz);
    usable.is_some_and(|[low, high]| low <= hz / FLANK && hz * FLANK <= high)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::answers::PlantRequest;
    use crate::diagnose::fixtures::{multisine_record, plant};
    use crate::identify::IdentifyRequest;
    use crate::observer::Silent;
    use crate::plant::{Actuator, Plant};

    /// What speaks against the actuator, and what would if the model left more than noise.
    fn doubts(machine: Plant) -> [Option<ActuatorDoubt>; 2] {
        let record = multisine_record(machine, &[], None, 5);
        let plant = Some(PlantRequest { actuator_order: machine.actuator.order() });
        let request = IdentifyRequest { plant, ..IdentifyRequest::default() };
        let session = FitSession::new(&record, &request, &Silent).unwrap();
        [ActuatorDoubt::of(&session, 1), ActuatorDoubt::beside_more_than_noise(&session)]
    }

    // Of 120 rad/s, a pole at 20 000 turns the phase by a third of a degree.
    #[test]
    fn a_base_model_is_no_axis_where_its_inertia_does_not_show() {
        let is_no_axis = |viscous_rate_rad_s: f64| {
            let constant = 2.5 * viscous_rate_rad_s;
            let machine = Plant { viscous_rate_rad_s, constant, ..plant() };
            matches!(doubts(machine)[1], Some(ActuatorDoubt::NoAxis))
        };
        assert_eq!([8.0, 2e4].map(is_no_axis), [false, true]);
    }

    // Lines go up to 120 rad/s.
    #[test]
    fn a_sharp_resonance_shows_inside_the_excited_band_and_not_at_its_end() {
        let is_unshown = |natural_frequency_rad_s: f64, damping_ratio: f64| {
            let actuator = Actuator::SecondOrder { natural_frequency_rad_s, damping_ratio };
            let [none, doubt] = doubts(Plant { actuator, ..plant() });
            assert!(none.is_none(), "the model leaves only noise");
            matches!(doubt, Some(ActuatorDoubt::UnshownResonance { .. }))
        };
        assert!(!is_unshown(60.0, 0.05));
        assert!(is_unshown(110.0, 0.05));
        assert!(!is_unshown(110.0, 0.5));
    }
}
