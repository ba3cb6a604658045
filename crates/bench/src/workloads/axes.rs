//! An axis drawn at random with an effect of the library, at the points of its design.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use servoscope_core::effects::{ActiveEffect, Wide, find};
use servoscope_core::measurement::Complex;
use servoscope_core::plant::{Friction, Plant};
use servoscope_core::simulate::{
    Counts, Excitation, NoResponse, Response, respond, respond_with_sensitivities,
};

use crate::machines::draw::{Draw, draw};
use crate::naming::effect_draws::draw_effect;

/// Harmonics 0 to 7 are computed.
const HIGHEST: usize = 7;

/// An axis with an effect.
#[derive(Debug, Clone)]
pub struct AxisWithEffect {
    plant: Plant,
    /// The plant with all its numbers as variables, and how many there are.
    variables: (Plant<Wide>, usize),
    effects: Vec<ActiveEffect>,
    /// The 48 points of its design: three magnitudes at 16 frequencies.
    pub points: Vec<Excitation>,
}

impl AxisWithEffect {
    /// Draws a machine with an actuator of this order, and an effect of a size that a lab would
    /// meet.
    ///
    /// # Panics
    /// If the library has no effect of this id, or the order is above 2.
    pub fn draw(id: &str, order: u8, seed: u64) -> Self {
        let drawn = draw(order, seed);
        let effect = draw_effect(id, &drawn, &mut ChaCha8Rng::seed_from_u64(seed));
        let values = effect.parameters().iter().map(|(_, value)| *value).collect();
        let known = find(id).expect("an effect of the library");
        let Draw { plant, design, .. } = drawn;
        let last = (design.len() - 1) as f64;
        let point = |(i, (m, omega)): (usize, &(f64, f64))| {
            Excitation::cosine(*omega, *m).at_run_share(i as f64 / last)
        };
        Self {
            plant,
            variables: variables(&plant),
            effects: vec![ActiveEffect::new(known, values).expect("its parameters")],
            points: design.iter().enumerate().map(point).collect(),
        }
    }

    /// Simulates the response at a point.
    ///
    /// # Errors
    /// See [`NoResponse`].
    pub fn respond(&self, point: &Excitation) -> Result<Vec<Complex>, NoResponse> {
        respond(&self.plant, &self.effects, point, HIGHEST)
    }

    /// The same with the derivatives by every number of the plant and every parameter of the
    /// effect, as a fit asks for it.
    ///
    /// # Errors
    /// See [`NoResponse`].
    pub fn respond_with_gradient(&self, point: &Excitation) -> Result<Response, NoResponse> {
        let (plant, count) = &self.variables;
        respond_with_sensitivities(
            Counts::EvenUnstable,
            plant,
            *count,
            &self.effects,
            point,
            HIGHEST,
        )
    }
}

/// A plant whose every number is a variable, static levels tied to Coulomb levels, and how many
/// there are.
fn variables(plant: &Plant) -> (Plant<Wide>, usize) {
    let mut count = 0;
    let mut next = |value: f64| {
        count += 1;
        Wide::variable(value, count - 1)
    };
    let Friction { fc_plus, fc_minus, .. } = plant.friction;
    let friction = Friction::coulomb(next(fc_plus), next(fc_minus));
    let actuator = plant.actuator.map(&mut next);
    let viscous_rate_rad_s = next(plant.viscous_rate_rad_s);
    let constant = next(plant.constant);
    (Plant { viscous_rate_rad_s, constant, actuator, friction }, count)
}
