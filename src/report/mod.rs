//! Answers as a person reads them. Knows results, never solvers.

mod causes;
mod columns;
mod diagnosis;
pub mod figures;
mod number;
pub mod page;
#[cfg(test)]
pub(crate) mod sample;
mod text;
mod validation;

pub use causes::with_causes;
pub use diagnosis::diagnosis;
pub use text::identification;
pub use validation::validation;
