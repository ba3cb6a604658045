//! How much of the excess χ² of a machine its dominant effects make, and what they leave.

use serde::Serialize;
use servoscope_core::answers::PlantRequest;
use servoscope_core::effects::{Effect, find};
use servoscope_core::identify::{FitAccuracy, FitSession, IdentifyError, IdentifyRequest, Model};
use servoscope_core::measurement::{Experiment, Measurement};
use servoscope_core::observer::Silent;

use super::excess::quick;

/// Starts of a fit that are followed to their minimum.
const FOLLOWED: usize = 2;

/// The excess χ² of a machine: of the base model, and with its dominant effects.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Dominance {
    /// Excess of the base model.
    pub base: f64,
    /// Excess of the best fit with each dominant effect alone.
    pub alone: Vec<f64>,
    /// Excess of the best fit with all dominant effects.
    pub left: f64,
    /// χ² per degree of freedom of that fit to a measurement with noise: 1 and what the excess adds.
    pub chi2_per_dof: f64,
}

impl Dominance {
    /// Fits the dominant effects, by their ids, to the noise-free response of a machine.
    /// `without_small` is that of the machine with its dominant effects alone; both state the
    /// standard deviation of the same noise.
    ///
    /// The fits begin at the start points of the effects, and may miss their best minimum. The true
    /// parameters are one more choice, so that what is left is never more than the small effects
    /// add to the response.
    ///
    /// # Errors
    /// See [`IdentifyError`].
    ///
    /// # Panics
    /// If the library does not have one of the ids.
    pub(super) fn of(
        exact: &Measurement,
        without_small: &Measurement,
        ids: &[&str],
        order: u8,
    ) -> Result<Self, IdentifyError> {
        let plant = Some(PlantRequest { actuator_order: order });
        let request = IdentifyRequest { plant, options: quick(), ..IdentifyRequest::default() };
        let session = FitSession::new(exact, &request, &Silent)?;
        let effects: Vec<&'static dyn Effect> = ids
            .iter()
            .map(|id| find(id).unwrap_or_else(|| panic!("the library has no `{id}`")))
            .collect();
        let alone: Vec<Model> =
            effects.iter().map(|effect| fitted(&session, session.base(), *effect)).collect();
        let together = match effects[..] {
            [first, second] => {
                let both = [(&alone[0], second), (&alone[1], first)];
                let both = both.map(|(model, effect)| fitted(&session, model, effect));
                better(both).unwrap_or_else(|| session.base().clone())
            }
            _ => better(alone.iter().cloned()).unwrap_or_else(|| session.base().clone()),
        };
        let left = together.cost.min(misfit(exact, without_small));
        let dof = session.data().saturating_sub(together.parameters()).max(1);
        let alone = match alone.len() {
            1 => vec![left],
            _ => alone.iter().map(|model| model.cost).collect(),
        };
        let chi2_per_dof = 1.0 + left / dof as f64;
        Ok(Self { base: session.base().cost, alone, left, chi2_per_dof })
    }

    /// The same where the noise is `factor` times as large.
    pub(super) fn with_noise(&self, factor: f64) -> Self {
        let of = |excess: f64| excess / (factor * factor);
        Self {
            base: of(self.base),
            alone: self.alone.iter().copied().map(of).collect(),
            left: of(self.left),
            chi2_per_dof: 1.0 + of(self.chi2_per_dof - 1.0),
        }
    }

    /// Share of the base model's excess that the dominant effects make.
    pub fn share(&self) -> f64 {
        1.0 - self.left / self.base
    }

    /// The least share of the base model's excess that one of several dominant effects makes beside
    /// the others.
    pub fn least_share(&self) -> f64 {
        let without_one = self.alone.iter().copied().fold(f64::INFINITY, f64::min);
        (without_one - self.left) / self.base
    }
}

/// The best fit of a model with one more effect.
fn fitted(session: &FitSession<'_>, from: &Model, effect: &'static dyn Effect) -> Model {
    let middle = session.extend(from, effect);
    let own = middle.parameters_of(from.effects().len());
    let begun = session.start_points(effect).into_iter().map(|values| {
        let mut model = middle.clone();
        own.clone().zip(values).for_each(|(parameter, value)| model.set(parameter, value));
        model
    });
    let mut glances: Vec<Model> = std::iter::once(middle.clone())
        .chain(begun)
        .map(|model| session.refine(&model, FitAccuracy::Glance))
        .collect();
    glances.sort_by(|left, right| left.cost.total_cmp(&right.cost));
    glances.truncate(FOLLOWED);
    let settled = glances.iter().map(|model| session.refine(model, FitAccuracy::Settle));
    better(settled).unwrap_or(middle)
}

