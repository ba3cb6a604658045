//! `servoscope identify`

use super::{Failure, computation};

/// Fits the base model to a measurement and prints the answer.
pub(super) fn run(args: &computation::Args) -> Result<(), Failure> {
    computation::answer(args, "identify", None, false)
}
