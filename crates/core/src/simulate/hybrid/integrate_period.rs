//! Integrates the motion over one period, or over one transient, step by step and through every
//! switch, and sums the Fourier integrals of v on the way. [`Companion`] is told every step and
//! switch, to carry derivatives along.

mod event_handling;

use super::companion::{Companion, Span, Taken, add_powers};
use super::mechanics::{Event, Mechanics, Mode, VELOCITY};
use super::runge_kutta::{NODES, Stages, Vector};
use super::step::{Ends, Step};
use super::step_control::StepControl;
use crate::simulate::base::switching_times::Motion;
use crate::simulate::signal::fourier::Fourier;
use crate::simulate::signal::piecewise_quintic::{
    PiecewiseQuintic, polynomial, slope as wave_slope,
};
use crate::simulate::transient::recorder::Recorder;

/// Most switches in one cell; more mean that the switching times accumulate (Zeno behaviour).
const MOST_SWITCHES_PER_CELL: usize = 1024;

/// Effort of locating a switch, as a number of exact steps; subtracted from the remaining effort.
const SWITCH_EFFORT: usize = 12;

/// A bristle counts as fully deflected if its force differs from the Coulomb level by less than
/// this multiple of the step tolerance (relative). The integration does not come closer than that.
const YIELD_TOLERANCE_FACTOR: f64 = 4.0;

/// Largest error of a step, as a share of the states' sizes, while the periodic motion is searched
/// for. Tuned.
pub(super) const LOOSE_TOLERANCE: f64 = 2e-4;

/// The same for the motion that is reported. Tuned.
pub(super) const TIGHT_TOLERANCE: f64 = 1e-6;

/// How precisely a period is integrated.
pub(super) struct Precision<const M: usize> {
    /// Largest error of a step, as a share of the states' sizes.
    pub tolerance: f64,
    /// Sizes of the states.
    pub sizes: [f64; M],
    /// Most oscillations of an axis on its presliding bristles that are integrated; later ones are
    /// left out. After n oscillations about 3/n of the amplitude remains, and its effect averages
    /// out.
    pub most_swings: usize,
}

/// A remainder of a cell shorter than this share of the cell is skipped: it is rounding.
const SHORTEST_REMAINDER: f64 = 1e-9;

