//! Answers as a person reads them. Knows results, never solvers.

#[cfg(test)]
pub(crate) mod sample;
mod text;

pub use text::identification;
