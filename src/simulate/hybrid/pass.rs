//! One period of motion, step by step, through its switches.

use crate::plant::Scalar;

use super::super::fourier::Fourier;
use super::super::orbit::Motion;
use super::super::transient::Recorder;
use super::super::wave::{Cell, Wave, polynomial, restricted, slope as wave_slope};
use super::crossing::{departure, root};
use super::mechanics::{Contact, Mechanics, Mode, VELOCITY};
use super::pace::Pace;
use super::runge_kutta::{NODES, Stages, Vector};
use super::step::{Ends, Powers, Step};

/// Switches of one cell beyond which time has stopped passing.
const MOST_SWITCHES_PER_CELL: usize = 1024;

/// What it takes to find a switch, in exact steps.
const SWITCH_EFFORT: usize = 12;

/// Share of a state's size below which it is as good as zero.
const ROUNDING: f64 = 1e-13;

/// Positions within a step at which switches are looked for.
const LOOKS: [f64; 3] = [0.35, 0.7, 1.0];

/// The same in a step by series, over which contact may come and go.
const LOOKS_IN_SERIES: [f64; 8] = [0.125, 0.25, 0.375, 0.5, 0.625, 0.75, 0.875, 1.0];

/// Errors of a step that a bristle may lack to being bent as far as it goes: a step's
/// own error keeps it from less.
const YIELDING: f64 = 4.0;

