//! Inputs that are not known along some directions.

use crate::measurement::Complex;

/// What is not known of the input of an experiment.
#[derive(Debug, Clone)]
pub(in super::super) struct UnknownInput {
    /// Lines of the input from k = 0, in scale, one standard deviation along each direction.
    pub directions: Vec<Vec<Complex>>,
    /// What each direction adds to every target, in scale; none before the first estimate.
    pub columns: Vec<Vec<Complex>>,
}

impl UnknownInput {
    /// Not known along these directions, in units of `input_scale`.
    pub fn along(directions: &[Vec<Complex>], input_scale: f64) -> Self {
        let in_scale = |lines: &Vec<Complex>| lines.iter().map(|line| line / input_scale).collect();
        Self { directions: directions.iter().map(in_scale).collect(), columns: Vec::new() }
    }
}
