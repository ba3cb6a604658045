//! What is asked of servoscope and what it answers: plain data, no solver.
//!
//! `store` and `report` know these types and nothing of how they were computed.
//! Their JSON form is the wire format of the service and of `--json`.

mod answer;
mod comparison;
mod diagnosis;
mod discrepancy;
mod flat;
mod identification;
mod progress;
mod request;
pub mod sample;
mod validation;

pub use answer::Answer;
pub use comparison::{ComparedExperiment, ComparedHarmonic, Comparison, Unanswered};
pub use diagnosis::{Candidate, Cause, Diagnosis, Gain, NextExperiment, Verdict};
pub use discrepancy::{Discrepancy, Pattern, ResidualGroup, ResidualTest};
pub use flat::{HistoryRow, ResultRow};
pub use identification::{
    Correlations, Fit, Identification, NoiseSource, OrderCandidate, OrderChoice, ParameterEstimate,
    Provenance, Stage, TransferFunction,
};
pub use progress::{ConvergenceRow, Progress};
pub use request::{
    ColonyOptions, ColonyVariant, IdentifyOptions, InvalidOptions, JobKind, Method, NetworkOptions,
    PlantRequest, Weighting,
};
pub use validation::{
    BeginningValue, ValidatedCause, ValidatedModel, ValidatedModels, ValidatedMotion, Validation,
    ValidationProvenance,
};
