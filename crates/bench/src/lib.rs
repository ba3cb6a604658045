//! What judges `servoscope-core`, by its public interface alone.
//!
//! - [`machines`]: axes drawn at random, and an independent simulator that measures them;
//! - [`naming`]: how often a hidden effect is named, and how often one is named that is not there;
//! - [`reproduction`]: the experiments of the paper.

pub mod machines;
pub mod naming;
pub mod reproduction;

// The unit tests of `servoscope-core` compile `machines` into themselves: it finds these two at
// the root of whichever crate it is part of.
use servoscope_core::{measurement, plant};
