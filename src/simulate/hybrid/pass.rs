//! One period of motion, step by step, through its switches.

use crate::plant::Scalar;

use super::super::fourier::Fourier;
use super::super::orbit::Motion;
use super::super::wave::{Cell, Quintic, Wave, restricted, slope as wave_slope, value};
use super::affine::{Affine, REACH};
use super::crossing::{departure, root};
use super::mechanics::{Contact, Mechanics, Mode, VELOCITY};
use super::pace::Pace;
use super::runge_kutta::{NODES, Stages, Vector};
use super::step::Step;

/// Switches of one cell beyond which time has stopped passing.
const MOST_SWITCHES_PER_CELL: usize = 1024;

/// Steps of one cell beyond which the equations are too stiff to follow.
const MOST_STEPS_PER_CELL: usize = 20_000;

/// Share of a state's size below which it is as good as zero.
const ROUNDING: f64 = 1e-13;

/// Positions within a step at which switches are looked for.
const LOOKS: [f64; 3] = [0.35, 0.7, 1.0];

/// How precisely a pass follows the motion.
pub(super) struct Precision<const M: usize> {
    /// Largest error of a step, as a share of the states' sizes.
    pub tolerance: f64,
    /// Sizes of the states.
    pub sizes: [f64; M],
}

/// Share of a cell too short for a step of its own.
const SLIVER: f64 = 1e-9;

/// A motion under way.
pub(super) struct Pass<'a, 'g, S, const M: usize> {
    pub mechanics: &'a Mechanics<S>,
    pub wave: &'a Wave<S>,
    pub precision: &'a Precision<M>,
    /// Where v is added up, if at all.
    pub sums: Option<&'a mut Fourier<'g, S>>,
    /// Largest |state| seen.
    pub largest: [f64; M],
}

/// A switch within a step.
struct Switch {
    /// Where in the step, 0 to 1.
    at: f64,
    event: Event,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Event {
    /// v reaches zero.
    Stops,
    /// Breakaway, forward or backward.
    Starts(usize),
    /// φ passes the upper (true) or lower end of the gap.
    Touches(bool),
    /// It leaves that end.
    Leaves(bool),
}

impl<S: Scalar, const M: usize> Pass<'_, '_, S, M> {
    /// Follows the motion from `start` over one period; `None` where it
    /// switches without end or is too stiff to follow.
    pub fn run(&mut self, start: &Vector<S, M>) -> Option<Vector<S, M>> {
        let zero = S::constant(0.0);
        let mut state = *start;
        let wave = self.wave;
        let mut mode = self.mechanics.mode_at(wave.cells[0].at(zero), &state);
        let mut slope: Option<Vector<S, M>> = None;
        let mut pace = match self.mechanics.affine_rate() {
            Some(rate) => Pace::Exact { longest_s: REACH / rate, steps: Vec::new(), again: false },
            None => Pace::Controlled { length_s: wave.cells[0].length_s },
        };
        for cell in &wave.cells {
            let mut from = zero;
            let (mut switches, mut steps) = (0, 0);
            while from.value() < 1.0 {
                steps += 1;
                if steps > MOST_STEPS_PER_CELL || switches > MOST_SWITCHES_PER_CELL {
                    return None;
                }
                if mode.motion == Motion::Stuck {
                    let now = self.mechanics.motion_at_rest(mode.contact, cell.at(from), &state);
                    if now != Motion::Stuck {
                        (mode.motion, slope) = (now, None);
                        switches += 1;
                    }
                }
                let begin =
                    *slope.get_or_insert_with(|| self.mechanics.slope(mode, cell.at(from), &state));
                let width = pace.width(cell, from);
                let (step, error) = self.step(&mut pace, mode, cell, (from, width), &state, &begin);
                if error.is_nan() {
                    return None;
                }
                if !pace.accepts(error, width.value() * cell.length_s, cell.length_s) {
                    continue;
                }
                match self.switch(mode, cell, from.value(), width.value(), &step) {
                    None => {
                        self.add(cell, from, width, &step);
                        state = step.end;
                        slope = Some(*step.end_slope());
                        let ends = from.value() + width.value() >= 1.0 - SLIVER;
                        from = if ends { S::constant(1.0) } else { from + width };
                    }
                    Some(switch) => {
                        switches += 1;
                        let span = (from, width * switch.at);
                        (state, from) =
                            self.up_to(&mut pace, mode, cell, span, &state, &begin, &switch);
                        mode = self.switched(mode, switch.event, cell.at(from), &mut state);
                        slope = None;
                    }
                }
                self.note(&state);
            }
        }
        Some(state)
    }

