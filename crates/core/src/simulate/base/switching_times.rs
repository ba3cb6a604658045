//! A periodic motion as the times at which it changes between forward, backward and rest.

/// What the axis does during a phase.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Motion {
    /// v > 0.
    Forward,
    /// v < 0.
    Backward,
    /// v = 0, held by friction.
    Stuck,
}

/// A phase: it lasts from its start to the start of the next.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Phase {
    /// Start, seconds; the input's time origin is 0.
    pub start_s: f64,
    /// What the axis does.
    pub motion: Motion,
}

/// One period of motion: phases in cyclic order.
#[derive(Debug, Clone, PartialEq)]
pub struct SwitchingTimes {
    /// Period, seconds.
    pub period_s: f64,
    /// Phases in order; the last one lasts until the first one's start, a
    /// period later. A single phase lasts the whole period and never switches.
    pub phases: Vec<Phase>,
}

impl SwitchingTimes {
    /// A motion that never switches.
    pub(crate) fn constant(period_s: f64, motion: Motion) -> Self {
        Self { period_s, phases: vec![Phase { start_s: 0.0, motion }] }
    }

    /// Whether there is any switch at all.
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

    /// The phase before phase `i`.
    pub(crate) fn before(&self, i: usize) -> usize {
        if i == 0 { self.phases.len() - 1 } else { i - 1 }
    }

    /// Whether the axis rests during some phase.
    pub(crate) fn sticks(&self) -> bool {
        self.phases.iter().any(|phase| phase.motion == Motion::Stuck)
    }
}
