//! Whether a plan names more than a logarithmic sweep of the same duration.
//!
//! A machine is drawn with one hidden effect. A plan is asked for from a rough idea of it, every parameter of
//! which is off by a log-normal factor. The machine is then measured twice by the independent simulator, as
//! planned and by the sweep at three magnitudes that the plan is compared with, for the same time and with
//! the same noise, and both measurements are diagnosed through the public interface.

mod paired;
mod trial;

pub use paired::Paired;
pub use trial::{Settings, Swept, Trial, TrialError, Verdict, trial};
