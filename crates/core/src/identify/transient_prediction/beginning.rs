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

use nalgebra::{DMatrix, DVector};

use crate::identify::levenberg_marquardt::{
    FIRST_DAMPING, LeastSquares, Linearisation, Patience, minimise,
};
use crate::measurement::{ResponseKind, Transient};
use crate::simulate;
use crate::simulate::{InitialState, NoResponse, Quantity, Unknown};

use super::Model;
use super::first_samples::at_first;

/// Smallest mean square error that is assumed of a model, as a share of the mean square of the
/// response. It keeps the prior in force for a model that fits perfectly, so that unknowns that the
/// stretch does not determine stay at rest.
const SMALLEST_MODEL_ERROR: f64 = 1e-6;

/// Standard deviation of the prior of an unknown, in units of [`Unknown::size`]: that of a uniform
/// distribution over ±1, 1/√3.
const PRIOR_STD: f64 = 0.577_350_269_189_625_8;

/// A moving start must lower the sum by this many variances of an independent error, σ²·τ. If an
/// unknown truly is at rest, that happens by chance in 3 of 1000 motions (χ² with one degree of
/// freedom above 9).
const LEAST_GAIN_IN_VARIANCES: f64 = 9.0;

/// An estimated initial velocity is implausible if it differs from that of the first samples by
/// more than this share of the rms velocity (tuned) and [`VELOCITY_ERRORS`].
const VELOCITY_TOLERANCE: f64 = 0.1;

/// Standard errors of the velocity of the first samples that are tolerated besides: normal noise
/// exceeds them in 6 of 100 000 motions.
const VELOCITY_ERRORS: f64 = 4.0;

/// A moving start must also lower the sum by this share of the sum at rest (tuned).
const LEAST_RELATIVE_GAIN: f64 = 0.05;

/// When the least-squares fit ends (tuned): a beginning is not known more accurately than this.
const PATIENCE: Patience = Patience {
    steps: 12,
    evaluations: u64::MAX,
    cost_tolerance: 1e-6,
    negligible: 0.0,
    damping: FIRST_DAMPING,
    linear_within: 0.0,
};

/// Step of an unknown, in units of its size, for finite differences.
const DIFFERENCE: f64 = 1e-5;

/// Initial positions that are tried if the position acts on the motion (tuned).
const POSITIONS_TRIED: usize = 12;

/// The best of these, from which least squares start (tuned).
const POSITIONS_REFINED: usize = 3;

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

/// The velocity that the first samples show.
#[derive(Debug, Clone, Copy, PartialEq)]
struct FirstVelocity {
    /// Its value at the first sample.
    value: f64,
    /// Its standard error.
    std: f64,
    /// The rms velocity of the whole motion.
    usual: f64,
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

    /// The velocity with which the motion begins; `None` for an acceleration, from which it cannot
    /// be read.
    fn first_velocity(&self, count: usize) -> Option<FirstVelocity> {
        let Transient { output, step_s, .. } = self.transient;
        let early = &output[..(count / 20).clamp(4, 50).min(output.len())];
        let rms = |squares: f64, count: usize| (squares / count.max(1) as f64).sqrt();
        match self.kind {
            ResponseKind::Velocity => {
                let [value, std] = at_first(early, 0);
                let usual = rms(output.iter().map(|v| v * v).sum(), output.len());
                Some(FirstVelocity { value, std, usual })
            }
            ResponseKind::Position => {
                // Take differences over the same span as the slope, so that noise does not dominate
                // them.
                let apart = early.len() - 1;
                let steps = output.iter().zip(&output[apart..]);
                let squares = steps.map(|(a, b)| ((b - a) / (apart as f64 * step_s)).powi(2));
                let usual = rms(squares.sum(), output.len() - apart);
                let [value, std] = at_first(early, 1).map(|per_step| per_step / step_s);
                Some(FirstVelocity { value, std, usual })
            }
            ResponseKind::Acceleration => None,
        }
    }

