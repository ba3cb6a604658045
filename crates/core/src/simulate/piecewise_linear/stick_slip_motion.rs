//! The exact motion of one mass under a piecewise quintic torque, with friction and damping that
//! depend on the direction alone.
//!
//! While the axis slides, x = v/K is the response of a first-order lag, exact for each quintic
//! (`exponential_integrator`). One pass over the period finds the times at which the axis stops and
//! starts. The harmonics follow from x' = −a·x + τ − f: since x = 0 at both ends of each slide,
//! Xₖ = ∫(τ − f)·exp(−jkωt) dt/(jkω + a), integrated over the slides of each direction.

mod slide_end;

use crate::effects::Axis;
use crate::plant::Scalar;

use crate::simulate::base::switching_times::Motion;
use crate::simulate::signal::complex_dual::ComplexDual;
use crate::simulate::signal::exponential_integrator::ExponentialIntegrator;
use crate::simulate::signal::fourier::Fourier;
use crate::simulate::signal::grid::Grid;
use crate::simulate::signal::piecewise_quintic::{Cell, PiecewiseQuintic, Quintic, restricted};
use slide_end::Sliding;

/// Rounding error of x as a share of its size; decides the sign of x just after a switch.
const RELATIVE_ROUNDING: f64 = 1e-13;

/// Most switches in one cell; more mean that the switching times accumulate.
const MOST_SWITCHES_PER_CELL: usize = 64;

/// State of the axis: x = v/K, and whether it slides or rests.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct State<S> {
    pub x: S,
    pub motion: Motion,
}

/// One mass with damping and signed friction levels; arrays hold (forward, backward).
pub(crate) struct OneMass<S> {
    viscous_rate: [S; 2],
    coulomb: [S; 2],
    breakaway: [S; 2],
    /// Smallest and largest torque.
    range: (f64, f64),
    /// An estimate of the largest |x|.
    scale: f64,
    /// Steps over a whole cell.
    relaxation: [ExponentialIntegrator<S>; 2],
    /// Length of a whole cell, seconds.
    whole_s: f64,
}

/// Fourier integrals of τ − f over the slides, by direction unless both have the same damping.
pub(crate) struct Slides<'g, S> {
    by_direction: Vec<Fourier<'g, S>>,
}

impl<'g, S: Scalar> Slides<'g, S> {
    pub fn new(mass: &OneMass<S>, grid: &'g Grid, omega: f64, highest: usize) -> Self {
        let alike = mass.viscous_rate[0] == mass.viscous_rate[1];
        let count = if alike { 1 } else { 2 };
        Self { by_direction: (0..count).map(|_| Fourier::new(grid, omega, highest)).collect() }
    }

    /// Harmonics V₀ … V_H.
    pub fn velocity(self, mass: &OneMass<S>, constant: S, period_s: f64) -> Vec<ComplexDual<S>> {
        let omega = std::f64::consts::TAU / period_s;
        let mut harmonics: Vec<ComplexDual<S>> = Vec::new();
        for (direction, sums) in self.by_direction.into_iter().enumerate() {
            let a = mass.viscous_rate[direction];
            for (k, sum) in sums.finish().into_iter().enumerate() {
                let through = ComplexDual::new(a, S::constant(k as f64 * omega)).inverse();
                let mut part = (sum * through)
                    .scaled(constant * crate::simulate::base::spectrum::weight(k, period_s));
                if k == 0 {
                    part = ComplexDual::real(part.re);
                }
                match harmonics.get_mut(k) {
                    Some(harmonic) => *harmonic = *harmonic + part,
                    None => harmonics.push(part),
                }
            }
        }
        harmonics
    }
}

impl<S: Scalar> OneMass<S> {
    pub fn new(axis: &Axis<S>, forcing: &PiecewiseQuintic<S>) -> Self {
        let levels = axis.levels();
        let viscous_rate = axis.viscous_rates();
        let (least, most) = forcing.range();
        let slowest = viscous_rate[0].value().min(viscous_rate[1].value());
        let reach = (1.0 / slowest).min(forcing.period_s / std::f64::consts::TAU);
        let whole = forcing.cells.iter().find(|cell| cell.whole.is_some());
        let whole_s = whole.map_or(forcing.period_s, |cell| cell.length_s);
        Self {
            viscous_rate,
            coulomb: [levels.fc_plus, -levels.fc_minus],
            breakaway: [levels.fs_plus, -levels.fs_minus],
            range: (least, most),
            scale: most.abs().max(least.abs()) * reach,
            relaxation: viscous_rate.map(|a| ExponentialIntegrator::new(a * whole_s)),
            whole_s,
        }
    }

    /// Converts every number with `f`.
    pub fn map<T: Scalar>(&self, f: impl Fn(S) -> T + Copy) -> OneMass<T> {
        let viscous_rate = self.viscous_rate.map(f);
        OneMass {
            viscous_rate,
            coulomb: self.coulomb.map(f),
            breakaway: self.breakaway.map(f),
            range: self.range,
            scale: self.scale,
            relaxation: viscous_rate.map(|a| ExponentialIntegrator::new(a * self.whole_s)),
            whole_s: self.whole_s,
        }
    }

    /// An estimate of the largest |x|.
    pub fn scale(&self) -> f64 {
        self.scale
    }

    /// Whether any two motions under the same torque approach each other.
    pub fn contracts(&self) -> bool {
        self.coulomb.map(S::value) == self.breakaway.map(S::value)
    }

