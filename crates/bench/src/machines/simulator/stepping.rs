//! Runge–Kutta steps of fixed length, with event location by bisection.

use super::drive::{Drive, Segment};
use super::mechanics::{Mechanics, Mode, Motion, VELOCITY};

/// Bisection steps that locate an event to 2⁻⁴⁵ of a step, about the rounding error of the time.
const HALVINGS: usize = 45;
/// Most events within one step. After that the rest of the step is integrated without events: a
/// joint that chatters faster has hardly any energy left.
const MOST_EVENTS: usize = 64;

/// A part of a step within which the mode does not change.
pub(super) struct Piece<const N: usize> {
    /// Beginning and end, s from the beginning of the period.
    pub(super) from_s: f64,
    pub(super) to_s: f64,
    /// State and its time derivative at both ends.
    pub(super) start: [f64; N],
    pub(super) start_slope: [f64; N],
    pub(super) end: [f64; N],
    pub(super) end_slope: [f64; N],
}

impl<const N: usize> Piece<N> {
    /// A state at the middle, from the cubic Hermite interpolant through both ends.
    pub(super) fn middle(&self, state: usize) -> f64 {
        let slopes = self.start_slope[state] - self.end_slope[state];
        0.5 * (self.start[state] + self.end[state]) + (self.to_s - self.from_s) / 8.0 * slopes
    }

    /// ∫ x dt by Simpson's rule.
    pub(super) fn integral(&self, state: usize) -> f64 {
        let ends = self.start[state] + self.end[state];
        (self.to_s - self.from_s) / 6.0 * (ends + 4.0 * self.middle(state))
    }
}

/// Time integration of a servo axis.
pub(super) struct Axis<'a, const N: usize> {
    mechanics: &'a Mechanics,
    drive: &'a Drive,
    state: [f64; N],
    mode: Mode,
}

impl<'a, const N: usize> Axis<'a, N> {
    /// An axis in the given state at the beginning of a period.
    pub(super) fn new(mechanics: &'a Mechanics, drive: &'a Drive, state: [f64; N]) -> Self {
        let mode = mechanics.mode(drive.first(), &state);
        Self { mechanics, drive, state, mode }
    }

    pub(super) fn state(&self) -> [f64; N] {
        self.state
    }

    /// Integrates over one period and calls `visit` with every piece in order.
    pub(super) fn run_period(&mut self, visit: &mut impl FnMut(&Piece<N>)) {
        for segment in self.drive.segments() {
            for step in 0..segment.steps() {
                let torques = segment.whole_step(step);
                let end = self.stepped(torques, segment.step_s());
                let from_steps = step as f64;
                if self.mode_has_ended(torques[2], &end) {
                    self.run_through_events(segment, from_steps, visit);
                } else {
                    self.move_to(end, segment, [from_steps, from_steps + 1.0], torques, visit);
                }
            }
        }
    }

    /// Integrates one step in which the mode changes once or more.
    fn run_through_events(
        &mut self,
        segment: &Segment,
        mut from_steps: f64,
        visit: &mut impl FnMut(&Piece<N>),
    ) {
        let last_steps = from_steps + 1.0;
        let mut events = 0;
        while from_steps < last_steps {
            let (torques, end) = self.attempt(segment, from_steps, last_steps);
            events += 1;
            if !self.mode_has_ended(torques[2], &end) || events > MOST_EVENTS {
                self.move_to(end, segment, [from_steps, last_steps], torques, visit);
                return;
            }
            // An axis that leaves v = 0 and returns within this step moves too little to be
            // resolved, so it counts as being at rest until the end of the step. This guarantees
            // progress in every pass.
            let just_left = self.mode.motion != Motion::Stuck && self.state[VELOCITY] == 0.0;
            let over = |torque: f64, end: &[f64; N]| {
                self.mechanics.contact_is_over(self.mode, end)
                    || (!just_left && self.mechanics.motion_is_over(self.mode, torque, end))
            };
            let to_steps = if over(torques[2], &end) {
                self.first_time(segment, from_steps, last_steps, over)
            } else {
                last_steps
            };
            let (torques, mut end) = self.attempt(segment, from_steps, to_steps);
            let mut next = self.mode;
            if self.mechanics.contact_is_over(self.mode, &end) {
                next.contact = self.mechanics.at_edge(self.mode.contact, &mut end);
            }
            let stops = self.mechanics.motion_is_over(self.mode, torques[2], &end);
            if stops {
                end[VELOCITY] = 0.0;
            }
            self.move_to(end, segment, [from_steps, to_steps], torques, visit);
            if stops {
                next.motion = self.mechanics.at_zero(next.contact, torques[2], &end);
            }
            self.mode = next;
            from_steps = to_steps;
        }
    }