/// The integration of a motion over one period, or over a transient.
pub(super) struct PeriodIntegration<'a, 'g, const M: usize> {
    pub mechanics: &'a Mechanics<f64>,
    pub forcing: &'a PiecewiseQuintic<f64>,
    pub precision: &'a Precision<M>,
    /// Sums of the Fourier integrals of v, if wanted.
    pub sums: Option<&'a mut Fourier<'g, f64>>,
    /// Carries derivatives along, if wanted.
    pub companion: Option<&'a mut dyn Companion<M>>,
    /// Receives every step of v (transients only). The torque may then jump between cells.
    pub trace: Option<&'a mut Recorder>,
    /// Largest absolute value of each state so far.
    pub largest: [f64; M],
    /// Oscillations on the presliding bristles so far.
    pub swings: usize,
    /// Remaining effort, in exact steps.
    pub effort: &'a mut usize,
}
impl<const M: usize> PeriodIntegration<'_, '_, M> {
    /// Integrates the motion from `start` over all cells and returns the final state; `None` if the
    /// switching times accumulate or the effort is used up.
    pub fn run(&mut self, start: &Vector<f64, M>) -> Option<Vector<f64, M>> {
        let mut state = *start;
        let forcing = self.forcing;
        let mut mode = self.mechanics.mode_at(forcing.cells[0].fixed(0.0), &state);
        let mut slope: Option<Vector<f64, M>> = None;
        let parameters_vary = self.companion.as_ref().is_some_and(|it| it.parameters_vary());
        let mut pace = StepControl::new(self.mechanics, forcing.cells[0].length_s, parameters_vary);
        for (index, cell) in forcing.cells.iter().enumerate() {
            let mut from = 0.0;
            let mut switches = 0;
            if self.trace.is_some() {
                slope = None;
            }
            while from < 1.0 {
                *self.effort = self.effort.checked_sub(pace.effort())?;
                if switches > MOST_SWITCHES_PER_CELL {
                    return None;
                }
                if mode.motion == Motion::Stuck {
                    let now =
                        self.mechanics.motion_if_stuck(mode.contact, cell.fixed(from), &state);
                    if now != Motion::Stuck {
                        (mode.motion, slope) = (now, None);
                        self.leave_rest_on_bristles(mode, (index, from), &mut state);
                        switches += 1;
                    }
                }
                if self.mechanics.yields(
                    mode,
                    &state,
                    YIELD_TOLERANCE_FACTOR * self.precision.tolerance,
                ) {
                    mode.yields = true;
                    self.mechanics.deflect_fully(mode, &mut state);
                    if let Some(companion) = self.companion.as_deref_mut() {
                        companion.deflect_fully(mode);
                    }
                    (slope, self.swings) = (None, 0);
                }
                let begin = slope
                    .get_or_insert_with(|| self.mechanics.slope(mode, cell.fixed(from), &state));
                let mut span = Span { index, cell, from, width: pace.width(cell, from) };
                let step = self.step(&mut pace, mode, &mut span, &state, begin);
                let width = span.width;
                let error = self.error(&step, &state);
                if error.is_nan() {
                    return None;
                }
                if !pace.accepts(error, width * cell.length_s, cell.length_s) {
                    continue;
                }
                match self.switch(mode, cell, from, width, &step) {
                    None => {
                        self.add(&span, &step);
                        if let Some(companion) = self.companion.as_deref_mut() {
                            let (start, nonlinear) = (&state, pace.nonlinear());
                            companion.step(&Taken { mode, span, start, step: &step, nonlinear });
                        }
                        state = *step.end();
                        slope = Some(*step.end_slope());
                        let ends = from + width >= 1.0 - SHORTEST_REMAINDER;
                        from = if ends { 1.0 } else { from + width };
                    }
                    Some(switch) => {
                        *self.effort = self.effort.saturating_sub(SWITCH_EFFORT);
                        let Some(there) =
                            self.up_to(&mut pace, mode, span, &state, begin, &step, &switch)
                        else {
                            continue;
                        };
                        (state, from) = there;
                        switches += 1;
                        mode = self.switched(mode, switch.event, cell.fixed(from), &mut state);
                        if matches!(switch.event, Event::Starts(_)) {
                            self.leave_rest_on_bristles(mode, (index, from), &mut state);
                        }
                        if let Some(companion) = self.companion.as_deref_mut() {
                            let slope = self.mechanics.slope(mode, cell.fixed(from), &state);
                            companion.switched(switch.event, &slope);
                        }
                        slope = None;
                    }
                }
                self.update_largest(&state);
            }
        }
        Some(state)
    }

    /// Starts an axis from rest on its bristles, with a new count of oscillations.
    fn leave_rest_on_bristles(
        &mut self,
        mode: Mode,
        (index, at): (usize, f64),
        state: &mut Vector<f64, M>,
    ) {
        self.swings = 0;
        if self.mechanics.can_rest() {
            return;
        }
        if let Some(companion) = self.companion.as_deref_mut() {
            companion.leave_rest_on_bristles(mode, (index, at), state);
        }
        let cell = &self.forcing.cells[index];
        let rate = cell.slope(at) * (1.0 / cell.length_s);
        self.mechanics.leave_rest_on_bristles(mode, cell.fixed(at), rate, state);
    }

    /// Updates the largest absolute values.
    fn update_largest(&mut self, state: &Vector<f64, M>) {
        for (largest, value) in self.largest.iter_mut().zip(state) {
            *largest = largest.max(value.abs());
        }
    }

