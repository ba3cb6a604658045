//! A periodic motion, described by the times at which it switches between forward, backward and
//! rest.

/// Motion of the axis during a phase.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Motion {
    /// v > 0.
    Forward,
    /// v < 0.
    Backward,
    /// v = 0, held by friction.
    Stuck,
}

/// A phase of the motion, from its start to the start of the next phase.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Phase {
    /// Start, seconds, from the input's time origin.
    pub start_s: f64,
    /// Motion of the axis during the phase.
    pub motion: Motion,
}

/// One period of a motion.
#[derive(Debug, Clone, PartialEq)]
pub struct SwitchingTimes {
    /// Period, seconds.
    pub period_s: f64,
    /// Phases in cyclic order; the last one ends a period after the start of the first one. A
    /// single phase lasts the whole period: the motion never switches.
    pub phases: Vec<Phase>,
}

impl SwitchingTimes {
    /// A motion that never switches.
    pub(crate) fn constant(period_s: f64, motion: Motion) -> Self {
        Self { period_s, phases: vec![Phase { start_s: 0.0, motion }] }
    }

    /// Whether the motion switches at all.
    pub(crate) fn switches(&self) -> bool {
        self.phases.len() > 1
    }

    /// Phase `i` as (start, end, motion), seconds.
    pub(crate) fn span(&self, i: usize) -> (f64, f64, Motion) {
        let phase = self.phases[i];
        let end = match self.phases.get(i + 1) {
            Some(next) => next.start_s,
            None => self.phases[0].start_s + self.period_s,
        };
        (phase.start_s, end, phase.motion)
    }

    /// Index of the phase before phase `i`, cyclically.
    pub(crate) fn before(&self, i: usize) -> usize {
        if i == 0 { self.phases.len() - 1 } else { i - 1 }
    }

    /// Whether the axis rests during some phase.
    pub(crate) fn sticks(&self) -> bool {
        self.phases.iter().any(|phase| phase.motion == Motion::Stuck)
    }
}
