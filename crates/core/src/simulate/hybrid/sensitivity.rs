//! Derivatives of a motion along N directions (lanes), carried along step by step: forward
//! sensitivity analysis (Hairer, Nørsett, Wanner 1993, Solving Ordinary Differential Equations I,
//! I.14 and II.6).
//!
//! The motion itself is integrated in plain numbers, but for Runge–Kutta steps. For each of its steps
//! the derivatives of the state at the end follow from those at the beginning: by the variational
//! equations where the equations of motion are affine or the step is a Taylor series. Runge–Kutta
//! stages are computed in dual numbers. At a switch the switching time has derivatives too, by the
//! implicit function theorem on the event's signal.

mod linear_mode;
mod steps;

use crate::plant::{Dual, Scalar as _};

use super::companion::{Companion, Crossing, Span, Taken, add_powers};
use super::mechanics::{Event, Mechanics, Mode, VELOCITY};
use super::runge_kutta::{Stages, Vector};
use super::series::MOST_POWERS;
use crate::simulate::piecewise_linear::drive::TorqueDerivatives;
use crate::simulate::signal::fourier::Fourier;
use crate::simulate::signal::piecewise_quintic::{
    PiecewiseQuintic, Quintic, polynomial, slope as quintic_slope,
};
use linear_mode::LinearMode;

/// Coefficients of a quintic.
const QUINTIC: usize = 6;

/// Derivatives of a state vector: a row of N lanes for each state.
pub(super) type Lanes<const N: usize, const M: usize> = [[f64; N]; M];

/// The derivatives of a motion at the present time.
pub(super) struct Sensitivity<'a, 'g, const N: usize, const M: usize> {
    pub mechanics: &'a Mechanics<Dual<N>>,
    pub forcing: &'a PiecewiseQuintic<f64>,
    pub torque: &'a TorqueDerivatives,
    /// Sums of the Fourier integrals of v, if wanted.
    pub sums: Option<Fourier<'g, Dual<N>>>,
    /// Derivatives of the state.
    pub lanes: Lanes<N, M>,
    modes: Vec<LinearMode<N, M>>,
    /// Derivatives of the torque over the present step.
    torque_powers: Vec<(usize, Quintic<f64>)>,
    /// The Runge–Kutta step that was tried last.
    tried: Option<Stages<Dual<N>, M>>,
    /// Slope at the end of the last Runge–Kutta step, where the next one of the same mode begins.
    slope: Option<(Mode, Vector<Dual<N>, M>)>,
    /// Derivatives of the slope at the end of the last exact step.
    exact_slope: Option<(Mode, Lanes<N, M>)>,
    /// Derivatives of the last switching time.
    late_s: [f64; N],
    /// Derivatives of v over the present step: coefficients of the powers of u.
    powers: [[f64; N]; MOST_POWERS],
}

impl<'a, 'g, const N: usize, const M: usize> Sensitivity<'a, 'g, N, M> {
    pub fn new(
        mechanics: &'a Mechanics<Dual<N>>,
        (forcing, torque): (&'a PiecewiseQuintic<f64>, &'a TorqueDerivatives),
        sums: Option<Fourier<'g, Dual<N>>>,
        lanes: Lanes<N, M>,
    ) -> Self {
        Self {
            mechanics,
            forcing,
            torque,
            sums,
            lanes,
            modes: Vec::new(),
            torque_powers: Vec::new(),
            tried: None,
            slope: None,
            exact_slope: None,
            late_s: [0.0; N],
            powers: [[0.0; N]; MOST_POWERS],
        }
    }

    /// After a switch the next step begins with another slope.
    fn forget_slopes(&mut self) {
        (self.slope, self.exact_slope) = (None, None);
    }

    /// The torque at a position of a cell, with its derivatives.
    fn torque_at(&self, (index, at): (usize, f64)) -> Dual<N> {
        self.lifted_torque(
            self.forcing.cells[index].fixed(at),
            |powers| polynomial(powers, at),
            index,
        )
    }

    fn lifted_torque(
        &self,
        value: f64,
        of: impl Fn(&Quintic<f64>) -> f64,
        index: usize,
    ) -> Dual<N> {
        let mut lanes = [0.0; N];
        for (lane, cells) in &self.torque.by_lane {
            lanes[*lane] = of(&cells[index]);
        }
        Dual::with_lanes(value, |lane| lanes[lane])
    }

