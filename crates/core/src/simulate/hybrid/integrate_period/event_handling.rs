//! Event location: which switch comes first within a step, when, and the mode and state after it.

use super::PeriodIntegration;
use crate::simulate::base::switching_times::Motion;
use crate::simulate::hybrid::companion::{Crossing, Span, Taken};
use crate::simulate::hybrid::crossing::{departure, root};
use crate::simulate::hybrid::mechanics::{Contact, Event, Mode, VELOCITY};
use crate::simulate::hybrid::runge_kutta::Vector;
use crate::simulate::hybrid::step::{Powers, Step};
use crate::simulate::hybrid::step_control::StepControl;
use crate::simulate::signal::piecewise_quintic::Cell;

/// An event's signal counts as zero below this share of its size.
const RELATIVE_ROUNDING: f64 = 1e-13;

/// Positions within a step at which the signals of the events are checked for a change of sign.
const SIGN_CHECKS: [f64; 3] = [0.35, 0.7, 1.0];

/// The same for a step by Taylor series, which is so long that a contact may close and open in it.
const SIGN_CHECKS_IN_SERIES: [f64; 8] = [0.125, 0.25, 0.375, 0.5, 0.625, 0.75, 0.875, 1.0];

/// A switch within a step.
pub(super) struct Switch {
    /// Position in the step, 0 to 1.
    pub at: f64,
    pub event: Event,
}

impl<const M: usize> PeriodIntegration<'_, '_, M> {
    /// The first switch within a step.
    pub(super) fn switch(
        &self,
        mode: Mode,
        cell: &Cell<f64>,
        from: f64,
        width: f64,
        step: &Step<M>,
    ) -> Option<Switch> {
        let mut first: Option<Switch> = None;
        let mut consider = |event: Event| {
            let end = first.as_ref().map_or(1.0, |switch| switch.at);
            let at = match step {
                Step::Series(_) => {
                    let positions = SIGN_CHECKS_IN_SERIES.map(|position| position * end);
                    self.crossing(event, mode, step, (cell, from, width), positions)
                }
                _ => {
                    let positions = SIGN_CHECKS.map(|position| position * end);
                    self.crossing(event, mode, step, (cell, from, width), positions)
                }
            };
            if let Some(at) = at {
                first = Some(Switch { at, event });
            }
        };
        match mode.motion {
            Motion::Stuck => {
                consider(Event::Starts(0));
                consider(Event::Starts(1));
            }
            _ if step.stays_beyond(VELOCITY, 0.0) => {}
            _ => consider(Event::Stops),
        }
        let half = self.mechanics.half_gap().unwrap_or(0.0);
        let leaves = |level: f64| !step.stays_beyond(self.mechanics.twist, level);
        match mode.contact {
            Contact::Linked => {}
            Contact::Open => {
                if leaves(half) {
                    consider(Event::Touches(true));
                }
                if leaves(-half) {
                    consider(Event::Touches(false));
                }
            }
            Contact::Upper if leaves(half) => consider(Event::Leaves(true)),
            Contact::Lower if leaves(-half) => consider(Event::Leaves(false)),
            _ => {}
        }
        first
    }

    /// Where within a step an event happens first, up to the last of these positions.
    #[inline]
    fn crossing<const P: usize>(
        &self,
        event: Event,
        mode: Mode,
        step: &Step<M>,
        (cell, from, width): (&Cell<f64>, f64, f64),
        positions: [f64; P],
    ) -> Option<f64> {
        let rounding = self.rounding_size(event);
        if let Some((i, sign, level)) = self.state_of(event, mode) {
            let powers = step.numbers(i);
            let signals = powers.at_each(&positions).map(|value| sign * (value - level));
            return located(rounding, &positions, &signals, |u| sign * (powers.at(u) - level));
        }
        let powers: [Powers; M] = std::array::from_fn(|i| step.numbers(i));
        let signal = |u: f64| {
            let state: Vector<f64, M> = std::array::from_fn(|i| powers[i].at(u));
            self.mechanics.signal(event, mode, cell.number(from + width * u), &state)
        };
        located(rounding, &positions, &positions.map(signal), signal)
    }

    /// For an event that depends on one state alone: the index of the state, the direction in which
    /// it crosses its level, and the level. `None` for an event that depends on several states.
    fn state_of(&self, event: Event, mode: Mode) -> Option<(usize, f64, f64)> {
        let half = self.mechanics.half_gap().unwrap_or(0.0);
        let twist = self.mechanics.twist;
        match event {
            Event::Stops if mode.motion == Motion::Forward => Some((VELOCITY, -1.0, 0.0)),
            Event::Stops => Some((VELOCITY, 1.0, 0.0)),
            Event::Touches(true) => Some((twist, 1.0, half)),
            Event::Touches(false) => Some((twist, -1.0, -half)),
            Event::Leaves(true) => Some((twist, -1.0, half)),
            Event::Leaves(false) => Some((twist, 1.0, -half)),
            Event::Starts(_) => None,
        }
    }

    /// Size below which an event's signal is only rounding error.
    fn rounding_size(&self, event: Event) -> f64 {
        let sizes = &self.precision.sizes;
        RELATIVE_ROUNDING
            * match event {
                Event::Stops => sizes[VELOCITY],
                Event::Starts(_) => self.forcing.cells[0].number(0.0).abs(),
                Event::Touches(_) | Event::Leaves(_) => sizes[self.mechanics.twist],
            }
    }

