//! The initial state of a motion, where the upload does not give it: a maximum a posteriori estimate.
//!
//! Its quantities are fitted by least squares to a first stretch. The prior is a normal distribution
//! about rest, as wide as any initial state to which the axis can be brought; how much the stretch
//! weighs against it depends on the model's own errors. With σ² the mean square of what the model
//! leaves, s the width, and τ the samples after which the axis has forgotten its initial state,
//!
//! ```text
//!   Σ r² + σ²·τ·Σ (x/s)²
//! ```
//!
//! is least (one independent error in τ samples). Where rest explains the stretch as well, the axis
//! begins at rest.

use nalgebra::{DMatrix, DVector};

use crate::identify::levenberg_marquardt::{LeastSquares, Linearisation, Patience, minimise};
use crate::measurement::{ResponseKind, Transient};
use crate::simulate;
use crate::simulate::{InitialState, NoResponse, Quantity, Unknown};

use super::Model;

/// Least mean square of what a model leaves, as a share of the square of the response: it keeps
/// at rest what the stretch does not tell.
const LEAST_ERROR: f64 = 1e-6;

/// Width of the law of an unknown about rest, in its sizes: the deviation of a uniform law from
/// one size below rest to one above, 1/√3.
const WIDTH: f64 = 0.577_350_269_189_625_8;

/// By how much a moving beginning must lower the sum in variances of an independent error: that
/// of one unknown at rest by chance exceeds 9 in 3 of 1000 motions.
const CERTAIN: f64 = 9.0;

/// Share of the root mean square of the velocity by which a first velocity may differ from that
/// which the first samples show.
const BESIDE: f64 = 0.1;

/// How much less a moving beginning must leave of the stretch than one at rest, as a share.
const WORTH: f64 = 0.05;

/// How far least squares go: a beginning is not known better than this.
const PATIENCE: Patience =
    Patience { steps: 12, evaluations: u64::MAX, cost_tolerance: 1e-6, negligible: 0.0 };

/// Difference of an unknown, in its sizes, from which derivatives are taken.
const DIFFERENCE: f64 = 1e-5;

/// First positions that are tried where one acts on the motion.
const POSITIONS: usize = 12;

/// Positions from which least squares go on.
const PROMISING: usize = 3;

/// A quantity that a motion was estimated to begin with.
#[derive(Debug, Clone, PartialEq)]
pub struct Begun {
    /// Which.
    pub quantity: Quantity,
    /// Its value, in the units of the measurement.
    pub value: f64,
    /// Why no axis is likely to begin so, in words.
    pub implausible: Option<String>,
}

impl Model<'_> {
    /// The beginning that explains the first `count` samples, and what in it is not as at
    /// rest.
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
            error: LEAST_ERROR * independent,
        };
        let still = vec![0.0; unknowns.len()];
        let free = search.best(search.starts()?)?;
        // A beginning that is right leaves less of what follows than rest does; one that makes up
        // for something else does not.
        let later = [&still, &free.1].map(|point| self.left_later(&search.initial(point), count));
        let [rest_later, free_later] = later;
        let error = rest_later?.min(free_later?) / (size * size);
        search.error = error.max(LEAST_ERROR) * independent;
        let at_rest = search.sum(&still)?;
        let best = search.best(vec![free.1])?;
        if best.0 > (1.0 - WORTH) * at_rest || at_rest - best.0 < CERTAIN * search.error {
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

    /// Mean square of what the model leaves of a motion behind the first `count` samples.
    fn left_later(&self, initial: &InitialState, count: usize) -> Result<f64, NoResponse> {
        let Transient { input, output, .. } = self.transient;
        let simulated = self.response(input.len(), initial)?;
        let pairs = self.compared(&output[count..]).into_iter();
        let pairs = pairs.zip(self.compared(&simulated[count..]));
        let squares: f64 = pairs.map(|(measured, simulated)| (measured - simulated).powi(2)).sum();
        Ok(squares / (output.len() - count).max(1) as f64)
    }

    /// The velocity that the first samples of a stretch show, and what the velocity is over the
    /// whole motion (root mean square); `None` of an acceleration, which shows none.
    fn first_velocity(&self, count: usize) -> Option<[f64; 2]> {
        let Transient { output, step_s, .. } = self.transient;
        let early = &output[..(count / 20).clamp(4, 50).min(output.len())];
        let rms = |squares: f64, count: usize| (squares / count.max(1) as f64).sqrt();
        match self.kind {
            ResponseKind::Velocity => {
                let mean = early.iter().sum::<f64>() / early.len() as f64;
                Some([mean, rms(output.iter().map(|v| v * v).sum(), output.len())])
            }
            ResponseKind::Position => {
                // Of neighbours as far apart as the slope is taken over, lest noise count.
                let apart = early.len() - 1;
                let steps = output.iter().zip(&output[apart..]);
                let squares = steps.map(|(a, b)| ((b - a) / (apart as f64 * step_s)).powi(2));
                Some([slope(early) / step_s, rms(squares.sum(), output.len() - apart)])
            }
            ResponseKind::Acceleration => None,
        }
    }

    /// Why an axis is unlikely to begin with this value of an unknown.
    fn implausible(
        &self,
        unknown: &Unknown,
        value: f64,
        shown: Option<[f64; 2]>,
    ) -> Option<String> {
        let Unknown { quantity, at_rest, size } = *unknown;
        if (value - at_rest).abs() > size {
            return Some(format!("it is beyond {size:.4}, what the largest input brings it to"));
        }
        let [first, usual] = shown.filter(|_| quantity == Quantity::Velocity)?;
        ((value - first).abs() > BESIDE * usual).then(|| {
            format!("the first samples show {first:.4}, with {usual:.4} rms over the motion")
        })
    }

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

/// Slope of the straight line through some values, per step.
fn slope(values: &[f64]) -> f64 {
    let count = values.len() as f64;
    let about = |n: usize| n as f64 - 0.5 * (count - 1.0);
    let sum: f64 = values.iter().enumerate().map(|(n, y)| about(n) * y).sum();
    sum * 12.0 / (count * (count * count - 1.0))
}

/// Least squares over a first stretch. Unknowns are counted from rest in their sizes.
struct Search<'a> {
    model: &'a Model<'a>,
    rest: InitialState,
    unknowns: &'a [Unknown],
    measured: Vec<f64>,
    /// Of the response, root mean square.
    size: f64,
    /// σ²·τ, in squares of the size.
    error: f64,
}

