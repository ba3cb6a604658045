//! The periodic state with a cogging torque, by Newton's method with continuation.
//!
//! By definition θ has zero mean, and a constant torque b makes the mean of v zero. The unknowns
//! are the initial states (θ₀ among them) and b. The equations are periodicity of all states and
//! zero mean of θ. They are solved first without the cogging torque, where the solution is unique,
//! and then with increasing shares of it, each starting from the solution before.

use nalgebra::{DMatrix, DVector};

use super::drive::Drive;
use super::mechanics::Mechanics;
use super::stepping::Axis;
use super::{Settings, SimulatorError};

/// Periods simulated for the first guess, so that the transient from rest decays.
const FIRST_PERIODS: usize = 6;
/// Most Newton corrections at one share of the cogging torque.
const CORRECTIONS: usize = 25;
/// Most corrections at all shares together. Without this limit, the increments of the share would
/// shrink for long where the branch of solutions ends.
const MOST_CORRECTIONS: usize = 80;
/// Most halvings of one correction.
const HALVINGS: usize = 5;
/// Smallest increment of the share.
const SMALLEST_GROWTH: f64 = 1.0 / 256.0;
/// Step of the finite differences for the Jacobian, as a share of an unknown's range.
const DIFFERENCE: f64 = 1e-6;

/// The states at the beginning of a period, and the constant torque b, input units.
pub(super) struct CoggingState<const N: usize> {
    pub(super) state: [f64; N],
    pub(super) constant_torque: f64,
}

/// The periodic state and its constant torque; `None` if no constant torque lets the axis move in
/// both directions.
pub(super) fn cogging_state<const N: usize>(
    mechanics: &Mechanics,
    drive: &Drive,
    settings: &Settings,
) -> Result<Option<CoggingState<N>>, SimulatorError> {
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
    // The torque exceeds the static level by the same amount in both directions.
    let centred = 0.5 * (levels.fs_plus - levels.fs_minus - high - low);
    let mut unknowns = problem.first_guess(centred);
    let (mut share, mut growth) = (0.0, 1.0);
    let mut corrections = 0;
    loop {
        match problem.solve(share, &unknowns, settings.tolerance, &mut corrections) {
            Ok(solution) => {
                unknowns = solution;
                if share >= 1.0 {
                    return Ok(Some(unknowns));
                }
            }
            Err(Unsolved { change }) => {
                share -= growth;
                growth *= 0.5;
                if share < 0.0 || growth < SMALLEST_GROWTH || corrections > MOST_CORRECTIONS {
                    // Each correction simulates one period, and one per column of the Jacobian.
                    let periods = corrections * (N + 2);
                    return Err(SimulatorError::NotPeriodic { periods, change });
                }
            }
        }
        growth = growth.min(1.0 - share);
        share += growth;
    }
}

/// Newton's method failed.
struct Unsolved {
    /// Largest residual, as a share of its range.
    change: f64,
}

struct Problem<'a> {
    mechanics: &'a Mechanics,
    drive: &'a Drive,
    /// Sum of the amplitudes of τ and of the cogging torque; the range of b.
    torque: f64,
    /// Index of θ.
    position: usize,
}

/// Result of simulating one period.
struct Cycle<const N: usize> {
    end: [f64; N],
    /// Largest absolute value of each state.
    largest: [f64; N],
    mean_position: f64,
}