    /// Why this initial value of an unknown is implausible; `None` if it is plausible.
    fn implausible(
        &self,
        unknown: &Unknown,
        value: f64,
        shown: Option<FirstVelocity>,
    ) -> Option<String> {
        let Unknown { quantity, at_rest, size } = *unknown;
        if (value - at_rest).abs() > size {
            return Some(format!(
                "it is larger than {size:.4}, the most that the largest input can \
                                 cause"
            ));
        }
        let shown = shown.filter(|_| quantity == Quantity::Velocity)?;
        let FirstVelocity { value: first, std, usual } = shown;
        let tolerance = VELOCITY_TOLERANCE * usual + VELOCITY_ERRORS * std;
        ((value - first).abs() > tolerance).then(|| {
            format!("the first samples show {first:.4}, with {usual:.4} rms over the motion")
        })
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

/// Least squares over the first stretch. A point holds, for each unknown, its distance from rest in
/// units of [`Unknown::size`].
struct Search<'a> {
    model: &'a Model<'a>,
    rest: InitialState,
    unknowns: &'a [Unknown],
    measured: Vec<f64>,
    /// Rms of the response.
    size: f64,
    /// σ²·τ, divided by the square of `size`.
    error: f64,
}

impl Search<'_> {
    fn initial(&self, point: &[f64]) -> InitialState {
        let mut initial = self.rest;
        for (unknown, x) in self.unknowns.iter().zip(point) {
            // An unknown at rest is not set: the simulation has its own rest value. For a torque
            // that is the actuator's output under the first input, after any effects ahead of the
            // actuator.
            if *x != 0.0 || unknown.quantity == Quantity::Velocity {
                initial.set(unknown.quantity, unknown.at_rest + x * unknown.size);
            }
        }
        initial
    }

    /// Residuals of the stretch, divided by `size`, then those of the prior.
    fn residuals(&self, point: &[f64]) -> Result<DVector<f64>, NoResponse> {
        let count = self.measured.len();
        let simulated = self.model.response(count, &self.initial(point))?;
        let left = self.model.compared(&simulated);
        let left = left.iter().zip(&self.measured).map(|(s, m)| (m - s) / self.size);
        let prior_weight = self.error.sqrt() / PRIOR_STD;
        let all: Vec<f64> = left.chain(point.iter().map(|x| prior_weight * x)).collect();
        Ok(DVector::from_vec(all))
    }

    /// The sum that is to be least.
    fn sum(&self, point: &[f64]) -> Result<f64, NoResponse> {
        Ok(self.residuals(point)?.norm_squared())
    }

    /// Starting points: the velocity of the first samples, with the initial positions that suit it
    /// best.
    fn starts(&self) -> Result<Vec<Vec<f64>>, NoResponse> {
        let shown = self.model.first_velocity(self.measured.len());
        let velocity = shown.map_or(0.0, |shown| shown.value);
        let mut start = vec![0.0; self.unknowns.len()];
        for (x, unknown) in start.iter_mut().zip(self.unknowns) {
            if unknown.quantity == Quantity::Velocity {
                *x = velocity / unknown.size;
            }
        }
        let position = self.unknowns.iter().position(|u| u.quantity == Quantity::Position);
        let Some(position) = position else { return Ok(vec![start]) };
        let mut tried = Vec::new();
        for step in 0..POSITIONS_TRIED {
            let mut point = start.clone();
            point[position] = 2.0 * (step as f64 + 0.5) / POSITIONS_TRIED as f64 - 1.0;
            tried.push((self.sum(&point)?, point));
        }
        tried.push((self.sum(&start)?, start));
        tried.sort_by(|a, b| a.0.total_cmp(&b.0));
        Ok(tried.into_iter().take(POSITIONS_REFINED).map(|(_, point)| point).collect())
    }

    /// The least sum, and its point, found by least squares from `starts`; rest is a candidate too.
    fn best(&self, starts: Vec<Vec<f64>>) -> Result<(f64, Vec<f64>), NoResponse> {
        let still = vec![0.0; self.unknowns.len()];
        let mut best = (self.sum(&still)?, still);
        for start in starts {
            let found = minimise(self, &start, PATIENCE, &mut |_, _, _| ());
            if found.cost < best.0 {
                best = (found.cost, found.point);
            }
        }
        Ok(best)
    }
}