impl Search<'_> {
    fn initial(&self, point: &[f64]) -> InitialState {
        let mut initial = self.rest;
        for (unknown, x) in self.unknowns.iter().zip(point) {
            // At rest as it is without being told: where nothing is known of a torque it is
            // what the actuator was told, whatever stands ahead of it.
            if *x != 0.0 || unknown.quantity == Quantity::Velocity {
                initial.set(unknown.quantity, unknown.at_rest + x * unknown.size);
            }
        }
        initial
    }

    /// What is left of the stretch, and what the unknowns cost.
    fn residuals(&self, point: &[f64]) -> Result<DVector<f64>, NoResponse> {
        let count = self.measured.len();
        let simulated = self.model.response(count, &self.initial(point))?;
        let left = self.model.compared(&simulated);
        let left = left.iter().zip(&self.measured).map(|(s, m)| (m - s) / self.size);
        let reluctance = self.error.sqrt() / WIDTH;
        let all: Vec<f64> = left.chain(point.iter().map(|x| reluctance * x)).collect();
        Ok(DVector::from_vec(all))
    }

    /// The sum that is to be least.
    fn sum(&self, point: &[f64]) -> Result<f64, NoResponse> {
        Ok(self.residuals(point)?.norm_squared())
    }

    /// A velocity as the first samples show it, and the positions that suit them best.
    fn starts(&self) -> Result<Vec<Vec<f64>>, NoResponse> {
        let shown = self.model.first_velocity(self.measured.len());
        let velocity = shown.map_or(0.0, |[first, _]| first);
        let mut start = vec![0.0; self.unknowns.len()];
        for (x, unknown) in start.iter_mut().zip(self.unknowns) {
            if unknown.quantity == Quantity::Velocity {
                *x = velocity / unknown.size;
            }
        }
        let position = self.unknowns.iter().position(|u| u.quantity == Quantity::Position);
        let Some(position) = position else { return Ok(vec![start]) };
        let mut tried = Vec::new();
        for step in 0..POSITIONS {
            let mut point = start.clone();
            point[position] = 2.0 * (step as f64 + 0.5) / POSITIONS as f64 - 1.0;
            tried.push((self.sum(&point)?, point));
        }
        tried.push((self.sum(&start)?, start));
        tried.sort_by(|a, b| a.0.total_cmp(&b.0));
        Ok(tried.into_iter().take(PROMISING).map(|(_, point)| point).collect())
    }

    /// The least sum, and where, that is found from these points or rest.
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

    // A velocity of 0.1 over 200 samples, with a step of 0.01 s.
    #[test]
    fn a_beginning_is_implausible_beyond_what_the_input_does_or_beside_what_is_measured() {
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
        assert!(shown.unwrap().iter().all(|v| (v - 0.1).abs() < 1e-12), "{shown:?}");
        let velocity = Unknown { quantity: Quantity::Velocity, at_rest: 0.0, size: 1.0 };
        assert_eq!(model.implausible(&velocity, 0.105, shown), None);
        assert!(model.implausible(&velocity, 0.2, shown).unwrap().contains("show 0.1000"));
        assert!(model.implausible(&velocity, -1.2, shown).unwrap().contains("beyond 1.0000"));
        let torque = Unknown { quantity: Quantity::Torque, at_rest: 1.0, size: 2.0 };
        assert_eq!(model.implausible(&torque, 2.9, shown), None);
        assert!(model.implausible(&torque, 3.1, shown).is_some());

        // The same as a position, which rises by 0.001 a step.
        let output = (0..200).map(|n| 0.001 * f64::from(n)).collect();
        let transient = Transient { output, ..transient.clone() };
        let position = Model { kind: ResponseKind::Position, transient: &transient, ..model };
        let shown = position.first_velocity(100).unwrap();
        assert!(shown.iter().all(|v| (v - 0.1).abs() < 1e-12), "{shown:?}");
    }
}
