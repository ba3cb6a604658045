//! Derivatives of a motion along N directions (lanes), carried along step by step: forward
//! sensitivity analysis (Hairer, Nørsett, Wanner 1993, Solving Ordinary Differential Equations I,
//! I.14 and II.6).
//!
//! The motion itself is integrated in plain numbers. For each of its steps the derivatives of the
//! state at the end follow from those at the beginning: by the variational equations where the
//! equations of motion are affine or the step is a Taylor series, and by the same Runge–Kutta
//! stages in dual numbers otherwise. At a switch the switching time has derivatives too, by the
//! implicit function theorem on the event's signal.

mod linear_mode;

use crate::plant::{Dual, Scalar};

use super::integrate_period::{Companion, Crossing, Span, Taken, add_powers};
use super::mechanics::{Event, Mechanics, Mode, VELOCITY};
use super::runge_kutta::{NODES, Stages, Vector};
use super::series::{MOST_POWERS, Series};
use super::step::{Ends, Step};
use crate::simulate::base::switching_times::Motion;
use crate::simulate::piecewise_linear::drive::TorqueDerivatives;
use crate::simulate::signal::fourier::Fourier;
use crate::simulate::signal::piecewise_quintic::{
    PiecewiseQuintic, Quintic, polynomial, slope as quintic_slope, through,
};
use linear_mode::LinearMode;

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
    /// Slope at the end of the last Runge–Kutta step, where the next one begins.
    slope: Option<Vector<Dual<N>, M>>,
    /// Derivatives of the last switching time.
    late_s: [f64; N],
    /// Derivatives of v over the present step: coefficients of the powers of u.
    powers: [[f64; N]; MOST_POWERS],
}

/// The derivatives at a position in a step.
struct There<const N: usize, const M: usize> {
    state: Lanes<N, M>,
    /// Of the state's slope by time; only if it was asked for.
    slope: Lanes<N, M>,
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
            slope: None,
            late_s: [0.0; N],
            powers: [[0.0; N]; MOST_POWERS],
        }
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

    /// The derivatives at position `at` of a step; leaves those of v over the step in `powers`.
    /// The slope is computed only if `with_slope`.
    fn follow(&mut self, taken: &Taken<'_, M>, at: f64, with_slope: bool) -> There<N, M> {
        self.torque_powers.clear();
        let index = taken.span.index;
        let restricted =
            |(lane, cells): &(usize, Vec<Quintic<f64>>)| (*lane, taken.span.of(&cells[index]));
        self.torque_powers.extend(self.torque.by_lane.iter().map(restricted));
        match taken.step {
            Step::Ends(ends) => self.exact(taken, ends, with_slope),
            Step::Series(series) => self.series(taken, series, at, with_slope),
            Step::Stages(stages) => self.stages(taken, stages.length_s),
        }
    }

    /// The equations of the mode, with derivatives.
    fn linear_mode(&mut self, mode: Mode) -> usize {
        self.modes.iter().position(|known| known.mode == mode).unwrap_or_else(|| {
            self.modes.push(LinearMode::new(self.mechanics, mode));
            self.modes.len() - 1
        })
    }

    /// An exact step.
    fn exact(&mut self, taken: &Taken<'_, M>, ends: &Ends<M>, with_slope: bool) -> There<N, M> {
        let at = self.linear_mode(taken.mode);
        let mode = &mut self.modes[at];
        let (h, torque) = (ends.length_s, &self.torque_powers);
        let powers = taken.span.of(&taken.span.cell.powers);
        let state = match ends.repeats {
            true => mode.repeat(h, taken.start, &self.lanes, &powers, torque),
            false => mode.series(h, taken.start, &self.lanes, &powers, torque),
        };
        if !with_slope && self.sums.is_none() {
            return There { state, slope: [[0.0; N]; M] };
        }
        let lanes_of = |of: &dyn Fn(&Quintic<f64>) -> f64| {
            let mut lanes = [0.0; N];
            torque.iter().for_each(|(lane, powers)| lanes[*lane] = of(powers));
            lanes
        };
        let both = [&self.lanes, &state];
        let slopes: [Lanes<N, M>; 2] = std::array::from_fn(|end| {
            let of = |powers: &Quintic<f64>| polynomial(powers, end as f64);
            mode.slope(&ends.states[end], both[end], (of(&powers), &lanes_of(&of)))
        });
        if self.sums.is_some() {
            let curvatures: [[f64; N]; 2] = std::array::from_fn(|end| {
                let of = |powers: &Quintic<f64>| quintic_slope(powers, end as f64) / h;
                let moved =
                    mode.moved(&ends.slopes[end], &slopes[end], (of(&powers), &lanes_of(&of)));
                moved[VELOCITY]
            });
            for lane in 0..N {
                let end = |i: usize| {
                    [
                        both[i][VELOCITY][lane],
                        slopes[i][VELOCITY][lane] * h,
                        curvatures[i][lane] * (h * h),
                    ]
                };
                let quintic = through(end(0), end(1));
                for (power, coefficient) in self.powers.iter_mut().zip(quintic) {
                    power[lane] = coefficient;
                }
            }
        }
        There { state, slope: slopes[1] }
    }

    /// A step by Taylor series.
    fn series(
        &mut self,
        taken: &Taken<'_, M>,
        series: &Series<M>,
        at: f64,
        with_slope: bool,
    ) -> There<N, M> {
        let mode = self.linear_mode(taken.mode);
        let mode = &self.modes[mode];
        let powers = taken.span.of(&taken.span.cell.powers);
        let nonlinear = match taken.mode.motion {
            Motion::Stuck => &[],
            _ => taken.nonlinear,
        };
        let mut terms = [[[0.0; N]; M]; MOST_POWERS];
        terms[0] = self.lanes;
        for m in 0..series.order {
            let mut driving = powers.get(m).copied().unwrap_or(0.0);
            let mut lanes = [0.0; N];
            if !nonlinear.is_empty() {
                driving -= nonlinear.iter().map(|torque| torque.value[m]).sum::<f64>();
                let term =
                    |i: usize, state: usize| Dual::with_lanes(0.0, |lane| terms[i][state][lane]);
                let torque = self.mechanics.nonlinear_derivative(nonlinear, term, m);
                lanes = std::array::from_fn(|lane| -torque.lane(lane));
            }
            let drive = (driving, &lanes);
            terms[m + 1] = mode.next_term(
                m,
                &series.terms[m],
                &terms[m],
                drive,
                &self.torque_powers,
                series.length_s,
            );
        }
        for (power, term) in self.powers.iter_mut().zip(&terms[..=series.order]) {
            *power = term[VELOCITY];
        }
        // Horner's scheme.
        let (mut state, mut slope) = (terms[series.order], [[0.0; N]; M]);
        for term in terms[..series.order].iter().rev() {
            if with_slope {
                mix(&mut slope, at, &state);
            }
            mix(&mut state, at, term);
        }
        slope.iter_mut().flatten().for_each(|entry| *entry /= series.length_s);
        There { state, slope }
    }

    /// A Runge–Kutta step, by the same stages in dual numbers.
    fn stages(&mut self, taken: &Taken<'_, M>, length_s: f64) -> There<N, M> {
        let start = lifted(taken.start, &self.lanes);
        let Span { index, from, width, .. } = taken.span;
        let torque = |u: f64| self.torque_at((index, from + width * u));
        let slope =
            self.slope.unwrap_or_else(|| self.mechanics.slope(taken.mode, torque(0.0), &start));
        let stages = Stages::new(&start, &slope, length_s, |stage, state| {
            self.mechanics.slope(taken.mode, torque(NODES[stage]), state)
        });
        if self.sums.is_some() {
            for (lanes, power) in self.powers.iter_mut().zip(stages.powers(VELOCITY)) {
                *lanes = std::array::from_fn(|lane| power.lane(lane));
            }
        }
        self.slope = Some(stages.slopes[6]);
        There { state: lanes_of(&stages.end), slope: lanes_of(&stages.slopes[6]) }
    }

    /// Adds v over a step, up to position `reach`, to the Fourier integrals.
    fn add(&mut self, taken: &Taken<'_, M>, reach: f64) {
        let Some(sums) = &mut self.sums else { return };
        let values = taken.step.numbers(VELOCITY);
        let mut powers = [Dual::constant(0.0); MOST_POWERS];
        for ((power, value), lanes) in powers.iter_mut().zip(values.all()).zip(&self.powers) {
            *power = Dual::with_lanes(*value, |lane| lanes[lane]);
        }
        let powers = &powers[..values.all().len()];
        add_powers(sums, &taken.span, taken.step.length_s(), reach, powers);
    }
}

