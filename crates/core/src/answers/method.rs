//! Methods of estimating parameters.

use serde::{Deserialize, Serialize};

use super::InvalidOptions;

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
}
