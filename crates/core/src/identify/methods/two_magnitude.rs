//! Method `two-magnitude`, reference \[2\] of the paper: the closed form from the describing
//! function of friction at two magnitudes (see `closed_form`), and nothing after it.
//!
//! Its parameters have the accuracy of the describing function: they are off by percents even
//! without noise (`docs/reproduction.md` lists them for the systems of the paper). It is the
//! yardstick for the searches.

use super::steps::Steps;

pub(super) const STEPS: Steps =
    Steps { closed_form: true, network: false, search: None, refinement: false };
