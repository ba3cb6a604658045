//! Runge–Kutta steps, cut where the motion changes.

use super::drive::Drive;
use super::mechanics::{Mechanics, Motion, State, VELOCITY};

/// Halvings that find an event: to 2⁻⁴⁵ of a step, the rounding of the time itself.
const HALVINGS: usize = 45;

/// A stretch of time within one step in which nothing switches.
pub(super) struct Piece {
    /// Beginning and end, steps from the beginning of the period.
    pub(super) from_steps: f64,
    pub(super) to_steps: f64,
    /// Its length, s.
    pub(super) duration_s: f64,
    /// State and its time derivative at both ends.
    pub(super) start: State,
    pub(super) start_slope: State,
    pub(super) end: State,
    pub(super) end_slope: State,
}

/// A servo axis in time.
pub(super) struct Axis<'a> {
    mechanics: Mechanics,
    drive: &'a Drive,
    step_s: f64,
    state: State,
    motion: Motion,
}

impl<'a> Axis<'a> {
    /// At the beginning of a period, at rest.
    pub(super) fn at_rest(mechanics: Mechanics, drive: &'a Drive, step_s: f64) -> Self {
        let state = State::default();
        let motion = mechanics.at_zero(drive.whole_step(0)[0], &state);
        Self { mechanics, drive, step_s, state, motion }
    }

    pub(super) fn state(&self) -> State {
        self.state
    }

    /// Runs one period; `visit` sees every piece of it in order.
    pub(super) fn run_period(&mut self, visit: &mut impl FnMut(&Piece)) {
        for step in 0..self.drive.steps() {
            let torques = self.drive.whole_step(step);
            let end = self.stepped(torques, self.step_s);
            if self.mechanics.is_over(self.motion, torques[2], &end) {
                self.run_through_events(step as f64, visit);
            } else {
                self.move_to(end, step as f64, step as f64 + 1.0, torques, visit);
            }
        }
    }

    /// One step in which the motion ends, perhaps more than once.
    fn run_through_events(&mut self, first_steps: f64, visit: &mut impl FnMut(&Piece)) {
        let last_steps = first_steps + 1.0;
        let mut from_steps = first_steps;
        while from_steps < last_steps {
            let (torques, end) = self.attempt(from_steps, last_steps);
            if !self.mechanics.is_over(self.motion, torques[2], &end) {
                self.move_to(end, from_steps, last_steps, torques, visit);
                return;
            }
            // An axis that leaves v = 0 and is back within this step has not moved enough
            // to be followed: it counts as at rest. So every pass gets further.
            let just_left = self.motion != Motion::Stuck && self.state[VELOCITY] == 0.0;
            let to_steps =
                if just_left { last_steps } else { self.end_of_motion(from_steps, last_steps) };
            let (torques, mut end) = self.attempt(from_steps, to_steps);
            end[VELOCITY] = 0.0;
            self.move_to(end, from_steps, to_steps, torques, visit);
            self.motion = self.mechanics.at_zero(torques[2], &end);
            from_steps = to_steps;
        }
    }

    /// The instant, to within rounding, at which the motion that lasts at `from_steps`
    /// comes to its end; it is over at `to_steps`.
    fn end_of_motion(&self, from_steps: f64, to_steps: f64) -> f64 {
        let (mut before, mut after) = (from_steps, to_steps);
        for _ in 0..HALVINGS {
            let middle = 0.5 * (before + after);
            let (torques, end) = self.attempt(from_steps, middle);
            if self.mechanics.is_over(self.motion, torques[2], &end) {
                after = middle;
            } else {
                before = middle;
            }
        }
        after
    }

    /// Torques over part of a step and the state at its end, if nothing switched.
    fn attempt(&self, from_steps: f64, to_steps: f64) -> ([f64; 3], State) {
        let torques =
            [from_steps, 0.5 * (from_steps + to_steps), to_steps].map(|time| self.drive.at(time));
        (torques, self.stepped(torques, (to_steps - from_steps) * self.step_s))
    }

    fn stepped(&self, torques: [f64; 3], duration_s: f64) -> State {
        let slope = |torque, state| self.mechanics.slope(self.motion, torque, state);
        runge_kutta(&slope, torques, self.state, duration_s)
    }

    fn move_to(
        &mut self,
        end: State,
        from_steps: f64,
        to_steps: f64,
        torques: [f64; 3],
        visit: &mut impl FnMut(&Piece),
    ) {
        visit(&Piece {
            from_steps,
            to_steps,
            duration_s: (to_steps - from_steps) * self.step_s,
            start: self.state,
            start_slope: self.mechanics.slope(self.motion, torques[0], self.state),
            end,
            end_slope: self.mechanics.slope(self.motion, torques[2], end),
        });
        self.state = end;
    }
}

/// One classical Runge–Kutta step of x' = slope(input, x), with the input at the
/// beginning, middle and end of it.
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