impl Problem<'_> {
    fn cycle<const N: usize>(&self, share: f64, unknowns: &CoggingState<N>) -> Cycle<N> {
        let mechanics = self.mechanics.with_cogging(unknowns.constant_torque, share);
        let mut axis = Axis::new(&mechanics, self.drive, unknowns.state);
        let mut largest = unknowns.state.map(f64::abs);
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

    /// First guess without the cogging torque: after a few periods, in each of which θ is shifted
    /// back to zero mean.
    fn first_guess<const N: usize>(&self, constant_torque: f64) -> CoggingState<N> {
        let mut unknowns = CoggingState { state: [0.0; N], constant_torque };
        for _ in 0..FIRST_PERIODS {
            let start = unknowns.state[self.position];
            let cycle = self.cycle(0.0, &unknowns);
            unknowns.state = cycle.end;
            unknowns.state[self.position] = start - cycle.mean_position;
        }
        unknowns
    }

    /// Residuals of the equations, each as a share of its range.
    fn residual<const N: usize>(
        cycle: &Cycle<N>,
        unknowns: &CoggingState<N>,
        ranges: &[f64],
    ) -> DVector<f64> {
        let mean = cycle.mean_position / ranges[N];
        let changes = (0..N).map(|i| (cycle.end[i] - unknowns.state[i]) / ranges[i]);
        DVector::from_iterator(N + 1, changes.chain([mean]))
    }

    fn solve<const N: usize>(
        &self,
        share: f64,
        guess: &CoggingState<N>,
        tolerance: f64,
        corrections: &mut usize,
    ) -> Result<CoggingState<N>, Unsolved> {
        let mut unknowns = CoggingState { ..*guess };
        let mut cycle = self.cycle(share, &unknowns);
        for _ in 0..CORRECTIONS {
            *corrections += 1;
            let ranges = self.ranges(&cycle);
            let left = Self::residual(&cycle, &unknowns, &ranges);
            let change = left.amax();
            // Only rounding errors are left. Stop here, because the position of a load that floats
            // in its gap is undetermined, and the Jacobian then singular.
            if change <= 1e-3 * tolerance {
                return Ok(unknowns);
            }
            let mut jacobian = DMatrix::zeros(N + 1, N + 1);
            for column in 0..=N {
                let moved =
                    self.moved(&unknowns, &ranges, |i| if i == column { DIFFERENCE } else { 0.0 });
                let slope = (Self::residual(&self.cycle(share, &moved), &moved, &ranges) - &left)
                    / DIFFERENCE;
                jacobian.set_column(column, &slope);
            }
            let Some(correction) = jacobian.lu().solve(&(-&left)) else {
                return Err(Unsolved { change });
            };
            let size = correction.amax();
            if size <= tolerance {
                return Ok(unknowns);
            }
            // A large step could jump to another branch of solutions.
            let mut damping = (0.5 / size).min(1.0);
            let mut halvings = 0;
            loop {
                let next = self.moved(&unknowns, &ranges, |i| damping * correction[i]);
                let tried = self.cycle(share, &next);
                let remains = Self::residual(&tried, &next, &ranges).amax();
                if remains < (1.0 - 0.1 * damping) * change {
                    (unknowns, cycle) = (next, tried);
                    break;
                }
                // Accept: rounding errors prevent any further improvement.
                if size <= 1e3 * tolerance && change <= 10.0 * tolerance {
                    return Ok(unknowns);
                }
                halvings += 1;
                if halvings > HALVINGS {
                    return Err(Unsolved { change });
                }
                damping *= 0.5;
            }
        }
        let ranges = self.ranges(&cycle);
        Err(Unsolved { change: Self::residual(&cycle, &unknowns, &ranges).amax() })
    }

    /// Ranges of the states, and that of the mean of θ.
    fn ranges<const N: usize>(&self, cycle: &Cycle<N>) -> Vec<f64> {
        let positive = |range: &f64| if *range > 0.0 { *range } else { 1.0 };
        let mut ranges: Vec<f64> = cycle.largest.iter().map(positive).collect();
        ranges.push(ranges[self.position]);
        ranges
    }

    /// The unknowns, displaced by shares of their ranges.
    fn moved<const N: usize>(
        &self,
        unknowns: &CoggingState<N>,
        ranges: &[f64],
        share: impl Fn(usize) -> f64,
    ) -> CoggingState<N> {
        CoggingState {
            state: std::array::from_fn(|i| unknowns.state[i] + ranges[i] * share(i)),
            constant_torque: unknowns.constant_torque + self.torque * share(N),
        }
    }
}