    fn note(&mut self, state: &Vector<S, M>) {
        for (largest, value) in self.largest.iter_mut().zip(state) {
            *largest = largest.max(value.value().abs());
        }
    }

    /// A step over part of a cell, and its error in errors allowed.
    #[inline]
    fn step(
        &self,
        pace: &mut Pace<S, M>,
        mode: Mode,
        cell: &Cell<S>,
        (from, width): (S, S),
        state: &Vector<S, M>,
        slope: &Vector<S, M>,
    ) -> (Step<S, M>, f64) {
        let length_s = width * cell.length_s;
        let Pace::Exact { steps, again, .. } = pace else {
            let stages = Stages::new(state, slope, length_s, |stage, state| {
                self.mechanics.slope(mode, cell.at(from + width * NODES[stage]), state)
            });
            let mut sizes = self.precision.sizes;
            let v = state[VELOCITY].value();
            sizes[VELOCITY] = self.mechanics.velocity_size(v, sizes[VELOCITY]);
            let error = stages.error(&sizes) / self.precision.tolerance;
            return (Step::of_stages(state, slope, length_s, stages), error);
        };
        let at = steps.iter().position(|affine| affine.mode == mode).unwrap_or_else(|| {
            steps.push(Affine::new(self.mechanics, mode));
            steps.len() - 1
        });
        let affine = &mut steps[at];
        let whole = width == S::constant(1.0);
        let powers = if whole { cell.powers } else { restricted(&cell.powers, from, from + width) };
        let end = affine.step(state, &powers, length_s, cell.whole.is_some() && *again);
        let one = S::constant(1.0);
        let end_slope = affine.slope(&end, value(&powers, one));
        let mut step = Step::of_ends([*state, end], [*slope, end_slope], length_s);
        if self.sums.is_some() || !step.stays_beyond(VELOCITY, 0.0) {
            let rate = S::constant(1.0) / length_s;
            step.bend([
                affine.curvature(slope, powers[1] * rate),
                affine.curvature(&end_slope, wave_slope(&powers, one) * rate),
            ]);
        }
        (step, 0.0)
    }

    fn add(&mut self, cell: &Cell<S>, from: S, width: S, step: &Step<S, M>) {
        if self.sums.is_none() {
            return;
        }
        let powers = step.powers(VELOCITY);
        match (cell.whole, self.sums.as_deref_mut()) {
            (Some(n), Some(sums)) if from == S::constant(0.0) && width == S::constant(1.0) => {
                sums.add_whole(n, powers);
            }
            _ => self.add_part(cell, from, width, &powers),
        }
    }

    fn add_part(&mut self, cell: &Cell<S>, from: S, width: S, powers: &Quintic<S>) {
        if let Some(sums) = self.sums.as_deref_mut() {
            let from_s = from * cell.length_s + cell.from_s;
            sums.add_part(from_s, width * cell.length_s, powers);
        }
    }

