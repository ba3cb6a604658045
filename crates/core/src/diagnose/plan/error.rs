//! Why there is no plan.

/// Why a plan cannot be made.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PlanError {
    /// The observer asked to stop.
    #[error("cancelled")]
    Cancelled,
    /// A value of the request cannot be used.
    #[error("{field}: {reason}")]
    Invalid {
        /// Name of the field.
        field: &'static str,
        /// What is wrong with it, and what to do.
        reason: String,
    },
    /// The budget does not pay for the fewest experiments that determine the axis.
    #[error(
        "budget_s: {budget_s} s is too short: the {fewest} quickest experiments that the limits allow take \
         {needed_s:.3} s; give at least that, or raise the lowest frequency"
    )]
    TooShort {
        /// The budget, s.
        budget_s: f64,
        /// How many experiments are needed at least.
        fewest: usize,
        /// How long they take, s.
        needed_s: f64,
    },
    /// The limits leave no experiment.
    #[error(
        "the limits allow {left} of {of} experiments, too few for a plan: raise largest_velocity or \
         largest_travel, or the lowest frequency"
    )]
    NothingAllowed {
        /// Experiments within the limits.
        left: usize,
        /// Experiments that were considered.
        of: usize,
    },
}