    /// Whether the torque never exceeds the static levels.
    pub fn rests(&self) -> bool {
        let (least, most) = self.range;
        most <= self.breakaway[0].value() && least >= self.breakaway[1].value()
    }

    /// Follows the motion over one period, adding its slides to `slides` if given; `None` if the
    /// switching times accumulate.
    pub fn pass(
        &self,
        forcing: &PiecewiseQuintic<S>,
        start: State<S>,
        mut slides: Option<&mut Slides<'_, S>>,
    ) -> Option<State<S>> {
        let zero = S::constant(0.0);
        let mut state = start;
        for cell in &forcing.cells {
            let mut from = zero;
            let mut switches = 0;
            loop {
                let (to, next) = match direction(state.motion) {
                    None => self.breakaway_in(cell, from),
                    Some(direction) => self.slide_in(cell, from, state.x, direction),
                };
                if let (Some(direction), Some(slides)) =
                    (direction(state.motion), slides.as_deref_mut())
                {
                    self.add(slides, cell, from, to, direction);
                }
                state = next.unwrap_or(State { x: zero, motion: Motion::Stuck });
                if to.value() >= 1.0 {
                    break;
                }
                switches += 1;
                if switches > MOST_SWITCHES_PER_CELL {
                    return None;
                }
                from = to;
            }
        }
        Some(state)
    }

    /// Adds the slide between two positions of a cell to the integrals.
    fn add(&self, slides: &mut Slides<'_, S>, cell: &Cell<S>, from: S, to: S, direction: usize) {
        let last = slides.by_direction.len() - 1;
        let sums = &mut slides.by_direction[direction.min(last)];
        let (zero, one) = (S::constant(0.0), S::constant(1.0));
        let powers = self.driving(&cell.powers, direction);
        match cell.whole {
            Some(n) if from == zero && to == one => sums.add_whole(n, powers),
            _ => sums.add_part(&Cell { powers, ..*cell }, from, to),
        }
    }

    /// τ − f while sliding in this direction.
    fn driving(&self, powers: &Quintic<S>, direction: usize) -> Quintic<S> {
        let mut powers = *powers;
        powers[0] -= self.coulomb[direction];
        powers
    }

    /// Rest from position `from` of a cell on: the position of its end, and the state that follows.
    fn breakaway_in(&self, cell: &Cell<S>, from: S) -> (S, Option<State<S>>) {
        let start = cell.number(from.value());
        for (direction, motion) in MOVING.into_iter().enumerate() {
            let (level, sign) = (self.breakaway[direction], SIGN[direction]);
            let state = Some(State { x: S::constant(0.0), motion });
            if sign * (start - level.value()) > 0.0 {
                return (from, state);
            }
            if let Some(u) = cell.crossing(from.value(), level.value(), sign) {
                let at = S::constant(u);
                return (at - (cell.at(at) - level) / cell.slope(at), state);
            }
        }
        (S::constant(1.0), None)
    }

    /// x at position `to` of a slide, from its value at position `from`.
    fn slid(&self, cell: &Cell<S>, from: S, to: S, x: S, direction: usize) -> S {
        let is_whole = from == S::constant(0.0) && to == S::constant(1.0);
        if is_whole {
            let powers = self.driving(&cell.powers, direction);
            let own = (cell.length_s != self.whole_s)
                .then(|| ExponentialIntegrator::new(self.viscous_rate[direction] * cell.length_s));
            let relaxation = own.as_ref().unwrap_or(&self.relaxation[direction]);
            return relaxation.step(x, &powers, S::constant(cell.length_s));
        }
        let powers = self.driving(&restricted(&cell.powers, from, to), direction);
        let length_s = (to - from) * cell.length_s;
        ExponentialIntegrator::new(self.viscous_rate[direction] * length_s)
            .step(x, &powers, length_s)
    }

    /// A slide from position `from` of a cell on: the position of its end, and the state there.
    fn slide_in(&self, cell: &Cell<S>, from: S, x: S, direction: usize) -> (S, Option<State<S>>) {
        let one = S::constant(1.0);
        let end = self.slid(cell, from, one, x, direction);
        let numbers = self.numbers(direction);
        let Some(u) = numbers.stop(cell, from.value(), x.value(), end.value()) else {
            return (one, Some(State { x: end, motion: MOVING[direction] }));
        };
        // One Newton step in dual numbers gives the derivatives of the position.
        let at = S::constant(u);
        let rate = (cell.at(at) - self.coulomb[direction]) * cell.length_s;
        let at = at - self.slid(cell, from, at, x, direction) / rate;
        let (torque, other) = (cell.number(u), 1 - direction);
        let reverses = SIGN[other] * (torque - self.breakaway[other].value()) > 0.0;
        let motion = if reverses { MOVING[other] } else { Motion::Stuck };
        (at, Some(State { x: S::constant(0.0), motion }))
    }

    /// The slide without derivatives.
    fn numbers(&self, direction: usize) -> Sliding {
        Sliding {
            sign: SIGN[direction],
            rate: self.viscous_rate[direction].value(),
            friction: self.coulomb[direction].value(),
            rounding: RELATIVE_ROUNDING * self.scale,
        }
    }
}

const MOVING: [Motion; 2] = [Motion::Forward, Motion::Backward];
const SIGN: [f64; 2] = [1.0, -1.0];

fn direction(motion: Motion) -> Option<usize> {
    match motion {
        Motion::Forward => Some(0),
        Motion::Backward => Some(1),
        Motion::Stuck => None,
    }
}
