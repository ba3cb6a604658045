//! What an integration tells of its steps and switches, for derivatives to be carried along.

use crate::effects::TaylorSeries;
use crate::plant::Scalar;

use super::mechanics::{Event, Mode};
use super::runge_kutta::{Stages, Vector};
use super::step::Step;
use crate::simulate::signal::fourier::Fourier;
use crate::simulate::signal::piecewise_quintic::{Cell, Quintic, restricted};

/// A step's place: a cell of the torque, and the part of it that the step covers.
pub(super) struct Span<'a> {
    /// Index of the cell.
    pub index: usize,
    pub cell: &'a Cell<f64>,
    /// Position in the cell at which the step begins, 0 to 1.
    pub from: f64,
    /// Length, as a share of the cell.
    pub width: f64,
}

impl Span<'_> {
    /// Length, seconds.
    pub fn length_s(&self) -> f64 {
        self.width * self.cell.length_s
    }

    /// Start, seconds.
    pub fn start_s(&self) -> f64 {
        self.cell.from_s + self.from * self.cell.length_s
    }

    /// The grid cell that the step covers, if it is a whole one.
    pub fn whole(&self) -> Option<usize> {
        self.cell.whole.filter(|_| self.from == 0.0 && self.width == 1.0)
    }

    /// Coefficients of a signal of the cell over the step.
    #[inline]
    pub fn of(&self, powers: &Quintic<f64>) -> Quintic<f64> {
        match self.width {
            1.0 => *powers,
            width => restricted(powers, self.from, self.from + width),
        }
    }
}

/// An accepted step.
pub(super) struct Taken<'a, const M: usize> {
    pub mode: Mode,
    pub span: Span<'a>,
    /// The state at its beginning.
    pub start: &'a Vector<f64, M>,
    pub step: &'a Step<M>,
    /// The Taylor series of the nonlinear torques over it; empty unless it is a step by series.
    pub nonlinear: &'a [TaylorSeries],
}

/// A switch within a step.
pub(super) struct Crossing<'a, const M: usize> {
    pub event: Event,
    /// Position in the step, 0 to 1, of the state and slope below.
    pub at: f64,
    pub state: &'a Vector<f64, M>,
    pub slope: &'a Vector<f64, M>,
    /// Derivative of the event's signal by time.
    pub rate_s: f64,
    /// Time from `at` to the switch, seconds: the correction by one Newton step.
    pub late_s: f64,
    /// Position of the switch in the step.
    pub reach: f64,
}

/// Follows an integration step by step, and carries derivatives along.
pub(super) trait Companion<const M: usize> {
    /// Whether it needs v within steps, not only at their ends.
    fn needs_interior(&self) -> bool;

    /// Whether it needs derivatives by the parameters of nonlinear torques.
    fn parameters_vary(&self) -> bool;

    /// A Runge–Kutta step, whose stages it computes with derivatives; they are kept until the step
    /// is taken or another one is tried.
    fn try_stages(&mut self, mode: Mode, span: &Span<'_>, start: &Vector<f64, M>)
    -> Stages<f64, M>;

    /// A whole step.
    fn step(&mut self, taken: &Taken<'_, M>);

    /// A step up to a switch.
    fn step_to_switch(&mut self, taken: &Taken<'_, M>, crossing: &Crossing<'_, M>);

    /// The switch is done; `slope` is the derivative of the state by time right behind it.
    fn switched(&mut self, event: Event, slope: &Vector<f64, M>);

    /// The axis leaves rest on its bristles, at a position of a cell; `state` is the one before. See
    /// [`super::mechanics::Mechanics::leave_rest_on_bristles`].
    fn leave_rest_on_bristles(&mut self, mode: Mode, place: (usize, f64), state: &Vector<f64, M>);

    /// The bristle is deflected fully.
    fn deflect_fully(&mut self, mode: Mode);
}

/// Adds a polynomial over a step, up to position `reach`, to Fourier integrals.
#[inline]
pub(super) fn add_powers<S: Scalar>(
    sums: &mut Fourier<'_, S>,
    span: &Span<'_>,
    length_s: f64,
    reach: f64,
    powers: &[S],
) {
    match span.whole() {
        Some(n) if powers.len() <= 6 && reach == 1.0 => {
            let mut quintic = [S::constant(0.0); 6];
            quintic[..powers.len()].copy_from_slice(powers);
            sums.add_whole(n, quintic);
        }
        _ => sums.add_fixed(span.start_s(), length_s, reach, powers),
    }
}
