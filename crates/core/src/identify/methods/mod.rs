//! The methods: one file a method, one line in the list [`OWN`].
//!
//! A method is the stages that it has. They run in this order: closed form, network, search,
//! refinement. Each passes its results to the next. Options can switch stages off; a stage that a
//! method lacks never runs. A caller can add methods: [`Methods`].

mod abc_ann;
mod least_squares;
mod pso_ann;
mod steps;
mod two_magnitude;

use std::fmt;

use crate::answers::{InvalidOptions, Method};

pub use steps::Steps;

/// The methods that need nothing else, with their stages.
const OWN: &[(Method, Steps)] = &[
    (Method::AbcAnn, abc_ann::STEPS),
    (Method::PsoAnn, pso_ann::STEPS),
    (Method::TwoMagnitude, two_magnitude::STEPS),
    (Method::LeastSquares, least_squares::STEPS),
];

/// The methods that a request may name: those of this crate, and those that the caller adds, as the
/// ones for comparison in `servoscope-bench`.
#[derive(Clone, Copy, Default)]
pub struct Methods {
    /// Methods beside those of this crate.
    pub further: &'static [(Method, Steps)],
}

impl Methods {
    /// The stages of a method.
    ///
    /// # Errors
    /// If neither this crate nor the caller has it.
    pub fn steps(&self, method: Method) -> Result<&'static Steps, InvalidOptions> {
        let mut known = OWN.iter().chain(self.further);
        let found = known.find(|(known, _)| *known == method);
        found.map(|(_, steps)| steps).ok_or_else(|| InvalidOptions {
            option: "method",
            reason: format!(
                "the method `{}` is not part of this program; leave out `method` to use {}",
                method.name(),
                Method::default().name()
            ),
        })
    }

    fn names(&self) -> impl Iterator<Item = &'static str> {
        OWN.iter().chain(self.further).map(|(method, _)| method.name())
    }
}

impl fmt::Debug for Methods {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_list().entries(self.names()).finish()
    }
}

impl PartialEq for Methods {
    fn eq(&self, other: &Self) -> bool {
        self.names().eq(other.names())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_method_of_another_crate_is_known_only_where_the_caller_adds_it() {
        let own = Methods::default();
        assert!(own.steps(Method::AbcAnn).is_ok());
        let error = own.steps(Method::CmaEs).map(|_| ()).unwrap_err();
        assert!(error.to_string().contains("`cma-es` is not part of"), "{error}");
        let further = Methods { further: &[(Method::CmaEs, two_magnitude::STEPS)] };
        assert!(further.steps(Method::CmaEs).is_ok());
    }
}
