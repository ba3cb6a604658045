//! Options of the stages that search: the network and the bee colony.

use serde::{Deserialize, Serialize};

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