impl LeastSquares for Search<'_> {
    type Error = NoResponse;

    fn cost(&self, point: &[f64]) -> f64 {
        self.sum(point).unwrap_or(f64::INFINITY)
    }

    /// Derivatives by differences.
    fn linearise(&self, point: &[f64]) -> Result<Linearisation, NoResponse> {
        let residuals = self.residuals(point)?;
        let mut jacobian = DMatrix::zeros(residuals.len(), point.len());
        for column in 0..point.len() {
            let mut moved = point.to_vec();
            moved[column] += DIFFERENCE;
            let change = (self.residuals(&moved)? - &residuals) / DIFFERENCE;
            jacobian.set_column(column, &change);
        }
        Ok(Linearisation { residuals, jacobian })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::identify::fixtures::{ACTUATORS, axis};

    // A velocity of 0.1 for 200 samples, sampled every 0.01 s.
    #[test]
    fn a_beginning_is_implausible_beyond_the_reach_of_the_input_or_far_from_the_first_samples() {
        let transient = Transient {
            step_s: 0.01,
            input: vec![1.0; 200],
            output: vec![0.1; 200],
            ..Transient::default()
        };
        let plant = axis(ACTUATORS[0]);
        let kind = ResponseKind::Velocity;
        let model =
            Model { plant: &plant, effects: &[], run_share: 0.0, kind, transient: &transient };
        let shown = model.first_velocity(100);
        let is_steady = |shown: FirstVelocity| {
            (shown.value - 0.1).abs() + (shown.usual - 0.1).abs() + shown.std < 1e-12
        };
        assert!(is_steady(shown.unwrap()), "{shown:?}");
        let velocity = Unknown { quantity: Quantity::Velocity, at_rest: 0.0, size: 1.0 };
        assert_eq!(model.implausible(&velocity, 0.105, shown), None);
        assert!(model.implausible(&velocity, 0.2, shown).unwrap().contains("show 0.1000"));
        assert!(model.implausible(&velocity, -1.2, shown).unwrap().contains("larger than 1.0000"));
        let torque = Unknown { quantity: Quantity::Torque, at_rest: 1.0, size: 2.0 };
        assert_eq!(model.implausible(&torque, 2.9, shown), None);
        assert!(model.implausible(&torque, 3.1, shown).is_some());

        // The same motion as a position, which rises by 0.001 per step.
        let output = (0..200).map(|n| 0.001 * f64::from(n)).collect();
        let transient = Transient { output, ..transient.clone() };
        let position = Model { kind: ResponseKind::Position, transient: &transient, ..model };
        let shown = position.first_velocity(100).unwrap();
        assert!(is_steady(shown), "{shown:?}");
    }

    // v = sin(8t + 0.4), sampled every 2 ms: it begins at 0.389, and 50 samples have a mean of 0.70.
    #[test]
    fn an_axis_that_accelerates_begins_with_the_velocity_of_its_first_sample() {
        let angle = |n: i32| 0.016 * f64::from(n) + 0.4;
        let noise = |n: i32| 1e-3 * f64::from((n * 7919) % 101 - 50) / 50.0;
        let plant = axis(ACTUATORS[0]);
        let velocities = (0..1500).map(|n| angle(n).sin() + 10.0 * noise(n)).collect();
        let positions = (0..1500).map(|n| 0.1 * noise(n) - angle(n).cos() / 8.0).collect();
        for (kind, output) in
            [(ResponseKind::Velocity, velocities), (ResponseKind::Position, positions)]
        {
            let transient =
                Transient { step_s: 0.002, input: vec![1.0; 1500], output, ..Transient::default() };
            let model =
                Model { plant: &plant, effects: &[], run_share: 0.0, kind, transient: &transient };
            let shown = model.first_velocity(1500);
            let velocity = Unknown { quantity: Quantity::Velocity, at_rest: 0.0, size: 2.0 };
            assert_eq!(model.implausible(&velocity, 0.389, shown), None, "{shown:?}");
            assert!(model.implausible(&velocity, 0.7, shown).is_some(), "{shown:?}");
        }
    }
}
