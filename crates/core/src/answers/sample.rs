//! Made-up answers of each kind, for tests of the code that displays or stores them.

mod diagnosis;
mod discrepancy;
mod identification;
mod linearity;
mod plan;
mod validation;

pub use diagnosis::{diagnosis, explained, mended};
pub use discrepancy::{comparison, discrepancy, pattern};
pub use identification::{identification, stage};
pub use linearity::linearity;
pub use plan::plan;
pub use validation::{gain, validation};
