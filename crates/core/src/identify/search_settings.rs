//! The tuned settings of the search: where fits start, how many are followed, and how far.
//!
//! None of them decides whether an effect is present. That is decided by significance levels and
//! prior odds, which are constants beside the code that uses them. `benches/ablation.sh` measures
//! what halving and doubling each setting does; `docs/search-settings.md` describes it.

use serde::{Deserialize, Serialize};

/// How many models and starting points are tried.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SearchBreadth {
    /// Number of effects fitted beside others: those with the largest score.
    ///
    /// Halved: same causes, −8 % time. Doubled: same causes, same time.
    pub partners: usize,
    /// Number of starting points from which one effect alone is fitted for a few steps.
    ///
    /// Halved: same causes, −13 % time. Doubled: same causes, +11 % time.
    pub single_starts: usize,
    /// The same for an effect beside others.
    ///
    /// Halved: same causes, same time. Doubled: same causes, same time.
    pub joint_starts: usize,
    /// Number of these starts, the best, that are followed until the fit converges.
    ///
    /// Halved: same causes, same time. Doubled: same causes, +27 % time.
    pub followed_starts: usize,
    /// Number of further starting points for a chosen effect whose misfit has several minima.
    ///
    /// Halved: same causes, +7 % time. Doubled: same causes, same time.
    pub deepening_starts: usize,
}

impl SearchBreadth {
    /// Number of starting points of an effect beside so many others.
    pub(crate) fn starts(&self, beside: usize) -> usize {
        if beside == 0 { self.single_starts } else { self.joint_starts }
    }
}

/// The tuned settings of the search of a diagnosis, and of the ends of intervals.
///
/// Every answer of the service is computed with the default. Other values are for measuring what a
/// setting is worth.
///
/// The last line of a setting tells the result of the ablation in `docs/search-settings.md`:
/// whether causes or verdicts change, and the processor time (the same if within 5 %).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SearchSettings {
    /// How many models are tried if every input is a pure cosine.
    pub cosines: SearchBreadth,
    /// The same for other inputs, whose simulation takes about a thousand times longer.
    pub records: SearchBreadth,
    /// Largest number of grid points at which an effect without starting points of its own is
    /// tried.
    ///
    /// Halved: same causes, same time. Doubled: same causes, same time.
    pub grid_points: usize,
    /// Step of the scan over spatial frequencies of cogging, as the change of its angle
    /// over half the longest travel from end to end, radians.
    ///
    /// Halved: not measured. Doubled: same causes, −14 % time.
    pub ripple_angle_step_rad: f64,
    /// Largest factor by which an effect at a grid point is scaled to fit the residuals.
    ///
    /// Halved: same causes, same time. Doubled: same causes, same time. Without a limit EMPS is
    /// explained worse: 0.35 instead of 0.25 % are left.
    pub largest_scale: f64,
    /// Smallest such factor of a starting point: an effect of size 0 has no gradient in its other
    /// parameters.
    ///
    /// Halved: same causes, −14 % time. Doubled: same causes, same time.
    pub smallest_scale: f64,
    /// Two directions of an effect count as one if 1 − |cosine| between them is at most this.
    ///
    /// Halved: same causes, same time. Doubled: same causes, same time.
    pub same_direction: f64,
    /// A starting point counts as different from those of larger gain if 1 − |cosine| between
    /// their directions exceeds this. Different ones are tried first.
    ///
    /// Halved: same causes, same time. Doubled: same causes, same time.
    pub different_direction: f64,
    /// Score from which on an effect is fitted from several starting points, as a share of the
    /// family-wise threshold.
    ///
    /// Halved: same causes, +104 % time. Doubled: same causes, −11 % time.
    pub promising_share: f64,
    /// Steps of a fit that ranks starting points and effects.
    ///
    /// Halved: same causes, −12 % time. Doubled: same causes, same time.
    pub glance_steps: usize,
    /// Relative decrease of the cost in one step at which such a fit stops early.
    ///
    /// Halved: same causes, +10 % time. Doubled: same causes, −7 % time.
    pub trial_tolerance: f64,
    /// Relative decrease of the cost in one step at which a fit counts as converged; in a refit for
    /// the end of an interval, relative to the cost plus the rise that ends it.
    ///
    /// Halved: same causes, same time. Doubled: same causes, same time.
    pub settle_tolerance: f64,
    /// Gain after the first steps from which on an effect is followed, as a share of the gain of
    /// the best effect.
    ///
    /// Halved: same causes, same time. Doubled: same causes, same time.
    pub rival_share: f64,
    /// The best effect is started again from displaced parameters if it leaves less than this
    /// share of the excess misfit: it may be the right effect in a wrong local minimum.
    ///
    /// Halved: same causes, same time. Doubled: same causes, same time. Without restarts the
    /// backlash of `single-60-backlash-o1-7` (seed 41041, by character) is not explained.
    pub restart_remainder: f64,
    /// That displacement, in prior standard deviations of the effect's parameters.
    ///
    /// Halved: same causes, same time. Doubled: same causes, same time.
    pub restart_displacement: f64,
    /// Number of displaced starts that are followed until the fit converges.
    ///
    /// Halved: same causes, same time. Doubled: same causes, same time.
    pub followed_restarts: usize,
    /// Share of the excess misfit that a restart must remove for another round of restarts.
    ///
    /// Halved: same causes, same time. Doubled: same causes, same time.
    pub restart_improvement: f64,
    /// A chosen effect that gains more than this multiple of the family-wise threshold is not
    /// fitted again from further starting points.
    ///
    /// Halved: same causes, same time. Doubled: same causes, same time.
    pub deepening_limit: f64,
    /// Largest number of refits for the end of an interval.
    ///
    /// Halved: same causes, same time. Doubled: same causes, same time.
    pub interval_refits: usize,
    /// Largest ratio of one distance tried for the end of an interval to the one before it.
    ///
    /// Halved: same causes, +7 % time. Doubled: same causes, +10 % time.
    pub interval_extrapolation: f64,
}

impl Default for SearchSettings {
    fn default() -> Self {
        let cosines = SearchBreadth {
            partners: 5,
            single_starts: 4,
            joint_starts: 4,
            followed_starts: 2,
            deepening_starts: 8,
        };
        let records = SearchBreadth {
            partners: 3,
            single_starts: 2,
            joint_starts: 1,
            followed_starts: 1,
            deepening_starts: 0,
        };
        Self {
            cosines,
            records,
            grid_points: 24,
            ripple_angle_step_rad: 3.0,
            largest_scale: 1.5,
            smallest_scale: 0.02,
            same_direction: 1e-4,
            different_direction: 0.1,
            promising_share: 0.7,
            glance_steps: 4,
            trial_tolerance: 1e-3,
            settle_tolerance: 1e-5,
            rival_share: 0.5,
            restart_remainder: 0.5,
            restart_displacement: 0.35,
            followed_restarts: 3,
            restart_improvement: 0.1,
            deepening_limit: 10.0,
            interval_refits: 6,
            interval_extrapolation: 3.0,
        }
    }
}
