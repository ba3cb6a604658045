//! What an answer says of the noise that was found.

use crate::answers::{NoiseLaw, NoisePart};

use super::noise::Weights;
use super::problem::Problem;
use super::variance_law::VarianceLaw;
use super::variance_shrinkage::{Cell, describing_law, sums_of_squares};

/// The law of the noise of a datum, where one was estimated and the data determine both parts.
pub(super) fn reported(weights: &Weights, problem: &Problem) -> Option<NoiseLaw> {
    let unit = problem.response_scale;
    if let Some(estimated) = &weights.law {
        return of(estimated.law, estimated.intervals, unit);
    }
    // The datum is the mean of the repeats.
    let mean = |cell: &Cell| Cell { variance: cell.variance / cell.repeats(), ..*cell };
    let rows: Vec<Vec<Cell>> =
        weights.scatter.iter().map(|row| row.iter().map(mean).collect()).collect();
    let law = describing_law(&rows)?;
    of(law, law.intervals(&sums_of_squares(&rows), 1.0), unit)
}

/// The law in units of the response; `None` where an interval has no end, as with responses that
/// are all of one size.
fn of(law: VarianceLaw, intervals: [[f64; 2]; 2], unit: f64) -> Option<NoiseLaw> {
    if !intervals.iter().flatten().all(|end| (unit * end).is_finite()) {
        return None;
    }
    let [of_alpha, of_beta] = intervals;
    let part = |square: f64, ends: [f64; 2], unit: f64| NoisePart {
        value: unit * square.sqrt(),
        interval95: ends.map(|end| unit * end),
    };
    Some(NoiseLaw {
        additive: part(law.additive, of_alpha, unit),
        proportional: part(law.proportional, of_beta, 1.0),
    })
}
