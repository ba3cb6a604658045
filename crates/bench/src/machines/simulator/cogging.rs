//! The periodic state over a cogging torque: θ has zero mean, and a constant torque b makes
//! the mean of v zero.
//!
//! Beside the states at the beginning of a period, θ₀ among them, b is unknown; the
//! equations are that the period ends as it began, θ included, and that the mean of θ is
//! zero. Newton's method solves them all at once, first without the cogging torque, where
//! there is one solution, and then with growing shares of it, each from the one before.

use nalgebra::{DMatrix, DVector};

use super::drive::Drive;
use super::mechanics::Mechanics;
use super::stepping::Axis;
use super::{Settings, SimulatorError};

/// Periods at θ₀ and b as guessed, for the other states to forget rest.
const FIRST_PERIODS: usize = 6;
/// Corrections by Newton's method at one share of the cogging torque.
const CORRECTIONS: usize = 25;
/// Corrections at all shares together: where the branch of solutions ends, the shares that
/// are tried get ever closer.
const MOST_CORRECTIONS: usize = 80;
/// Halvings of one correction.
const HALVINGS: usize = 5;
/// Smallest growth of the share.
const SMALLEST_GROWTH: f64 = 1.0 / 256.0;
/// Step of the differences, as a share of an unknown's range.
const DIFFERENCE: f64 = 1e-6;

/// The states at the beginning of a period, and b, input units.
pub(super) struct Held<const N: usize> {
    pub(super) state: [f64; N],
    pub(super) constant_torque: f64,
}

/// The periodic state and the constant torque that belong to each other; `None` where no
/// constant torque lets the axis move both ways.
pub(super) fn hold<const N: usize>(
    mechanics: &Mechanics,
    drive: &Drive,
    settings: &Settings,
) -> Result<Option<Held<N>>, SimulatorError> {
    let (low, high) = drive.range();
    let friction = mechanics.friction();
    let levels = &friction.levels;
    if friction.bristle_stiffness.is_none() && high - low <= levels.fs_plus + levels.fs_minus {
        return Ok(None);
    }
    let problem = Problem {
        mechanics,
        drive,
        torque: 0.5 * (high - low) + mechanics.cogging_amplitude(),
        position: mechanics.position().unwrap_or_default(),
    };
    // Moves as far beyond one level as beyond the other.
    let centred = 0.5 * (levels.fs_plus - levels.fs_minus - high - low);
    let mut held = problem.first_guess(centred);
    let (mut share, mut growth) = (0.0, 1.0);
    let mut corrections = 0;
    loop {
        match problem.solve(share, &held, settings.tolerance, &mut corrections) {
            Ok(solution) => {
                held = solution;
                if share >= 1.0 {
                    return Ok(Some(held));
                }
            }
            Err(Unsolved { change }) => {
                share -= growth;
                growth *= 0.5;
                if share < 0.0 || growth < SMALLEST_GROWTH || corrections > MOST_CORRECTIONS {
                    // Beside each correction, a period for each column of the Jacobian.
                    let periods = corrections * (N + 2);
                    return Err(SimulatorError::NotPeriodic { periods, change });
                }
            }
        }
        growth = growth.min(1.0 - share);
        share += growth;
    }
}

/// Newton's method found no solution; this is left, as a share of the ranges.
struct Unsolved {
    change: f64,
}

struct Problem<'a> {
    mechanics: &'a Mechanics,
    drive: &'a Drive,
    /// Amplitudes of τ and of the cogging torque, the range of b.
    torque: f64,
    /// Index of θ.
    position: usize,
}

/// One period from given unknowns.
struct Cycle<const N: usize> {
    end: [f64; N],
    /// Largest size of each state.
    largest: [f64; N],
    mean_position: f64,
}

