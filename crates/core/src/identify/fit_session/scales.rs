//! The scales of the fitted machine, and the parameters of effects in units of the measurement.

use indexmap::IndexMap;

use super::FitSession;
use crate::answers::SizedParameter;
use crate::effects::{Effect, MachineScales};
use crate::identify::problem::Scales;
use crate::identify::units::Units;
use crate::plant::Actuator;

/// Ratio of the corner of an actuator to the highest excited frequency from which it is fast. There a
/// first order turns the phase by 27°, and a second order changes the gain by a third. Set by hand.
const FAST_ACTUATOR: f64 = 2.0;

impl FitSession<'_> {
    /// Scales of the fitted machine and of the experiments on it, in the problem's units.
    ///
    /// Friction counts as a thousandth of the largest input if the fit has less, and the viscous
    /// rate as the lowest frequency: the velocity is bounded by inertia where it is less.
    pub fn machine_scales(&self) -> MachineScales {
        let scope = self.scope();
        let friction = scope.plant.friction;
        let level = |fc: f64| fc.max(1e-3 * scope.largest_level);
        MachineScales {
            viscous_rate: scope.plant.viscous_rate_rad_s.max(scope.omega_low),
            constant: scope.plant.constant,
            coulomb: [level(friction.fc_plus), level(friction.fc_minus)],
            lowest: scope.moving_level,
            highest: scope.largest_level,
            fastest_rad_s: scope.omega_high,
        }
    }

    /// Whether the base model has an actuator whose corner is more than twice the highest excited
    /// frequency: then the data hardly show it.
    pub fn actuator_is_fast(&self) -> bool {
        let scope = self.scope();
        let rate = match scope.plant.actuator {
            Actuator::Direct => return false,
            Actuator::FirstOrder { corner_rad_s } => corner_rad_s,
            Actuator::SecondOrder { natural_frequency_rad_s, .. } => natural_frequency_rad_s,
        };
        rate > FAST_ACTUATOR * scope.omega_high
    }

    /// The parameters of an effect by name, from the problem's units to those of the measurement.
    pub fn in_units(
        &self,
        effect: &dyn Effect,
        values: &[f64],
    ) -> IndexMap<String, SizedParameter> {
        let Scales { omega, input, velocity } = self.problem.scales;
        let units = Units::of(self.measurement);
        let parameters = effect.parameters().iter().zip(values);
        let sized = parameters.map(|(parameter, value)| {
            let value = value * parameter.dimension.factor(input, velocity, 1.0 / omega);
            let unit = units.unit(parameter.dimension);
            (parameter.name.to_owned(), SizedParameter { value, unit })
        });
        sized.collect()
    }
}