impl<const N: usize, const M: usize> Companion<M> for Sensitivity<'_, '_, N, M> {
    fn needs_interior(&self) -> bool {
        self.sums.is_some()
    }

    fn parameters_vary(&self) -> bool {
        N > M
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
        self.slope = None;
    }

    /// Moves the derivatives from the switching time, which has derivatives itself, to its plain
    /// value, so that all times of the motion are plain numbers. The Fourier integrals need no
    /// correction: v is continuous, so that they gain before the switch what they lose after it.
    fn switched(&mut self, event: Event, mode: Mode, place: (usize, f64), state: &Vector<f64, M>) {
        if event == Event::Stops {
            self.lanes[VELOCITY] = [0.0; N];
        }
        let state = state.map(Dual::constant);
        let slope = self.mechanics.slope(mode, self.torque_at(place), &state);
        for (lanes, slope) in self.lanes.iter_mut().zip(&slope) {
            let slope = slope.value();
            lanes.iter_mut().zip(&self.late_s).for_each(|(lane, late)| *lane -= late * slope);
        }
        self.slope = None;
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
        self.slope = None;
    }

    fn deflect_fully(&mut self, mode: Mode) {
        let mut lifted = lifted(&[0.0; M], &self.lanes);
        self.mechanics.deflect_fully(mode, &mut lifted);
        self.lanes = lanes_of(&lifted);
        self.slope = None;
    }
}

/// Replaces x by x·factor + more.
#[inline]
fn mix<const N: usize, const M: usize>(x: &mut Lanes<N, M>, factor: f64, more: &Lanes<N, M>) {
    for (row, more) in x.iter_mut().zip(more) {
        row.iter_mut().zip(more).for_each(|(x, more)| *x = *x * factor + more);
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