    /// The first switch within a step.
    fn switch(
        &self,
        mode: Mode,
        cell: &Cell<S>,
        from: f64,
        width: f64,
        step: &Step<S, M>,
    ) -> Option<Switch> {
        let mut first: Option<Switch> = None;
        let mut consider = |event: Event| {
            let one = self.state_of(event, mode);
            let needed: [Quintic<f64>; M] = std::array::from_fn(|i| match one {
                Some((only, _, _)) if only != i => [0.0; 6],
                _ => step.powers(i).map(S::value),
            });
            let signal = |u: f64| match one {
                Some((i, sign, level)) => sign * (value(&needed[i], u) - level),
                None => {
                    let state = std::array::from_fn(|i| S::constant(value(&needed[i], u)));
                    let torque = S::constant(cell.number(from + width * u));
                    self.signal(event, mode, torque, &state).value()
                }
            };
            let least = self.least(event);
            // What has just switched stands at zero and moves away from it.
            let fresh = signal(0.0).abs() <= least;
            let threshold = if fresh { least } else { 0.0 };
            let end = first.as_ref().map_or(1.0, |switch| switch.at);
            let mut low = 0.0;
            for look in LOOKS.map(|look| look * end) {
                // Its first instants are as small as what the polynomial errs by.
                if fresh && look < end {
                    continue;
                }
                if signal(look) > threshold {
                    if fresh && low == 0.0 {
                        low = departure(&signal, look);
                    }
                    first = Some(Switch { at: root(low, look, signal), event });
                    return;
                }
                low = look;
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

    /// The state that alone decides on an event, the direction in which it passes
    /// its level, and the level; `None` where several decide.
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

    /// Size below which an event's signal is rounding.
    fn least(&self, event: Event) -> f64 {
        let sizes = &self.precision.sizes;
        ROUNDING
            * match event {
                Event::Stops => sizes[VELOCITY],
                Event::Starts(_) => self.wave.cells[0].number(0.0).abs(),
                Event::Touches(_) | Event::Leaves(_) => sizes[self.mechanics.twist],
            }
    }

    /// What turns positive at an event.
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

    /// State and position at a switch; with its derivatives, by one step of
    /// Newton's method.
    #[expect(clippy::too_many_arguments, reason = "what a step is made of")]
    fn up_to(
        &mut self,
        pace: &mut Pace<S, M>,
        mode: Mode,
        cell: &Cell<S>,
        (from, part): (S, S),
        state: &Vector<S, M>,
        slope: &Vector<S, M>,
        switch: &Switch,
    ) -> (Vector<S, M>, S) {
        if let Pace::Exact { again, .. } = pace {
            *again = false;
        }
        let (step, _) = self.step(pace, mode, cell, (from, part), state, slope);
        let to = from + part;
        let there = self.signal(switch.event, mode, cell.at(to), &step.end);
        let du = 1e-4 * part.value() / switch.at.max(1e-9);
        let rate = match self.state_of(switch.event, mode) {
            Some((i, sign, _)) => sign * step.end_slope()[i].value() * cell.length_s,
            None => {
                // Of several states: central differences along the motion.
                let ahead = |du: f64| {
                    let moved: Vector<S, M> = std::array::from_fn(|i| {
                        step.end[i] + step.end_slope()[i] * (du * cell.length_s)
                    });
                    self.signal(switch.event, mode, cell.at(to + du), &moved).value()
                };
                (ahead(du) - ahead(-du)) / (2.0 * du)
            }
        };
        let correction = if rate != 0.0 { -there * (1.0 / rate) } else { S::constant(0.0) };
        // Further than a step's own error it would be no correction.
        let correction = if correction.value().abs() > 100.0 * du {
            correction - correction.value()
        } else {
            correction
        };
        let mut end = step.end;
        for (value, slope) in end.iter_mut().zip(step.end_slope()) {
            *value += *slope * correction * cell.length_s;
        }
        // The motion goes on as it was; what moves is where the step ends.
        let reach = correction / part + 1.0;
        let powers = restricted(&step.powers(VELOCITY), S::constant(0.0), reach);
        self.add_part(cell, from, part + correction, &powers);
        (end, to + correction)
    }

    /// The mode behind a switch.
    fn switched(&self, mode: Mode, event: Event, torque: S, state: &mut Vector<S, M>) -> Mode {
        let moving = [Motion::Forward, Motion::Backward];
        match event {
            Event::Stops => {
                state[VELOCITY] = S::constant(0.0);
                let motion = if self.mechanics.can_rest() {
                    self.mechanics.motion_at_rest(mode.contact, torque, state)
                } else if mode.motion == Motion::Forward {
                    Motion::Backward
                } else {
                    Motion::Forward
                };
                Mode { motion, ..mode }
            }
            Event::Starts(direction) => Mode { motion: moving[direction], ..mode },
            Event::Touches(upper) => {
                let contact = if upper { Contact::Upper } else { Contact::Lower };
                self.held_again(Mode { contact, ..mode }, torque, state)
            }
            Event::Leaves(_) => {
                self.held_again(Mode { contact: Contact::Open, ..mode }, torque, state)
            }
        }
    }

    /// A jump of the joint's torque may free an axis at rest.
    fn held_again(&self, mode: Mode, torque: S, state: &Vector<S, M>) -> Mode {
        match mode.motion {
            Motion::Stuck => {
                let motion = self.mechanics.motion_at_rest(mode.contact, torque, state);
                Mode { motion, ..mode }
            }
            _ => mode,
        }
    }
}
