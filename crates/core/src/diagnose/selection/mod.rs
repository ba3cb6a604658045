//! Model selection: which of the fitted models becomes the answer.
//!
//! `familywise_threshold` says by how much an effect must lower χ²; `evidence` is the criterion by
//! which models are compared; `order_selection`, `actuator_doubt`, `better_order` and `weighting_choice` choose the
//! actuator order and the weights of the errors; `rival_faults` compares what is found with faults of the
//! measurement.

mod actuator_doubt;
mod better_order;
pub(super) mod causes;
mod confidence;
pub(super) mod evidence;
pub(super) mod familywise_threshold;
pub(super) mod models;
pub(super) mod next_experiment;
pub(super) mod order_selection;
pub(super) mod order_study;
pub(super) mod report_assembly;
mod rival_faults;
mod spans;
pub(super) mod weighting_choice;