    /// A step over at most `span`, which becomes the part that it covers.
    #[inline]
    fn step(
        &mut self,
        pace: &mut StepControl<M>,
        mode: Mode,
        span: &mut Span<'_>,
        state: &Vector<f64, M>,
        slope: &Vector<f64, M>,
    ) -> Step<M> {
        match (&pace, self.companion.as_deref_mut()) {
            (StepControl::Controlled { .. }, Some(companion)) => {
                Step::Stages(companion.try_stages(mode, span, state))
            }
            _ => self.plain_step(pace, mode, span, state, slope),
        }
    }

    /// The same without derivatives.
    #[inline]
    fn plain_step(
        &self,
        pace: &mut StepControl<M>,
        mode: Mode,
        span: &mut Span<'_>,
        state: &Vector<f64, M>,
        slope: &Vector<f64, M>,
    ) -> Step<M> {
        let (cell, length_s) = (span.cell, span.length_s());
        match pace {
            StepControl::Controlled { .. } => {
                Step::Stages(Stages::new(state, slope, length_s, |stage, state| {
                    let torque = cell.fixed(span.from + span.width * NODES[stage]);
                    self.mechanics.slope(mode, torque, state)
                }))
            }
            StepControl::Series { modes, nonlinear } => {
                let allowed = self.precision.sizes.map(|size| size * self.precision.tolerance);
                let affine = modes.of(mode, self.mechanics);
                let is_nonlinear = mode.motion != Motion::Stuck && !nonlinear.is_empty();
                let torques = is_nonlinear
                    .then_some(|terms: &[_]| self.mechanics.nonlinear_term(mode, nonlinear, terms));
                let series =
                    affine.reach(state, &span.of(&cell.powers), length_s, &allowed, torques);
                if series.share < 1.0 {
                    nonlinear.iter_mut().for_each(|torque| torque.slow_down(series.share));
                }
                span.width *= series.share;
                Step::Series(series)
            }
            StepControl::Exact { modes, reuse, .. } => {
                let (affine, powers) = (modes.of(mode, self.mechanics), span.of(&cell.powers));
                let end = affine.step(state, &powers, length_s, *reuse);
                let end_slope = affine.slope(&end, polynomial(&powers, 1.0));
                let (states, slopes) = ([*state, end], [*slope, end_slope]);
                let repeats = *reuse;
                let mut ends = Ends { length_s, states, slopes, curvatures: None, repeats };
                if self.needs_interior() || !ends.stays_beyond(VELOCITY, 0.0) {
                    let rate = 1.0 / length_s;
                    let last = wave_slope(&powers, 1.0);
                    ends.curvatures = Some([
                        affine.curvature(slope, powers[1] * rate),
                        affine.curvature(&end_slope, last * rate),
                    ]);
                }
                Step::Ends(ends)
            }
        }
    }

    /// A step's error as a multiple of the allowed error. For a step without error control it is 0,
    /// or NaN if the state is not finite.
    fn error(&self, step: &Step<M>, state: &Vector<f64, M>) -> f64 {
        let Step::Stages(stages) = step else { return step.end()[VELOCITY] * 0.0 };
        let mut sizes = self.precision.sizes;
        let v = state[VELOCITY];
        sizes[VELOCITY] = self.mechanics.velocity_size(v, sizes[VELOCITY]);
        stages.error(&sizes) / self.precision.tolerance
    }

    /// Whether v is needed within a step, not only at its ends.
    fn needs_interior(&self) -> bool {
        self.sums.is_some()
            || self.trace.is_some()
            || self.companion.as_ref().is_some_and(|companion| companion.needs_interior())
    }

    /// Passes a step of v on to the recorder and to the Fourier integrals.
    fn add(&mut self, span: &Span<'_>, step: &Step<M>) {
        if let Some(trace) = self.trace.as_deref_mut() {
            let length_s = span.width * span.cell.length_s;
            trace.add(span.start_s(), length_s, step.numbers(VELOCITY).all(), 1.0);
        }
        if let Some(sums) = self.sums.as_deref_mut() {
            let powers = step.numbers(VELOCITY);
            add_powers(sums, span, step.length_s(), 1.0, powers.all());
        }
    }
}
