//! Step control: which method takes the next step, how long it is, and whether its error is
//! accepted.

use super::affine::{Affine, LONGEST_RATE_TIMES_STEP};
use super::mechanics::{Mechanics, Mode};
use crate::effects::TaylorSeries;
use crate::simulate::signal::piecewise_quintic::Cell;

/// Safety factor on the length for which the error would just be allowed; with a larger one too
/// many steps are rejected. Tuned.
const SAFETY: f64 = 0.8;

/// The method that takes the steps, and its state.
pub(super) enum StepControl<const M: usize> {
    /// Exact steps, no longer than `longest_s`. With `reuse`, the step's length is an equal part of
    /// a cell, and its matrices are cached.
    Exact { longest_s: f64, modes: Modes<M>, reuse: bool },
    /// Taylor series, each step as long as its error allows.
    Series { modes: Modes<M>, nonlinear: Vec<TaylorSeries> },
    /// Runge–Kutta steps with error control; `length_s` is the length to try next.
    Controlled { length_s: f64 },
}

/// The affine equations of every mode that has occurred so far.
pub(super) struct Modes<const M: usize>(Vec<Affine<f64, M>>);

impl<const M: usize> Modes<M> {
    /// The equations of a mode.
    #[inline]
    pub fn of(&mut self, mode: Mode, mechanics: &Mechanics<f64>) -> &mut Affine<f64, M> {
        let at = self.0.iter().position(|affine| affine.mode == mode).unwrap_or_else(|| {
            self.0.push(Affine::new(mechanics, mode));
            self.0.len() - 1
        });
        &mut self.0[at]
    }
}

impl<const M: usize> StepControl<M> {
    /// The method that suits the equations of motion. `parameters_vary` asks for the derivatives of
    /// Taylor series by the parameters of the torques.
    pub fn new(mechanics: &Mechanics<f64>, cell_s: f64, parameters_vary: bool) -> Self {
        let modes = Modes(Vec::new());
        if !mechanics.has_series() {
            return StepControl::Controlled { length_s: cell_s };
        }
        if mechanics.is_affine() && mechanics.half_gap().is_none() {
            let longest_s = LONGEST_RATE_TIMES_STEP / mechanics.fastest_rate();
            return StepControl::Exact { longest_s, modes, reuse: false };
        }
        StepControl::Series { modes, nonlinear: mechanics.series(parameters_vary) }
    }

    /// The Taylor series of the nonlinear torques over the last step; empty for other steps.
    pub fn nonlinear(&self) -> &[TaylorSeries] {
        match self {
            StepControl::Series { nonlinear, .. } => nonlinear,
            _ => &[],
        }
    }

    /// Effort of a step, as a number of exact steps.
    pub fn effort(&self) -> usize {
        match self {
            StepControl::Exact { .. } => 1,
            StepControl::Series { .. } | StepControl::Controlled { .. } => 4,
        }
    }

    /// The length of the next step from position `from`, as a share of the cell.
    #[inline]
    pub fn width(&mut self, cell: &Cell<f64>, from: f64) -> f64 {
        let left = 1.0 - from;
        match self {
            StepControl::Exact { longest_s, reuse, .. } => {
                // The cell is divided into equal parts, so that the cached matrices fit.
                let parts = (cell.length_s / *longest_s).ceil().max(1.0);
                let done = from * parts;
                // At the end of the cell only a rounding error may be left, which is no part.
                let begins = (done - done.round()).abs() < 1e-6 && done.round() < parts;
                *reuse = cell.whole.is_some() && begins;
                if *reuse {
                    return 1.0 / parts;
                }
                (((done + 1e-6).floor() + 1.0) / parts).min(1.0) - from
            }
            StepControl::Series { .. } => left,
            StepControl::Controlled { length_s } => {
                let share = *length_s / cell.length_s;
                // Avoids a very short step at the end of the cell.
                if share * 1.1 >= left { left } else { share }
            }
        }
    }

    /// Whether a step's error is allowed; if so, sets the length of the next step.
    #[inline]
    pub fn accepts(&mut self, error: f64, tried_s: f64, cell_s: f64) -> bool {
        if self.refuses(error, tried_s) {
            return false;
        }
        let StepControl::Controlled { length_s } = self else { return true };
        // A step cut short by the end of its cell says nothing about the next one.
        let next_s = length_s.max(tried_s) * growth(error).clamp(0.3, 4.0);
        *length_s = next_s.min(cell_s.max(tried_s));
        true
    }

    /// Whether a step's error is too large; if so, sets the length of the next attempt.
    #[inline]
    pub fn refuses(&mut self, error: f64, tried_s: f64) -> bool {
        match self {
            StepControl::Controlled { length_s } if error > 1.0 => {
                *length_s = tried_s * growth(error).max(0.2);
                true
            }
            _ => false,
        }
    }
}

/// Factor on the length that brings a step of this error just below the allowed error (5th-order
/// formula).
fn growth(error: f64) -> f64 {
    SAFETY * f64::from((error.max(1e-10) as f32).powf(-0.2))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_ends_where_its_cell_does_even_after_a_switch_just_before() {
        let cell = Cell { from_s: 0.0, length_s: 1.0, powers: [0.0; 6], whole: Some(0) };
        for (longest_s, parts) in [(2.0, 1.0), (0.4, 3.0)] {
            let modes = Modes(Vec::new());
            let mut pace = StepControl::<1>::Exact { longest_s, modes, reuse: false };
            for from in [0.0, 0.3, 1.0 / 3.0, 2.0 / 3.0, 1.0 - 1e-8, 1.0 - 1e-14] {
                let width = pace.width(&cell, from);
                assert!(width > 0.0 && width <= 1.0 / parts + 1e-15, "{from}: {width}");
                assert!(from + width <= 1.0 + 1e-6 / parts, "{from}: {width}");
            }
        }
    }
}
