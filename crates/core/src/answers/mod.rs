//! Requests and results as plain data, without any computation.
//!
//! The application's modules `store` and `report` use these types and do not depend on how they
//! were computed. Their JSON form is the wire format of the service and of `--json`.

mod answer;
mod comparison;
mod diagnosis;
mod discrepancy;
mod flat;
mod identification;
mod inspection;
mod linearity;
mod measurement_fault;
mod method;
mod plan;
mod progress;
mod request;
pub mod sample;
mod search_options;
mod valid_band;
mod validation;

pub use answer::Answer;
pub use comparison::{ComparedExperiment, ComparedHarmonic, Comparison, Unanswered};
pub use diagnosis::{Candidate, Cause, Diagnosis, Gain, NextExperiment, Verdict};
pub use discrepancy::{Discrepancy, Pattern, ResidualGroup, ResidualTest};
pub use flat::{HistoryRow, ResultRow};
pub use identification::{
    Correlations, Fit, Identification, NoiseLaw, NoisePart, NoiseSource, OrderCandidate,
    OrderChoice, ParameterEstimate, Provenance, Stage, TransferFunction,
};
pub use inspection::{
    Detectability, DetectableEffect, EffectSize, Inspection, ReadingDoubt, SizedParameter,
};
pub use linearity::{DistortionLine, LinearLine, Linearity, LinearityLevel, Parity, Share};
pub use measurement_fault::{
    AsMeasured, Channel, FaultKind, InterpolatedSamples, LeftOutRow, MeasurementFault,
};
pub use method::Method;
pub use plan::{
    Plan, PlanOptions, PlanRequest, PlannedEffect, PlannedExperiment, PlannedSweep, RoughAxis,
};
pub use progress::{ConvergenceRow, Progress};
pub use request::{IdentifyOptions, InvalidOptions, JobKind, PlantRequest, Weighting};
pub use search_options::{ColonyOptions, ColonyVariant, NetworkOptions};
pub use valid_band::{BandDeparture, ValidBand};
pub use validation::{
    BeginningValue, ValidatedCause, ValidatedModel, ValidatedModels, ValidatedMotion, Validation,
    ValidationProvenance,
};
