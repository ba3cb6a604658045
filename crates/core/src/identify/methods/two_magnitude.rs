//! `two-magnitude`, reference \[2\] of the paper: the closed form from the describing function
//! of friction at two magnitudes (see `closed_form`), and nothing after it.
//!
//! Its parameters are of describing-function accuracy, percents off without any noise
//! (`docs/reproduction.md` has them for the systems of the paper): it is the yardstick the
//! searches are held against.

use super::steps::Steps;

pub(super) const STEPS: Steps =
    Steps { closed_form: true, network: false, search: None, refinement: false };