impl Problem<'_> {
    fn cycle<const N: usize>(&self, share: f64, held: &Held<N>) -> Cycle<N> {
        let mechanics = self.mechanics.with_cogging(held.constant_torque, share);
        let mut axis = Axis::new(&mechanics, self.drive, held.state);
        let mut largest = held.state.map(f64::abs);
        let (mut integral, mut elapsed_s) = (0.0, 0.0);
        axis.run_period(&mut |piece| {
            for (largest, value) in largest.iter_mut().zip(piece.end) {
                *largest = largest.max(value.abs());
            }
            integral += piece.integral(self.position);
            elapsed_s += piece.to_s - piece.from_s;
        });
        Cycle { end: axis.state(), largest, mean_position: integral / elapsed_s }
    }

    /// Without the cogging torque, after a few periods whose drift is taken back each time.
    fn first_guess<const N: usize>(&self, constant_torque: f64) -> Held<N> {
        let mut held = Held { state: [0.0; N], constant_torque };
        for _ in 0..FIRST_PERIODS {
            let start = held.state[self.position];
            let cycle = self.cycle(0.0, &held);
            held.state = cycle.end;
            held.state[self.position] = start - cycle.mean_position;
        }
        held
    }

    /// What is left of the equations, each as a share of its range.
    fn residual<const N: usize>(cycle: &Cycle<N>, held: &Held<N>, ranges: &[f64]) -> DVector<f64> {
        let mean = cycle.mean_position / ranges[N];
        let changes = (0..N).map(|i| (cycle.end[i] - held.state[i]) / ranges[i]);
        DVector::from_iterator(N + 1, changes.chain([mean]))
    }

    fn solve<const N: usize>(
        &self,
        share: f64,
        guess: &Held<N>,
        tolerance: f64,
        corrections: &mut usize,
    ) -> Result<Held<N>, Unsolved> {
        let mut held = Held { ..*guess };
        let mut cycle = self.cycle(share, &held);
        for _ in 0..CORRECTIONS {
            *corrections += 1;
            let ranges = self.ranges(&cycle);
            let left = Self::residual(&cycle, &held, &ranges);
            let change = left.amax();
            // Rounding; a load that floats leaves its place in the gap undetermined.
            if change <= 1e-3 * tolerance {
                return Ok(held);
            }
            let mut jacobian = DMatrix::zeros(N + 1, N + 1);
            for column in 0..=N {
                let moved =
                    self.moved(&held, &ranges, |i| if i == column { DIFFERENCE } else { 0.0 });
                let slope = (Self::residual(&self.cycle(share, &moved), &moved, &ranges) - &left)
                    / DIFFERENCE;
                jacobian.set_column(column, &slope);
            }
            let Some(correction) = jacobian.lu().solve(&(-&left)) else {
                return Err(Unsolved { change });
            };
            let size = correction.amax();
            if size <= tolerance {
                return Ok(held);
            }
            // Far jumps leave the branch that is followed.
            let mut damping = (0.5 / size).min(1.0);
            let mut halvings = 0;
            loop {
                let next = self.moved(&held, &ranges, |i| damping * correction[i]);
                let tried = self.cycle(share, &next);
                let remains = Self::residual(&tried, &next, &ranges).amax();
                if remains < (1.0 - 0.1 * damping) * change {
                    (held, cycle) = (next, tried);
                    break;
                }
                // As good as rounding lets it be.
                if size <= 1e3 * tolerance && change <= 10.0 * tolerance {
                    return Ok(held);
                }
                halvings += 1;
                if halvings > HALVINGS {
                    return Err(Unsolved { change });
                }
                damping *= 0.5;
            }
        }
        let ranges = self.ranges(&cycle);
        Err(Unsolved { change: Self::residual(&cycle, &held, &ranges).amax() })
    }

    /// Ranges of the states, and of b or the mean of θ.
    fn ranges<const N: usize>(&self, cycle: &Cycle<N>) -> Vec<f64> {
        let positive = |range: &f64| if *range > 0.0 { *range } else { 1.0 };
        let mut ranges: Vec<f64> = cycle.largest.iter().map(positive).collect();
        ranges.push(ranges[self.position]);
        ranges
    }

    /// Unknowns moved by shares of their ranges.
    fn moved<const N: usize>(
        &self,
        held: &Held<N>,
        ranges: &[f64],
        share: impl Fn(usize) -> f64,
    ) -> Held<N> {
        Held {
            state: std::array::from_fn(|i| held.state[i] + ranges[i] * share(i)),
            constant_torque: held.constant_torque + self.torque * share(N),
        }
    }
}
