//! Kinds of job, methods and options of a request.

use serde::{Deserialize, Serialize};

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

/// How parameters are estimated.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Method {
    /// A neural network proposes starting points, an artificial bee colony searches, and
    /// Levenberg–Marquardt refines.
    #[default]
    AbcAnn,
    /// As `abc-ann` with a particle swarm in place of the colony.
    PsoAnn,
    /// As `abc-ann` with a genetic algorithm whose rates follow the spread of the fitness.
    AgaAnn,
    /// As `abc-ann` with a genetic algorithm of fixed rates.
    GaAnn,
    /// Closed form from the describing function of friction at two magnitudes, without refinement.
    /// Describing functions are approximate, so it is wrong by some percent even without noise.
    TwoMagnitude,
    /// Levenberg–Marquardt from several starts.
    LeastSquares,
    /// Covariance matrix adaptation evolution strategy, then Levenberg–Marquardt.
    CmaEs,
}

/// Every method and its name, in the order in which they are listed for the user.
const METHODS: &[(Method, &str)] = &[
    (Method::AbcAnn, "abc-ann"),
    (Method::PsoAnn, "pso-ann"),
    (Method::AgaAnn, "aga-ann"),
    (Method::GaAnn, "ga-ann"),
    (Method::TwoMagnitude, "two-magnitude"),
    (Method::LeastSquares, "least-squares"),
    (Method::CmaEs, "cma-es"),
];

impl Method {
    /// Every method, in the order in which they are listed for the user.
    pub fn all() -> impl Iterator<Item = Method> {
        METHODS.iter().map(|(method, _)| *method)
    }

    /// The name used on the wire and on the command line.
    pub fn name(self) -> &'static str {
        let found = METHODS.iter().find(|(method, _)| *method == self);
        found.expect("every method is listed: a test compares with the wire").1
    }
}

impl std::str::FromStr for Method {
    type Err = InvalidOptions;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        Method::all().find(|method| method.name() == text).ok_or_else(|| InvalidOptions {
            option: "method",
            reason: format!(
                "`{text}` is not a method; known: {}",
                Method::all().map(Method::name).collect::<Vec<_>>().join(", ")
            ),
        })
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

/// Variant of the bee colony.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(rename_all = "snake_case")]
pub enum ColonyVariant {
    /// Changes several dimensions per step (modification rate 0.5), with a pull towards the best
    /// source.
    #[default]
    GlobalBest,
    /// Changes one dimension per step, as printed in the paper.
    Literal,
}

/// Options of the network that proposes parameters from measured features.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(default, deny_unknown_fields)]
pub struct NetworkOptions {
    /// Whether it is used at all.
    pub enabled: bool,
    /// Neurons in the hidden layer.
    #[cfg_attr(feature = "openapi", schema(minimum = 1, maximum = 200))]
    pub hidden_neurons: usize,
    /// Number of simulated plants it is trained on.
    #[cfg_attr(feature = "openapi", schema(minimum = 10, maximum = 20_000))]
    pub training_plants: usize,
    /// Passes of back-propagation over the training plants.
    #[cfg_attr(feature = "openapi", schema(minimum = 1, maximum = 5_000))]
    pub epochs: usize,
}

impl Default for NetworkOptions {
    fn default() -> Self {
        // 20 hidden neurons: the paper, Table I.
        Self { enabled: true, hidden_neurons: 20, training_plants: 800, epochs: 60 }
    }
}

/// Options of the artificial bee colony.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(default, deny_unknown_fields)]
pub struct ColonyOptions {
    /// Whether it is used at all.
    pub enabled: bool,
    /// Which variant.
    pub variant: ColonyVariant,
    /// Number of food sources, of employed bees and of onlookers.
    #[cfg_attr(feature = "openapi", schema(minimum = 2, maximum = 1_000))]
    pub food_sources: usize,
    /// Number of cycles, each an employed, an onlooker and a scout phase.
    #[cfg_attr(feature = "openapi", schema(minimum = 1, maximum = 10_000))]
    pub cycles: usize,
    /// Failed trials after which a source is abandoned; null: food sources × parameters, the usual
    /// choice.
    #[cfg_attr(feature = "openapi", schema(minimum = 1, maximum = 1_000_000))]
    pub abandonment_limit: Option<usize>,
}

impl Default for ColonyOptions {
    fn default() -> Self {
        // 10 sources and 50 cycles: the paper, Table I.
        Self {
            enabled: true,
            variant: ColonyVariant::GlobalBest,
            food_sources: 10,
            cycles: 50,
            abandonment_limit: None,
        }
    }
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
    fn every_method_has_the_same_name_on_the_wire_and_on_the_command_line() {
        for method in Method::all() {
            assert_eq!(serde_json::to_value(method).unwrap(), method.name());
            assert_eq!(method.name().parse(), Ok(method));
        }
        // Deserialising an unknown name lists all that serde accepts; `all` must list as many.
        let known = serde_json::from_str::<Method>("\"magic\"").unwrap_err().to_string();
        assert_eq!(known.matches('`').count() / 2 - 1, Method::all().count(), "{known}");
    }

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