    /// Repeats the step up to a switch. Returns the state there and the position in the cell. `None`
    /// if the repeated step is not accurate enough, as may happen near a stop, where a friction
    /// curve is steep; a shorter step must be tried.
    #[expect(clippy::too_many_arguments, reason = "what a step is made of")]
    pub(super) fn up_to(
        &mut self,
        pace: &mut StepControl<M>,
        mode: Mode,
        span: Span<'_>,
        state: &Vector<f64, M>,
        slope: &Vector<f64, M>,
        step: &Step<M>,
        switch: &Switch,
    ) -> Option<(Vector<f64, M>, f64)> {
        let (cell, from, width) = (span.cell, span.from, span.width);
        let part = width * switch.at;
        let cut;
        let (step, span, at, mut end, end_slope) = match step {
            Step::Series(series) => {
                let (end, end_slope) = series.at(switch.at);
                (step, span, switch.at, end, end_slope)
            }
            _ => {
                if let StepControl::Exact { reuse, .. } = pace {
                    *reuse = false;
                }
                let mut span = Span { width: part, ..span };
                cut = self.step(pace, mode, &mut span, state, slope);
                if pace.refuses(self.error(&cut, state), span.length_s()) {
                    return None;
                }
                (&cut, span, 1.0, *cut.end(), *cut.end_slope())
            }
        };
        let there = self.mechanics.signal(switch.event, mode, cell.fixed(from + part), &end);
        let rate_s = match self.state_of(switch.event, mode) {
            Some((i, sign, _)) => sign * end_slope[i],
            None => {
                // A signal of several states: central difference along the motion.
                let du = 1e-4 * width;
                let ahead = |du: f64| {
                    let by_s = du * cell.length_s;
                    let moved: Vector<f64, M> =
                        std::array::from_fn(|i| end[i] + end_slope[i] * by_s);
                    let torque = cell.fixed(from + part + du);
                    self.mechanics.signal(switch.event, mode, torque, &moved)
                };
                (ahead(du) - ahead(-du)) / (2.0 * du * cell.length_s)
            }
        };
        // One Newton step for the switching time. A correction of more than 1 % of the step is too
        // large to be an error of the step: then only its derivatives are used.
        let late_s = if rate_s == 0.0 { 0.0 } else { -there * (1.0 / rate_s) };
        let late_s = if late_s.abs() > 1e-2 * width * cell.length_s { 0.0 } else { late_s };
        let later = late_s / cell.length_s;
        let reach = if part > 0.0 { at * (1.0 + later / part) } else { 0.0 };
        if let Some(companion) = self.companion.as_deref_mut() {
            let taken = Taken { mode, span, start: state, step, nonlinear: pace.nonlinear() };
            let (event, state, slope) = (switch.event, &end, &end_slope);
            companion.step_to_switch(
                &taken,
                &Crossing { event, at, state, slope, rate_s, late_s, reach },
            );
        }
        for (value, slope) in end.iter_mut().zip(&end_slope) {
            *value += *slope * late_s;
        }
        let from_s = cell.from_s + from * cell.length_s;
        let powers = step.numbers(VELOCITY);
        if let Some(sums) = self.sums.as_deref_mut().filter(|_| part > 0.0) {
            sums.add_fixed(from_s, step.length_s(), reach, powers.all());
        }
        if let Some(trace) = self.trace.as_deref_mut() {
            trace.add(from_s, step.length_s(), powers.all(), reach);
        }
        Some((end, from + part + later))
    }

    /// The mode after a switch.
    pub(super) fn switched(
        &mut self,
        mode: Mode,
        event: Event,
        torque: f64,
        state: &mut Vector<f64, M>,
    ) -> Mode {
        let moving = [Motion::Forward, Motion::Backward];
        match event {
            Event::Stops => {
                state[VELOCITY] = 0.0;
                let motion = if self.mechanics.can_rest() {
                    self.mechanics.motion_at_rest(mode.contact, torque, state)
                } else {
                    self.swings += 1;
                    let held = self.swings > self.precision.most_swings
                        && self.mechanics.motion_if_stuck(mode.contact, torque, state)
                            == Motion::Stuck;
                    match mode.motion {
                        _ if held => Motion::Stuck,
                        Motion::Forward => Motion::Backward,
                        _ => Motion::Forward,
                    }
                };
                Mode { motion, yields: false, ..mode }
            }
            Event::Starts(direction) => Mode { motion: moving[direction], ..mode },
            Event::Touches(upper) => {
                let contact = if upper { Contact::Upper } else { Contact::Lower };
                self.after_contact_change(Mode { contact, ..mode }, torque, state)
            }
            Event::Leaves(_) => {
                self.after_contact_change(Mode { contact: Contact::Open, ..mode }, torque, state)
            }
        }
    }

    /// The mode after a contact has closed or opened: the torque of the joint jumps, which may
    /// start an axis at rest.
    fn after_contact_change(&self, mode: Mode, torque: f64, state: &Vector<f64, M>) -> Mode {
        match mode.motion {
            Motion::Stuck => {
                let motion = self.mechanics.motion_if_stuck(mode.contact, torque, state);
                Mode { motion, ..mode }
            }
            _ => mode,
        }
    }
}

/// Where a signal first becomes positive, given its values at some positions, the last of which ends
/// the search. `rounding`: what counts as zero.
#[inline]
fn located(
    rounding: f64,
    positions: &[f64],
    signals: &[f64],
    signal: impl Fn(f64) -> f64,
) -> Option<f64> {
    // If this event ended the last step, its signal is zero here and moves away from zero. At first
    // it is no larger than the polynomial's error: only the last position tells.
    let starts_at_zero = signal(0.0).abs() <= rounding;
    if starts_at_zero {
        let (end, there) = (*positions.last()?, *signals.last()?);
        return (there > rounding).then(|| root(departure(&signal, end), end, signal));
    }
    let after = signals.iter().position(|there| *there > 0.0)?;
    let low = if after == 0 { 0.0 } else { positions[after - 1] };
    Some(root(low, positions[after], signal))
}
