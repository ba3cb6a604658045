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
    /// Number of effects fitted beside one other effect: those with the largest score.
    ///
    /// Halved: same causes, −8 % time. Doubled: same causes, same time.
    pub pair_partners: usize,
    /// Number of effects fitted beside two other effects.
    ///
    /// Halved: same causes, same time. Doubled: same causes, same time.
    pub triple_partners: usize,
    /// Number of single-effect models, beside the best one, to which a second effect is added.
    ///
    /// Halved: same causes, same time. Doubled: same causes, same time.
    pub grown_singles: usize,
    /// Number of starting points from which one effect alone is fitted for a few steps.
    ///
    /// Halved: same causes, −13 % time. Doubled: same causes, +11 % time.
    pub single_starts: usize,
    /// The same for an effect beside one other.
    ///
    /// Halved: same causes, same time. Doubled: same causes, same time.
    pub pair_starts: usize,
    /// The same for an effect beside two others.
    ///
    /// Halved: same causes, same time. Doubled: same causes, same time.
    pub triple_starts: usize,
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
    /// Number of effects fitted beside so many others, one or two.
    pub(crate) fn partners(&self, beside: usize) -> usize {
        if beside <= 1 { self.pair_partners } else { self.triple_partners }
    }

    /// Number of starting points of an effect beside so many others, none to two.
    pub(crate) fn starts(&self, beside: usize) -> usize {
        [self.single_starts, self.pair_starts, self.triple_starts][beside.min(2)]
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
    /// Step of the scan over spatial frequencies of a torque ripple, as the change of its angle
    /// over the longest travel, radians.
    ///
    /// Halved: same causes, +17 % time. Doubled: same causes, same time.
    pub ripple_angle_step_rad: f64,
    /// Upper limit of that step, relative to the spatial frequency.
    ///
    /// Halved: same causes, same time. Doubled: same causes, same time.
    pub ripple_relative_step: f64,
    /// Number of peaks of that scan from which a fit may start.
    ///
    /// Halved: same causes, same time. Doubled: same causes, same time.
    pub ripple_starts: usize,
    /// Largest factor by which an effect at a grid point is scaled to fit the residuals.
    ///
    /// Halved: same causes, same time. Doubled: same causes, same time.
    pub largest_scale: f64,
    /// Smallest such factor of a starting point: an effect of size 0 has no gradient in its other
    /// parameters.
    ///
    /// Halved: same causes, −14 % time. Doubled: same causes, same time.
    pub smallest_scale: f64,
    /// Largest step of a base parameter from the fitted model to a starting point, in logarithms
    /// or input scales.
    ///
    /// Halved: same causes, same time. Doubled: same causes, same time.
    pub longest_start_shift: f64,
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
    /// familywise threshold.
    ///
    /// Halved: same causes, +104 % time. Doubled: same causes, −11 % time.
    pub promising_share: f64,
    /// Steps of a fit that ranks starting points.
    ///
    /// Halved: same causes, −12 % time. Doubled: same causes, same time.
    pub glance_steps: usize,
    /// Steps of a fit of an effect that is not promising.
    ///
    /// Halved: same causes, same time. Doubled: same causes, same time.
    pub brief_steps: usize,
    /// Relative decrease of the cost in one step at which these two kinds of fit stop early.
    ///
    /// Halved: same causes, +10 % time. Doubled: same causes, −7 % time.
    pub trial_tolerance: f64,
    /// Largest number of steps of a fit that is followed until it converges.
    ///
    /// Halved: same causes, same time. Doubled: same causes, same time.
    pub settle_steps: usize,
    /// Relative decrease of the cost in one step at which it counts as converged.
    ///
    /// Halved: same causes, same time. Doubled: same causes, same time.
    pub settle_tolerance: f64,
    /// Gain after the first steps from which on an effect is followed, as a share of the gain of
    /// the best effect.
    ///
    /// Halved: same causes, same time. Doubled: same causes, same time.
    pub rival_share: f64,
    /// The same if no single effect explains the data, so that several may be present.
    ///
    /// Halved: same causes, same time. Doubled: same causes, same time.
    pub hopeful_share: f64,
    /// The best effect is started again from displaced parameters if it leaves less than this
    /// share of the excess misfit: it may be the right effect in a wrong local minimum.
    ///
    /// Halved: same causes, same time. Doubled: same causes, same time.
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
    /// A chosen effect that gains more than this multiple of the familywise threshold is not
    /// fitted again from further starting points.
    ///
    /// Halved: same causes, same time. Doubled: same causes, same time.
    pub deepening_limit: f64,
    /// Number of larger values tried in place of one below its likely range.
    ///
    /// Halved: same causes, same time. Doubled: same causes, same time.
    pub larger_values: usize,
    /// Largest number of refits for the end of an interval.
    ///
    /// Halved: same causes, same time. Doubled: same causes, same time.
    pub interval_refits: usize,
    /// Largest ratio of one distance tried for the end of an interval to the one before it.
    ///
    /// Halved: same causes, +7 % time. Doubled: same causes, +10 % time.
    pub interval_extrapolation: f64,
    /// Largest number of steps of each of these refits: they start near their minimum.
    ///
    /// Halved: same causes, same time. Doubled: same causes, same time.
    pub interval_steps: usize,
    /// Decrease of the cost in one step at which such a refit has converged, relative to the cost
    /// plus the rise that ends the interval. For a χ² of 1000 that is a hundredth of the rise.
    ///
    /// Halved: same causes, same time. Doubled: same causes, same time.
    pub interval_tolerance: f64,
}

impl Default for SearchSettings {
    fn default() -> Self {
        let cosines = SearchBreadth {
            pair_partners: 5,
            triple_partners: 3,
            grown_singles: 4,
            single_starts: 4,
            pair_starts: 4,
            triple_starts: 2,
            followed_starts: 2,
            deepening_starts: 8,
        };
        let records = SearchBreadth {
            pair_partners: 3,
            triple_partners: 1,
            grown_singles: 1,
            single_starts: 2,
            pair_starts: 1,
            triple_starts: 1,
            followed_starts: 1,
            deepening_starts: 0,
        };
        Self {
            cosines,
            records,
            grid_points: 24,
            ripple_angle_step_rad: 1.0,
            ripple_relative_step: 0.15,
            ripple_starts: 6,
            largest_scale: 1.5,
            smallest_scale: 0.02,
            longest_start_shift: 0.3,
            same_direction: 1e-4,
            different_direction: 0.1,
            promising_share: 0.7,
            glance_steps: 4,
            brief_steps: 5,
            trial_tolerance: 1e-3,
            settle_steps: 60,
            settle_tolerance: 1e-5,
            rival_share: 0.5,
            hopeful_share: 0.02,
            restart_remainder: 0.5,
            restart_displacement: 0.35,
            followed_restarts: 3,
            restart_improvement: 0.1,
            deepening_limit: 10.0,
            larger_values: 4,
            interval_refits: 6,
            interval_extrapolation: 3.0,
            interval_steps: 8,
            interval_tolerance: 3e-5,
        }
    }
}
