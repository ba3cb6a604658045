//! Benchmarks of `servoscope-core`, through its public interface only.
//!
//! - [`machines`]: random axes, and an independent simulator that generates measurements of them;
//! - [`methods`]: the searches that only comparisons need;
//! - [`naming`]: how often a diagnosis names a hidden effect, and how often it names one that is
//!   not there;
//! - [`planning`]: whether a plan names more than a sweep of the same duration;
//! - [`reproduction`]: the experiments of the paper;
//! - [`workloads`]: work of fixed size, to be timed.

pub mod machines;
pub mod methods;
pub mod naming;
pub mod planning;
pub mod reproduction;
pub mod workloads;

// The unit tests of `servoscope-core` include the source of `machines` as a module of that crate.
// `machines` therefore uses `crate::measurement` and `crate::plant`, which both crates must have.
use servoscope_core::{measurement, plant};