    /// Adds v over a step, up to position `reach`, to the Fourier integrals.
    fn add(&mut self, taken: &Taken<'_, M>, reach: f64) {
        let Some(sums) = &mut self.sums else { return };
        let values = taken.step.numbers(VELOCITY);
        let values = values.all();
        let mut add = |powers: &[Dual<N>]| {
            add_powers(sums, &taken.span, taken.step.length_s(), reach, powers);
        };
        let power = |i: usize| match values.get(i) {
            Some(value) => Dual::with_lanes(*value, |lane| self.powers[i][lane]),
            None => Dual::constant(0.0),
        };
        // Most steps are quintics; arrays for more coefficients are large.
        match values.len() {
            ..=QUINTIC => add(&std::array::from_fn::<_, QUINTIC, _>(power)[..values.len()]),
            _ => add(&std::array::from_fn::<_, MOST_POWERS, _>(power)[..values.len()]),
        }
    }
}

impl<const N: usize, const M: usize> Companion<M> for Sensitivity<'_, '_, N, M> {
    fn needs_interior(&self) -> bool {
        self.sums.is_some()
    }

    /// Every state at the beginning has a lane; those beyond these are the parameters'.
    fn parameters_vary(&self) -> bool {
        N > M
    }

    fn try_stages(
        &mut self,
        mode: Mode,
        span: &Span<'_>,
        start: &Vector<f64, M>,
    ) -> Stages<f64, M> {
        self.tried.insert(self.lifted_stages(mode, span, start)).values()
    }

    fn step(&mut self, taken: &Taken<'_, M>) {
        let there = self.follow(taken, 1.0, false);
        self.add(taken, 1.0);
        self.lanes = there.state;
    }

    fn step_to_switch(&mut self, taken: &Taken<'_, M>, crossing: &Crossing<'_, M>) {
        let there = self.follow(taken, crossing.at, true);
        if crossing.reach > 0.0 {
            self.add(taken, crossing.reach);
        }
        let place = (taken.span.index, taken.span.from + taken.span.width * crossing.at);
        let state = lifted(crossing.state, &there.state);
        let torque = self.torque_at(place);
        let signal = self.mechanics.signal(crossing.event, taken.mode, torque, &state);
        let rate_s = crossing.rate_s;
        self.late_s = match rate_s == 0.0 {
            true => [0.0; N],
            false => std::array::from_fn(|lane| -signal.lane(lane) / rate_s),
        };
        for i in 0..M {
            for lane in 0..N {
                self.lanes[i][lane] = there.state[i][lane]
                    + crossing.slope[i] * self.late_s[lane]
                    + there.slope[i][lane] * crossing.late_s;
            }
        }
        self.forget_slopes();
    }

    /// Moves the derivatives from the switching time, which has derivatives itself, to its plain
    /// value, so that all times of the motion are plain numbers. The Fourier integrals need no
    /// correction: v is continuous, so that they gain before the switch what they lose after it.
    fn switched(&mut self, event: Event, slope: &Vector<f64, M>) {
        if event == Event::Stops {
            self.lanes[VELOCITY] = [0.0; N];
        }
        for (lanes, slope) in self.lanes.iter_mut().zip(slope) {
            lanes.iter_mut().zip(&self.late_s).for_each(|(lane, late)| *lane -= late * slope);
        }
        self.forget_slopes();
    }

    fn leave_rest_on_bristles(
        &mut self,
        mode: Mode,
        (index, at): (usize, f64),
        state: &Vector<f64, M>,
    ) {
        let mut lifted = lifted(state, &self.lanes);
        let cell = &self.forcing.cells[index];
        let rate = |powers: &Quintic<f64>| quintic_slope(powers, at) / cell.length_s;
        let rate = self.lifted_torque(rate(&cell.powers), rate, index);
        let torque = self.torque_at((index, at));
        self.mechanics.leave_rest_on_bristles(mode, torque, rate, &mut lifted);
        self.lanes = lanes_of(&lifted);
        self.forget_slopes();
    }

    fn deflect_fully(&mut self, mode: Mode) {
        let mut lifted = lifted(&[0.0; M], &self.lanes);
        self.mechanics.deflect_fully(mode, &mut lifted);
        self.lanes = lanes_of(&lifted);
        self.forget_slopes();
    }
}

/// A state with its derivatives as dual numbers.
fn lifted<const N: usize, const M: usize>(
    state: &Vector<f64, M>,
    lanes: &Lanes<N, M>,
) -> Vector<Dual<N>, M> {
    std::array::from_fn(|i| Dual::with_lanes(state[i], |lane| lanes[i][lane]))
}

/// The derivatives of a state in dual numbers.
fn lanes_of<const N: usize, const M: usize>(state: &Vector<Dual<N>, M>) -> Lanes<N, M> {
    std::array::from_fn(|i| std::array::from_fn(|lane| state[i].lane(lane)))
}
