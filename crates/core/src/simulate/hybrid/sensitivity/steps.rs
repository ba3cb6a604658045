//! The derivatives over one step, by the kind of the step.

use crate::plant::{Dual, Scalar as _};

use super::linear_mode::LinearMode;
use super::{Lanes, Sensitivity, lanes_of, lifted};
use crate::simulate::base::switching_times::Motion;
use crate::simulate::hybrid::companion::{Span, Taken};
use crate::simulate::hybrid::mechanics::{Mode, VELOCITY};
use crate::simulate::hybrid::runge_kutta::{NODES, Stages, Vector};
use crate::simulate::hybrid::series::{MOST_POWERS, Series};
use crate::simulate::hybrid::step::{Ends, Step};
use crate::simulate::signal::piecewise_quintic::{
    Quintic, polynomial, slope as quintic_slope, through,
};

/// The derivatives at a position in a step.
pub(super) struct There<const N: usize, const M: usize> {
    pub state: Lanes<N, M>,
    /// Of the state's slope by time; only if it was asked for.
    pub slope: Lanes<N, M>,
}

impl<const N: usize, const M: usize> Sensitivity<'_, '_, N, M> {
    /// The derivatives at position `at` of a step; leaves those of v over the step in `powers`.
    /// The slope is computed only if `with_slope`.
    pub(super) fn follow(
        &mut self,
        taken: &Taken<'_, M>,
        at: f64,
        with_slope: bool,
    ) -> There<N, M> {
        self.torque_powers.clear();
        let index = taken.span.index;
        let restricted =
            |(lane, cells): &(usize, Vec<Quintic<f64>>)| (*lane, taken.span.of(&cells[index]));
        self.torque_powers.extend(self.torque.by_lane.iter().map(restricted));
        match taken.step {
            Step::Ends(ends) => self.exact(taken, ends, with_slope),
            Step::Series(series) => self.series(taken, series, at, with_slope),
            Step::Stages(_) => self.stages(taken.mode),
        }
    }

    /// The equations of the mode, with derivatives.
    fn linear_mode(&mut self, mode: Mode) -> usize {
        self.modes.iter().position(|known| known.mode() == mode).unwrap_or_else(|| {
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
        let slope = |end: usize| {
            let of = |powers: &Quintic<f64>| polynomial(powers, end as f64);
            mode.slope(&ends.states[end], both[end], (of(&powers), &lanes_of(&of)))
        };
        let first = match self.exact_slope {
            Some((of, slope)) if of == taken.mode => slope,
            _ => slope(0),
        };
        let slopes = [first, slope(1)];
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
        self.exact_slope = Some((taken.mode, slopes[1]));
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

    /// The stages of a Runge–Kutta step in dual numbers.
    pub(super) fn lifted_stages(
        &self,
        mode: Mode,
        span: &Span<'_>,
        start: &Vector<f64, M>,
    ) -> Stages<Dual<N>, M> {
        let start = lifted(start, &self.lanes);
        let torque = |u: f64| self.torque_at((span.index, span.from + span.width * u));
        let slope = match self.slope {
            Some((of, slope)) if of == mode => slope,
            _ => self.mechanics.slope(mode, torque(0.0), &start),
        };
        Stages::new(&start, &slope, span.length_s(), |stage, state| {
            self.mechanics.slope(mode, torque(NODES[stage]), state)
        })
    }

    /// The Runge–Kutta step that was tried last.
    fn stages(&mut self, mode: Mode) -> There<N, M> {
        let Some(stages) = self.tried.take() else {
            return There { state: self.lanes, slope: [[0.0; N]; M] };
        };
        if self.sums.is_some() {
            for (lanes, power) in self.powers.iter_mut().zip(stages.powers(VELOCITY)) {
                *lanes = std::array::from_fn(|lane| power.lane(lane));
            }
        }
        self.slope = Some((mode, stages.slopes[6]));
        There { state: lanes_of(&stages.end), slope: lanes_of(&stages.slopes[6]) }
    }
}

/// Replaces x by x·factor + more.
#[inline]
fn mix<const N: usize, const M: usize>(x: &mut Lanes<N, M>, factor: f64, more: &Lanes<N, M>) {
    for (row, more) in x.iter_mut().zip(more) {
        row.iter_mut().zip(more).for_each(|(x, more)| *x = *x * factor + more);
    }
}
