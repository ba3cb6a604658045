//! Event location: which switch comes first within a step, when, and the mode and state after it.

use crate::plant::Scalar;

use super::PeriodIntegration;
use crate::simulate::base::switching_times::Motion;
use crate::simulate::hybrid::crossing::{departure, root};
use crate::simulate::hybrid::mechanics::{Contact, Mode, VELOCITY};
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

/// Kinds of switches.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Event {
    /// v reaches zero.
    Stops,
    /// Breakaway, forward (0) or backward (1).
    Starts(usize),
    /// The twist φ reaches the upper (true) or lower end of the gap.
    Touches(bool),
    /// The contact at that end opens.
    Leaves(bool),
}

impl<S: Scalar, const M: usize> PeriodIntegration<'_, '_, S, M> {
    /// The first switch within a step.
    pub(super) fn switch(
        &self,
        mode: Mode,
        cell: &Cell<S>,
        from: f64,
        width: f64,
        step: &Step<S, M>,
    ) -> Option<Switch> {
        let positions: &[f64] = match step {
            Step::Series(_) => &SIGN_CHECKS_IN_SERIES,
            _ => &SIGN_CHECKS,
        };
        let mut first: Option<Switch> = None;
        let mut consider = |event: Event| {
            let one = self.state_of(event, mode);
            let needed: [Powers; M] = std::array::from_fn(|i| match one {
                Some((only, _, _)) if only != i => Powers::NONE,
                _ => step.numbers(i),
            });
            let signal = |u: f64| match one {
                Some((i, sign, level)) => sign * (needed[i].at(u) - level),
                None => {
                    let state = std::array::from_fn(|i| S::constant(needed[i].at(u)));
                    let torque = S::constant(cell.number(from + width * u));
                    self.signal(event, mode, torque, &state).value()
                }
            };
            let rounding_size = self.rounding_size(event);
            // If this event ended the last step, its signal is zero here and moves away from zero.
            let starts_at_zero = signal(0.0).abs() <= rounding_size;
            let threshold = if starts_at_zero { rounding_size } else { 0.0 };
            let end = first.as_ref().map_or(1.0, |switch| switch.at);
            let mut low = 0.0;
            for position in positions.iter().map(|position| position * end) {
                // At first such a signal is no larger than the polynomial's error.
                if starts_at_zero && position < end {
                    continue;
                }
                if signal(position) > threshold {
                    if starts_at_zero && low == 0.0 {
                        low = departure(&signal, position);
                    }
                    first = Some(Switch { at: root(low, position, signal), event });
                    return;
                }
                low = position;
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

    /// The signal of an event: it becomes positive when the event happens.
    fn signal(&self, event: Event, mode: Mode, torque: S, state: &Vector<S, M>) -> S {
        match event {
            Event::Stops if mode.motion == Motion::Forward => -state[VELOCITY],
            Event::Stops => state[VELOCITY],
            Event::Starts(direction) => {
                self.mechanics.excess(mode.contact, torque, state)[direction]
            }
            Event::Touches(upper) => -self.mechanics.clearance(upper, state),
            Event::Leaves(upper) => self.mechanics.clearance(upper, state),
        }
    }

    /// Repeats the step up to a switch. Returns the state there, the position in the cell, and a
    /// dual number of value 0 whose derivatives are those of the switching time. `None` if the
    /// repeated step is not accurate enough, as may happen near a stop, where a friction curve is
    /// steep; a shorter step must be tried.
    #[expect(clippy::too_many_arguments, reason = "what a step is made of")]
    pub(super) fn up_to(
        &mut self,
        pace: &mut StepControl<S, M>,
        mode: Mode,
        cell: &Cell<S>,
        (from, width): (f64, f64),
        state: &Vector<S, M>,
        slope: &Vector<S, M>,
        step: &Step<S, M>,
        switch: &Switch,
    ) -> Option<(Vector<S, M>, f64, S)> {
        let mut part = width * switch.at;
        let cut;
        let (step, mut reach, mut end, end_slope) = match step {
            Step::Series(series) => {
                let (end, end_slope) = series.at(switch.at);
                (step, switch.at, end, end_slope)
            }
            _ => {
                if let StepControl::Exact { reuse, .. } = pace {
                    *reuse = false;
                }
                cut = self.step(pace, mode, cell, (from, &mut part), state, slope);
                if pace.refuses(self.error(&cut, state), part * cell.length_s) {
                    return None;
                }
                (&cut, 1.0, *cut.end(), *cut.end_slope())
            }
        };
        let there = self.signal(switch.event, mode, cell.fixed(from + part), &end);
        let rate_s = match self.state_of(switch.event, mode) {
            Some((i, sign, _)) => sign * end_slope[i].value(),
            None => {
                // A signal of several states: central difference along the motion.
                let du = 1e-4 * width;
                let ahead = |du: f64| {
                    let by_s = du * cell.length_s;
                    let moved = std::array::from_fn(|i| end[i] + end_slope[i] * by_s);
                    let torque = cell.fixed(from + part + du);
                    self.signal(switch.event, mode, torque, &moved).value()
                };
                (ahead(du) - ahead(-du)) / (2.0 * du * cell.length_s)
            }
        };
        let late_s = if rate_s != 0.0 { -there * (1.0 / rate_s) } else { S::constant(0.0) };
        // One Newton step for the switching time. A correction of more than 1 % of the step is too
        // large to be an error of the step: then only its derivatives are used.
        let most_s = 1e-2 * width * cell.length_s;
        let late_s = if late_s.value().abs() > most_s { late_s - late_s.value() } else { late_s };
        for (value, slope) in end.iter_mut().zip(&end_slope) {
            *value += *slope * late_s;
        }
        let later = late_s.value() / cell.length_s;
        let traced = if part > 0.0 { reach * (1.0 + later / part) } else { 0.0 };
        if let Some(sums) = self.sums.as_deref_mut().filter(|_| part > 0.0) {
            reach *= 1.0 + later / part;
            step.add(VELOCITY, sums, cell.from_s + from * cell.length_s, reach);
        }
        if let Some(trace) = self.trace.as_deref_mut() {
            let from_s = cell.from_s + from * cell.length_s;
            trace.add(from_s, step.length_s(), step.numbers(VELOCITY).all(), traced);
        }
        Some((end, from + part + later, late_s - late_s.value()))
    }

    /// Moves the state after a switch from the switching time as a dual number to its plain value,
    /// so that all times of a pass are plain numbers. The Fourier integrals need no correction: v
    /// is continuous, so that they gain before the switch what they lose after it.
    pub(super) fn to_plain_time(&self, mode: Mode, torque: S, state: &mut Vector<S, M>, late_s: S) {
        if S::LANES == 0 {
            return;
        }
        let slope = self.mechanics.slope(mode, torque, state);
        for (value, slope) in state.iter_mut().zip(&slope) {
            *value -= late_s * slope.value();
        }
    }

    /// The mode after a switch.
    pub(super) fn switched(
        &mut self,
        mode: Mode,
        event: Event,
        torque: S,
        state: &mut Vector<S, M>,
    ) -> Mode {
        let moving = [Motion::Forward, Motion::Backward];
        match event {
            Event::Stops => {
                state[VELOCITY] = S::constant(0.0);
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
    fn after_contact_change(&self, mode: Mode, torque: S, state: &Vector<S, M>) -> Mode {
        match mode.motion {
            Motion::Stuck => {
                let motion = self.mechanics.motion_if_stuck(mode.contact, torque, state);
                Mode { motion, ..mode }
            }
            _ => mode,
        }
    }
}
