//! Kinds of job and options of a request.

use serde::{Deserialize, Serialize};

use super::search_options::{ColonyOptions, NetworkOptions};

/// Kind of job.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(rename_all = "snake_case")]
pub enum JobKind {
    /// Fit the base model.
    Identify,
    /// Fit the base model, find where it is wrong, name the effects it lacks, and fit the model
    /// extended with them.
    Diagnose,
}

impl JobKind {
    /// The name used on the wire.
    pub fn name(self) -> &'static str {
        match self {
            JobKind::Identify => "identify",
            JobKind::Diagnose => "diagnose",
        }
    }
}

/// Prior knowledge of the plant.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(deny_unknown_fields)]
pub struct PlantRequest {
    /// Order of the actuator in front of the mechanics: 0, 1 or 2.
    #[cfg_attr(feature = "openapi", schema(minimum = 0, maximum = 2))]
    pub actuator_order: u8,
}

/// Weights of the errors of the harmonics in a fit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(rename_all = "snake_case")]
pub enum Weighting {
    /// Each error relative to the noise of its harmonic: best if a model can explain the data to
    /// within the noise.
    #[default]
    Noise,
    /// All errors weighted equally, in response units: best if no model can. The noise level is
    /// then estimated from the residual.
    Response,
}

/// Options of an identification; all have defaults.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(default, deny_unknown_fields)]
pub struct IdentifyOptions {
    /// Seed of every random choice; the same seed gives bit-identical results.
    pub seed: u64,
    /// Standard deviation of re and im of every harmonic, in response units, for data with neither
    /// standard deviations nor repeats.
    #[cfg_attr(feature = "openapi", schema(exclusive_minimum = 0.0))]
    pub noise_std: Option<f64>,
    /// Weights of the errors.
    pub weights: Weighting,
    /// Whether a closed-form starting point is computed if the data allows it.
    pub closed_form_start: bool,
    /// The network stage.
    pub network: NetworkOptions,
    /// The colony stage.
    pub colony: ColonyOptions,
    /// Evaluations (simulations of the whole measurement) that the search of any method may use;
    /// for the colony it limits the number of cycles. Null: the number that results from the
    /// colony's food sources and cycles.
    #[cfg_attr(feature = "openapi", schema(minimum = 2, maximum = 2_000_000))]
    pub evaluation_budget: Option<usize>,
    /// Whether the best point found is refined by Levenberg–Marquardt.
    pub refine: bool,
    /// Largest number of effects that a diagnosis names together, 1 to 3.
    #[cfg_attr(feature = "openapi", schema(minimum = 1, maximum = 3))]
    pub most_effects: usize,
    /// Whether a diagnosis takes the measurement as it is: no row is left out, and no fault of the
    /// measurement is looked for.
    pub keep_all: bool,
}

impl Default for IdentifyOptions {
    fn default() -> Self {
        Self {
            seed: 1,
            noise_std: None,
            weights: Weighting::Noise,
            closed_form_start: true,
            network: NetworkOptions::default(),
            colony: ColonyOptions::default(),
            evaluation_budget: None,
            refine: true,
            most_effects: 3,
            keep_all: false,
        }
    }
}

/// An option has an invalid value.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("option {option}: {reason}")]
pub struct InvalidOptions {
    /// Name of the option.
    pub option: &'static str,
    /// What is wrong, and which values are allowed.
    pub reason: String,
}

impl IdentifyOptions {
    /// Number of evaluations that a search may use.
    pub fn search_budget(&self) -> usize {
        let ColonyOptions { food_sources, cycles, .. } = self.colony;
        self.evaluation_budget.unwrap_or(food_sources * (2 * cycles + 1))
    }

    /// Checks that every value is usable and keeps the computing time bounded.
    ///
    /// # Errors
    /// The first option out of range, with its range.
    pub fn validate(&self) -> Result<(), InvalidOptions> {
        let within = |option, value: usize, low: usize, high: usize| {
            if (low..=high).contains(&value) {
                Ok(())
            } else {
                let reason = format!("{value} is outside {low} to {high}");
                Err(InvalidOptions { option, reason })
            }
        };
        within("network.hidden_neurons", self.network.hidden_neurons, 1, 200)?;
        within("network.training_plants", self.network.training_plants, 10, 20_000)?;
        within("network.epochs", self.network.epochs, 1, 5_000)?;
        within("colony.food_sources", self.colony.food_sources, 2, 1_000)?;
        within("colony.cycles", self.colony.cycles, 1, 10_000)?;
        within(
            "colony.abandonment_limit",
            self.colony.abandonment_limit.unwrap_or(1),
            1,
            1_000_000,
        )?;
        // Each of two factors may be large as long as their product is not.
        within(
            "colony.food_sources × colony.cycles",
            self.colony.food_sources * self.colony.cycles,
            1,
            1_000_000,
        )?;
        within(
            "network.training_plants × network.epochs",
            self.network.training_plants * self.network.epochs,
            1,
            10_000_000,
        )?;
        if let Some(budget) = self.evaluation_budget {
            within("evaluation_budget", budget, self.colony.food_sources, 2_000_000)?;
        }
        within("most_effects", self.most_effects, 1, 3)?;
        match self.noise_std {
            Some(std) if !(std.is_finite() && std > 0.0) => Err(InvalidOptions {
                option: "noise_std",
                reason: format!("{std} is not a positive number of response units"),
            }),
            _ => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_budget_that_does_not_pay_for_the_food_sources_is_refused() {
        let with = |budget| IdentifyOptions {
            evaluation_budget: Some(budget),
            ..IdentifyOptions::default()
        };
        assert_eq!(with(9).validate().unwrap_err().option, "evaluation_budget");
        assert_eq!(with(10).validate(), Ok(()));
        assert_eq!(
            (with(10).search_budget(), IdentifyOptions::default().search_budget()),
            (10, 1010)
        );
    }
}