    /// The position, in steps, at which `over` becomes true, by bisection; it must be true at
    /// `to_steps`.
    fn first_time(
        &self,
        segment: &Segment,
        from_steps: f64,
        to_steps: f64,
        over: impl Fn(f64, &[f64; N]) -> bool,
    ) -> f64 {
        let (mut before, mut after) = (from_steps, to_steps);
        for _ in 0..HALVINGS {
            let middle = 0.5 * (before + after);
            let (torques, end) = self.attempt(segment, from_steps, middle);
            if over(torques[2], &end) {
                after = middle;
            } else {
                before = middle;
            }
        }
        after
    }

    #[inline]
    fn mode_has_ended(&self, torque: f64, end: &[f64; N]) -> bool {
        self.mechanics.motion_is_over(self.mode, torque, end)
            || self.mechanics.contact_is_over(self.mode, end)
    }

    /// Torques at the beginning, middle and end of part of a step, and the state at its end in the
    /// current mode.
    fn attempt(&self, segment: &Segment, from_steps: f64, to_steps: f64) -> ([f64; 3], [f64; N]) {
        let times = [from_steps, 0.5 * (from_steps + to_steps), to_steps];
        let torques = times.map(|steps| segment.at(steps));
        (torques, self.stepped(torques, (to_steps - from_steps) * segment.step_s()))
    }

    #[inline]
    fn stepped(&self, torques: [f64; 3], duration_s: f64) -> [f64; N] {
        let slope = |torque, state| self.mechanics.slope(self.mode, torque, state);
        runge_kutta(&slope, torques, self.state, duration_s)
    }

    #[inline]
    fn move_to(
        &mut self,
        end: [f64; N],
        segment: &Segment,
        [from_steps, to_steps]: [f64; 2],
        torques: [f64; 3],
        visit: &mut impl FnMut(&Piece<N>),
    ) {
        visit(&Piece {
            from_s: segment.time_s(from_steps),
            to_s: segment.time_s(to_steps),
            start: self.state,
            start_slope: self.mechanics.slope(self.mode, torques[0], self.state),
            end,
            end_slope: self.mechanics.slope(self.mode, torques[2], end),
        });
        self.state = end;
    }
}

/// One classical fourth-order Runge–Kutta step of x' = slope(input, x), with the input given at the
/// beginning, middle and end of the step.
#[inline]
pub(super) fn runge_kutta<const N: usize>(
    slope: &impl Fn(f64, [f64; N]) -> [f64; N],
    [first, middle, last]: [f64; 3],
    start: [f64; N],
    duration_s: f64,
) -> [f64; N] {
    let moved = |slope: [f64; N], time_s: f64| -> [f64; N] {
        std::array::from_fn(|i| start[i] + time_s * slope[i])
    };
    let k1 = slope(first, start);
    let k2 = slope(middle, moved(k1, 0.5 * duration_s));
    let k3 = slope(middle, moved(k2, 0.5 * duration_s));
    let k4 = slope(last, moved(k3, duration_s));
    let mean = std::array::from_fn(|i| (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]) / 6.0);
    moved(mean, duration_s)
}
