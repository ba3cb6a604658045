//! The initial state of a motion, where the upload does not give it: a maximum a posteriori
//! estimate.
//!
//! The unknown quantities are fitted by least squares to the first stretch of the motion. The prior
//! is a normal distribution about rest. It is as wide as the initial states to which the input can
//! bring the axis. How much the data weighs against the prior depends on the model's own error.
//! With r the residuals, σ² the mean square of the model's error, τ the number of samples after
//! which the axis has forgotten its initial state, x the unknowns less their values at rest, and s
//! the standard deviations of the prior, the estimate minimises
//!
//! ```text
//!   Σ r² + σ²·τ·Σ (x/s)²
//! ```
//!
//! (one independent error in τ samples). If rest explains the stretch as well, the axis begins at
//! rest.

mod plausibility;
mod search;

use crate::measurement::{ResponseKind, Transient};
use crate::simulate;
use crate::simulate::{InitialState, NoResponse, Quantity, Unknown};

use super::Model;
use search::Search;

/// Smallest mean square error that is assumed of a model, as a share of the mean square of the
/// response. It keeps the prior in force for a model that fits perfectly, so that unknowns that the
/// stretch does not determine stay at rest.
const SMALLEST_MODEL_ERROR: f64 = 1e-6;

/// A moving start must lower the sum by this many variances of an independent error, σ²·τ. If an
/// unknown truly is at rest, that happens by chance in 3 of 1000 motions (χ² with one degree of
/// freedom above 9).
const LEAST_GAIN_IN_VARIANCES: f64 = 9.0;

/// A moving start must also lower the sum by this share of the sum at rest (tuned).
const LEAST_RELATIVE_GAIN: f64 = 0.05;

/// An estimated quantity of the initial state.
#[derive(Debug, Clone, PartialEq)]
pub struct Begun {
    /// Which quantity.
    pub quantity: Quantity,
    /// Its value, in the units of the measurement.
    pub value: f64,
    /// Why the value is implausible, in words; `None` if it is plausible.
    pub implausible: Option<String>,
}

impl Model<'_> {
    /// Estimates the initial state from the first `count` samples. Returns it with the quantities
    /// that were estimated; there are none if the axis begins at rest.
    pub(super) fn estimated(
        &self,
        rest: InitialState,
        count: usize,
    ) -> Result<(InitialState, Vec<Begun>), NoResponse> {
        let all_of = self.compared(&self.transient.output);
        let size = (all_of.iter().map(|y| y * y).sum::<f64>() / all_of.len() as f64).sqrt();
        let size = if size > 0.0 { size } else { 1.0 };
        let unknowns = self.unknowns();
        let Transient { output, step_s, .. } = self.transient;
        let independent = (1.0 / (self.plant.viscous_rate_rad_s * step_s)).max(1.0);
        let mut search = Search {
            model: self,
            rest,
            unknowns: &unknowns,
            measured: self.compared(&output[..count]),
            size,
            error: SMALLEST_MODEL_ERROR * independent,
        };
        let still = vec![0.0; unknowns.len()];
        let free = search.best(search.starts()?)?;
        // The model's error σ² is measured on the samples after the stretch, for both candidates. A
        // correct initial state also improves these. One that merely compensates for an error of
        // the model does not, and then rest has the smaller error.
        let later = [&still, &free.1].map(|point| self.later_error(&search.initial(point), count));
        let [rest_later, free_later] = later;
        let error = rest_later?.min(free_later?) / (size * size);
        search.error = error.max(SMALLEST_MODEL_ERROR) * independent;
        let at_rest = search.sum(&still)?;
        let best = search.best(vec![free.1])?;
        if best.0 > (1.0 - LEAST_RELATIVE_GAIN) * at_rest
            || at_rest - best.0 < LEAST_GAIN_IN_VARIANCES * search.error
        {
            return Ok((rest, Vec::new()));
        }
        let shown = self.first_velocity(count);
        let begun = |(unknown, x): (&Unknown, &f64)| {
            let value = unknown.at_rest + x * unknown.size;
            let implausible = self.implausible(unknown, value, shown);
            Begun { quantity: unknown.quantity, value, implausible }
        };
        let begun = unknowns.iter().zip(&best.1).map(begun).collect();
        Ok((search.initial(&best.1), begun))
    }

    /// Mean square error of the model after the first `count` samples.
    fn later_error(&self, initial: &InitialState, count: usize) -> Result<f64, NoResponse> {
        let Transient { input, output, .. } = self.transient;
        let simulated = self.response(input.len(), initial)?;
        let pairs = self.compared(&output[count..]).into_iter();
        let pairs = pairs.zip(self.compared(&simulated[count..]));
        let squares: f64 = pairs.map(|(measured, simulated)| (measured - simulated).powi(2)).sum();
        Ok(squares / (output.len() - count).max(1) as f64)
    }

    /// The quantities of the initial state that act on the motion and are not given.
    fn unknowns(&self) -> Vec<Unknown> {
        let Transient { input, output, step_s, beginning, .. } = self.transient;
        let largest = input.iter().fold(0.0, |most: f64, u| most.max(u.abs()));
        let range = |values: &mut dyn Iterator<Item = f64>| {
            let ends = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| {
                (low.min(x), high.max(x))
            });
            ends.1 - ends.0
        };
        let mut sum = 0.0;
        let travel = match self.kind {
            ResponseKind::Position => range(&mut output.iter().copied()),
            ResponseKind::Velocity => range(&mut output.iter().map(|v| {
                sum += v * step_s;
                sum
            })),
            ResponseKind::Acceleration => {
                largest * self.plant.constant.abs() / self.plant.viscous_rate_rad_s.powi(2)
            }
        };
        let mut unknowns =
            simulate::unknowns(self.plant, self.effects, [input[0], largest], travel);
        unknowns.retain(|unknown| {
            let known = unknown.quantity == Quantity::Position && beginning.position.is_some();
            unknown.size > 0.0 && unknown.size.is_finite() && !known
        });
        unknowns
    }
}