/// How precisely a pass follows the motion.
pub(super) struct Precision<const M: usize> {
    /// Largest error of a step, as a share of the states' sizes.
    pub tolerance: f64,
    /// Sizes of the states.
    pub sizes: [f64; M],
    /// How often an axis swings to and fro on its bristles before its oscillation is
    /// left out: after n swings about 3/n of it is left, and what it adds to the motion
    /// averages out.
    pub most_swings: usize,
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
    /// Who sees every step of v, if anybody; the torque may then jump between cells.
    pub trace: Option<&'a mut Recorder>,
    /// Largest |state| seen.
    pub largest: [f64; M],
    /// Times the motion has turned on its bristles.
    pub swings: usize,
    /// Effort that may still be spent, in that of an exact step.
    pub effort: &'a mut usize,
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
    /// switches without end or takes more effort than there is.
    pub fn run(&mut self, start: &Vector<S, M>) -> Option<Vector<S, M>> {
        let mut state = *start;
        let wave = self.wave;
        let mut mode = self.mechanics.mode_at(wave.cells[0].fixed(0.0), &state);
        let mut slope: Option<Vector<S, M>> = None;
        let mut pace = Pace::new(self.mechanics, wave.cells[0].length_s);
        for cell in &wave.cells {
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
                    let now = self.mechanics.motion_held(mode.contact, cell.fixed(from), &state);
                    if now != Motion::Stuck {
                        (mode.motion, slope) = (now, None);
                        self.set_off(mode, cell, from, &mut state);
                        switches += 1;
                    }
                }
                if self.mechanics.yields(mode, &state, YIELDING * self.precision.tolerance) {
                    mode.yields = true;
                    self.mechanics.bend(mode, &mut state);
                    (slope, self.swings) = (None, 0);
                }
                let begin = slope
                    .get_or_insert_with(|| self.mechanics.slope(mode, cell.fixed(from), &state));
                let mut width = pace.width(cell, from);
                let step = self.step(&mut pace, mode, cell, (from, &mut width), &state, begin);
                let error = self.error(&step, &state);
                if error.is_nan() {
                    return None;
                }
                if !pace.accepts(error, width * cell.length_s, cell.length_s) {
                    continue;
                }
                match self.switch(mode, cell, from, width, &step) {
                    None => {
                        self.add(cell, from, width, &step);
                        state = *step.end();
                        slope = Some(*step.end_slope());
                        let ends = from + width >= 1.0 - SLIVER;
                        from = if ends { 1.0 } else { from + width };
                    }
                    Some(switch) => {
                        switches += 1;
                        *self.effort = self.effort.saturating_sub(SWITCH_EFFORT);
                        let span = (from, width);
                        let late_s;
                        (state, from, late_s) =
                            self.up_to(&mut pace, mode, cell, span, &state, begin, &step, &switch);
                        mode = self.switched(mode, switch.event, cell.fixed(from), &mut state);
                        if matches!(switch.event, Event::Starts(_)) {
                            self.set_off(mode, cell, from, &mut state);
                        }
                        self.fix(mode, cell.fixed(from), &mut state, late_s);
                        slope = None;
                    }
                }
                self.note(&state);
            }
        }
        Some(state)
    }

    /// What bristles do as they begin to give way.
    fn set_off(&mut self, mode: Mode, cell: &Cell<S>, at: f64, state: &mut Vector<S, M>) {
        self.swings = 0;
        let rate = cell.slope(S::constant(at)) * (1.0 / cell.length_s);
        self.mechanics.set_off(mode, cell.fixed(at), rate, state);
    }

    fn note(&mut self, state: &Vector<S, M>) {
        for (largest, value) in self.largest.iter_mut().zip(state) {
            *largest = largest.max(value.value().abs());
        }
    }

    /// A step over part of a cell, or less.
    #[inline]
    fn step(
        &self,
        pace: &mut Pace<S, M>,
        mode: Mode,
        cell: &Cell<S>,
        (from, width): (f64, &mut f64),
        state: &Vector<S, M>,
        slope: &Vector<S, M>,
    ) -> Step<S, M> {
        let length_s = *width * cell.length_s;
        let torque = || match *width {
            1.0 => cell.powers,
            width => restricted(&cell.powers, from, from + width),
        };
        match pace {
            Pace::Controlled { .. } => {
                Step::Stages(Stages::new(state, slope, length_s, |stage, state| {
                    let torque = cell.fixed(from + *width * NODES[stage]);
                    self.mechanics.slope(mode, torque, state)
                }))
            }
            Pace::Series { modes, jets } => {
                let allowed = self.precision.sizes.map(|size| size * self.precision.tolerance);
                let affine = modes.of(mode, self.mechanics);
                let bends = mode.motion != Motion::Stuck && !jets.is_empty();
                let against =
                    bends.then_some(|terms: &[_]| self.mechanics.bent_term(mode, jets, terms));
                let series = affine.reach(state, &torque(), length_s, &allowed, against);
                *width *= series.share;
                Step::Series(series)
            }
            Pace::Exact { modes, again, .. } => {
                let (affine, powers) = (modes.of(mode, self.mechanics), torque());
                let end = affine.step(state, &powers, length_s, *again);
                let end_slope = affine.slope(&end, polynomial(&powers, 1.0));
                let (states, slopes) = ([*state, end], [*slope, end_slope]);
                let mut ends = Ends { length_s, states, slopes, curvatures: None };
                if self.is_seen() || !ends.stays_beyond(VELOCITY, 0.0) {
                    let rate = 1.0 / length_s;
                    let last = wave_slope(&powers, S::constant(1.0));
                    ends.curvatures = Some([
                        affine.curvature(slope, powers[1] * rate),
                        affine.curvature(&end_slope, last * rate),
                    ]);
                }
                Step::Ends(ends)
            }
        }
    }

    /// A step's error in errors allowed, where it is not so small by itself.
    fn error(&self, step: &Step<S, M>, state: &Vector<S, M>) -> f64 {
        let Step::Stages(stages) = step else { return step.end()[VELOCITY].value() * 0.0 };
        let mut sizes = self.precision.sizes;
        let v = state[VELOCITY].value();
        sizes[VELOCITY] = self.mechanics.velocity_size(v, sizes[VELOCITY]);
        stages.error(&sizes) / self.precision.tolerance
    }

    /// Whether v between the ends of a step matters.
    fn is_seen(&self) -> bool {
        self.sums.is_some() || self.trace.is_some()
    }

    fn add(&mut self, cell: &Cell<S>, from: f64, width: f64, step: &Step<S, M>) {
        if let Some(trace) = self.trace.as_deref_mut() {
            let (from_s, length_s) = (cell.from_s + from * cell.length_s, width * cell.length_s);
            trace.add(from_s, length_s, step.numbers(VELOCITY).all(), 1.0);
        }
        let Some(sums) = self.sums.as_deref_mut() else { return };
        match (cell.whole, step) {
            (Some(n), Step::Ends(ends)) if from == 0.0 && width == 1.0 => {
                sums.add_whole(n, ends.powers(VELOCITY, |v| v));
            }
            _ => step.add(VELOCITY, sums, cell.from_s + from * cell.length_s, 1.0),
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
        let looks: &[f64] = match step {
            Step::Series(_) => &LOOKS_IN_SERIES,
            _ => &LOOKS,
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
            let least = self.least(event);
            // What has just switched stands at zero and moves away from it.
            let fresh = signal(0.0).abs() <= least;
            let threshold = if fresh { least } else { 0.0 };
            let end = first.as_ref().map_or(1.0, |switch| switch.at);
            let mut low = 0.0;
            for look in looks.iter().map(|look| look * end) {
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

    /// State and position at a switch, and how much later than there it happens: no
    /// more than derivatives.
    #[expect(clippy::too_many_arguments, reason = "what a step is made of")]
    fn up_to(
        &mut self,
        pace: &mut Pace<S, M>,
        mode: Mode,
        cell: &Cell<S>,
        (from, width): (f64, f64),
        state: &Vector<S, M>,
        slope: &Vector<S, M>,
        step: &Step<S, M>,
        switch: &Switch,
    ) -> (Vector<S, M>, f64, S) {
        let mut part = width * switch.at;
        let cut;
        let (step, mut reach, mut end, end_slope) = match step {
            Step::Series(series) => {
                let (end, end_slope) = series.at(switch.at);
                (step, switch.at, end, end_slope)
            }
            _ => {
                if let Pace::Exact { again, .. } = pace {
                    *again = false;
                }
                cut = self.step(pace, mode, cell, (from, &mut part), state, slope);
                (&cut, 1.0, *cut.end(), *cut.end_slope())
            }
        };
        let there = self.signal(switch.event, mode, cell.fixed(from + part), &end);
        let rate_s = match self.state_of(switch.event, mode) {
            Some((i, sign, _)) => sign * end_slope[i].value(),
            None => {
                // Of several states: central differences along the motion.
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
        // One step of Newton's method; further than a step's own error it would be no
        // correction.
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
        (end, from + part + later, late_s - late_s.value())
    }

    /// Takes the state behind a switch from the instant it happens to that of its value,
    /// so that the instants of a pass do not vary: v is continuous, and what its sums gain
    /// before the switch they lose behind it.
    fn fix(&self, mode: Mode, torque: S, state: &mut Vector<S, M>, late_s: S) {
        if S::LANES == 0 {
            return;
        }
        let slope = self.mechanics.slope(mode, torque, state);
        for (value, slope) in state.iter_mut().zip(&slope) {
            *value -= late_s * slope.value();
        }
    }

    /// The mode behind a switch.
    fn switched(&mut self, mode: Mode, event: Event, torque: S, state: &mut Vector<S, M>) -> Mode {
        let moving = [Motion::Forward, Motion::Backward];
        match event {
            Event::Stops => {
                state[VELOCITY] = S::constant(0.0);
                let motion = if self.mechanics.can_rest() {
                    self.mechanics.motion_at_rest(mode.contact, torque, state)
                } else {
                    self.swings += 1;
                    let held = self.swings > self.precision.most_swings
                        && self.mechanics.motion_held(mode.contact, torque, state) == Motion::Stuck;
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
                let motion = self.mechanics.motion_held(mode.contact, torque, state);
                Mode { motion, ..mode }
            }
            _ => mode,
        }
    }
}
