//! Answers as a person reads them. Knows results, never solvers.

mod columns;
mod number;
#[cfg(test)]
pub(crate) mod sample;
mod text;

pub use text::identification;