/// The model with the least cost.
fn better(models: impl IntoIterator<Item = Model>) -> Option<Model> {
    models.into_iter().min_by(|left, right| left.cost.total_cmp(&right.cost))
}

/// χ² between two noise-free responses by the noise that the first one states; infinite if the
/// second one lacks an experiment.
fn misfit(exact: &Measurement, other: &Measurement) -> f64 {
    let of = |experiment: &Experiment| -> Option<f64> {
        let other = other.experiments().iter().find(|other| other.run == experiment.run)?;
        let pairs = experiment.response.iter().zip(&other.response);
        let square = |std: Option<f64>, difference: f64| Some((difference / std?).powi(2));
        pairs.map(|(here, there)| square(here.std, (here.value - there.value).norm())).sum()
    };
    exact.experiments().iter().map(|experiment| of(experiment).unwrap_or(f64::INFINITY)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::machines::draw::{Draw, draw};
    use crate::machines::noise::NoiseLaw;
    use crate::machines::responses::Responses;
    use crate::machines::simulator::{Effect, Settings};

    fn exact(effects: &[Effect], std: f64) -> Measurement {
        let mut machine = Draw { effects: effects.to_vec(), ..draw(0, 3) };
        machine.design.retain(|(_, omega)| *omega > machine.plant.viscous_rate_rad_s);
        let responses = Responses::simulate(&machine, &Settings::default()).unwrap();
        responses.stating(&NoiseLaw::uniform(std)).unwrap()
    }

    /// A standard deviation of the noise at which both effects below show well.
    fn std() -> f64 {
        1e-3 * exact(&[], 1.0).experiments()[0].harmonic(1).unwrap().value.norm()
    }

    fn asymmetry() -> Effect {
        Effect::new("gain_asymmetry", [("gamma", 0.1)])
    }

    fn dead_zone() -> Effect {
        let (magnitude, _) = draw(0, 3).design[0];
        Effect::new("actuator_dead_zone", [("half_width", 0.1 * magnitude)])
    }

    #[test]
    fn a_dominant_effect_that_is_alone_leaves_nothing_however_far_the_other_bound_is() {
        let whole = exact(&[asymmetry()], std());
        let found = Dominance::of(&whole, &exact(&[], std()), &["gain_asymmetry"], 0).unwrap();
        // A fit ends where χ² changes by far less than 1.
        assert!(found.base > 1_000.0 && found.left < 1.0, "{found:?}");
        assert!((found.chi2_per_dof - 1.0).abs() < 0.01 && found.share() > 0.999, "{found:?}");
    }

    #[test]
    fn two_dominant_effects_leave_nothing_together_and_something_alone() {
        let whole = exact(&[asymmetry(), dead_zone()], std());
        let ids = ["gain_asymmetry", "actuator_dead_zone"];
        let found = Dominance::of(&whole, &exact(&[], std()), &ids, 0).unwrap();
        assert!(found.left < 1.0, "{found:?}");
        assert!(found.alone.iter().all(|left| *left > 100.0 && *left < found.base), "{found:?}");
        let least = found.alone.iter().copied().fold(f64::INFINITY, f64::min);
        assert!((found.least_share() - (least - found.left) / found.base).abs() < 1e-12);
    }

    #[test]
    fn what_is_left_is_never_more_than_the_small_effects_add() {
        let whole = exact(&[asymmetry(), dead_zone()], std());
        let without_small = exact(&[asymmetry()], std());
        let added = misfit(&whole, &without_small);
        let found = Dominance::of(&whole, &without_small, &["gain_asymmetry"], 0).unwrap();
        assert!(found.left > 100.0 && found.left <= added, "{found:?} of {added}");
        assert_eq!(found.alone, [found.left]);
    }

    #[test]
    fn a_misfit_counts_every_experiment() {
        let whole = exact(&[], std());
        assert_eq!(misfit(&whole, &whole), 0.0);
        // One standard deviation: the noise of the other one is not asked.
        let mut experiments = whole.experiments().to_vec();
        experiments[2].response[1].value.re += std();
        experiments[2].response[1].std = Some(1e9);
        let of = |experiments: Vec<Experiment>| {
            let metadata = whole.metadata().clone();
            Measurement::new(metadata, experiments, Vec::new(), String::new()).unwrap()
        };
        // Rounding of a difference of numbers a thousand times as large.
        assert!((misfit(&whole, &of(experiments.clone())) - 1.0).abs() < 1e-9);
        experiments.pop();
        assert_eq!(misfit(&whole, &of(experiments)), f64::INFINITY);
    }
}
