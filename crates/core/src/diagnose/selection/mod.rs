//! Which of the fitted models is answered: what an effect must gain, what speaks for a model, how
//! certain its causes are, and what the answer says.

pub(super) mod causes;
pub(super) mod evidence;
pub(super) mod familywise_threshold;
pub(super) mod models;
pub(super) mod next_experiment;
pub(super) mod order_selection;
pub(super) mod order_study;
pub(super) mod report_assembly;
pub(super) mod weighting_choice;
