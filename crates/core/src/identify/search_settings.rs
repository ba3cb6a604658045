//! The tuned numbers of the searches: how hard they try, and what they pass over.
//!
//! None of them decides what counts as an effect: that is left to levels and prior odds, which
//! stand where they are used. These only say where fits start, how many are followed, and how
//! far. `docs/search-settings.md` has what halving and doubling each of them does, and the command
//! that repeats the table.

use serde::{Deserialize, Serialize};

/// How many models are tried.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SearchBreadth {
    /// Effects that are fitted beside one other: those that promise most.
    pub pair_partners: usize,
    /// Effects that are fitted beside two others.
    pub triple_partners: usize,
    /// Single effects to which a second one is added, beside the best model.
    pub grown_singles: usize,
    /// Starts of a fit of one effect of which the first steps are taken.
    pub single_starts: usize,
    /// The same of an effect beside one other.
    pub pair_starts: usize,
    /// The same of an effect beside two others.
    pub triple_starts: usize,
    /// Starts that are followed to their end.
    pub followed_starts: usize,
    /// Further starts of the chosen effects whose misfit has several minima.
    pub deepening_starts: usize,
}

impl SearchBreadth {
    /// Effects that are fitted beside so many others, one or two.
    pub(crate) fn partners(&self, beside: usize) -> usize {
        if beside <= 1 { self.pair_partners } else { self.triple_partners }
    }

    /// Starts of an effect beside so many others, none to two.
    pub(crate) fn starts(&self, beside: usize) -> usize {
        [self.single_starts, self.pair_starts, self.triple_starts][beside.min(2)]
    }
}

/// The tuned numbers of the searches, of a diagnosis and of the ends of intervals.
///
/// The default is what every answer of the service is computed with; other values are for
/// measuring what each is worth.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SearchSettings {
    /// How many models are tried where every input is a cosine.
    pub cosines: SearchBreadth,
    /// The same where an input is anything else: simulating a record takes a thousand times
    /// longer.
    pub records: SearchBreadth,
    /// Points of the grid from which an effect without start points of its own is tried, at most.
    pub grid_points: usize,
    /// Step from one spatial frequency of a torque ripple to the next, as the change of its angle
    /// over the longest travel, radians.
    pub ripple_angle_step_rad: f64,
    /// The same step, at most, as a share of the spatial frequency.
    pub ripple_relative_step: f64,
    /// Peaks of the scan over spatial frequencies from which a fit may start.
    pub ripple_starts: usize,
    /// Factor by which the change that an effect makes at a grid point may be scaled up to fit the
    /// residuals, at most.
    pub largest_scale: f64,
    /// The same factor of a start, at least: an effect of no size has no shape that a fit could
    /// follow.
    pub smallest_scale: f64,
    /// Longest step of a base parameter, in logarithms and input scales, by which a start makes
    /// room for an effect.
    pub longest_start_shift: f64,
    /// Two directions in which an effect shows are the same where their cosine is nearer to 1
    /// than this.
    pub same_direction: f64,
    /// Two starts show something different where the cosine of their directions is further from 1
    /// than this: those come first.
    pub different_direction: f64,
    /// Share of the chance threshold that the score test must promise for an effect to be followed
    /// from several starts.
    pub promising_share: f64,
    /// Steps of a fit that decides which of several starts is worth more.
    pub glance_steps: usize,
    /// Steps of a fit of an effect of which little is to be expected.
    pub brief_steps: usize,
    /// Relative decrease of the cost by a step at which those two end sooner.
    pub trial_tolerance: f64,
    /// Steps of a fit that is followed to its end, at most.
    pub settle_steps: usize,
    /// Relative decrease of the cost by a step at which that one ends.
    pub settle_tolerance: f64,
    /// Share of the leading effect's gain that another must reach in its first steps to be
    /// followed.
    pub rival_share: f64,
    /// The same share where no effect alone explains the data: several may act together.
    pub hopeful_share: f64,
    /// Share of the base model's misfit beyond noise that the best effect leaves at most for it to
    /// be started again from aside: perhaps it is the right effect in the wrong minimum.
    pub restart_remainder: f64,
    /// How far aside, in prior standard deviations of the effect's parameters.
    pub restart_displacement: f64,
    /// Starts from aside that are followed to their end.
    pub followed_restarts: usize,
    /// Share of the misfit beyond noise by which a restart must be better for the search to start
    /// again from aside of that.
    pub restart_improvement: f64,
    /// An effect that gains this many times the chance threshold is not fitted again from
    /// further starts.
    pub deepening_limit: f64,
    /// Larger values that are tried in place of one below its likely range.
    pub larger_values: usize,
    /// Refits after which the end of an interval is where the last one was.
    pub interval_refits: usize,
    /// Longest step towards the end of an interval, as a factor of the distance.
    pub interval_longest_step: f64,
    /// Steps of each of these refits, at most.
    pub interval_steps: usize,
    /// Decrease of the cost by a step, relative to the cost and the rise that ends the interval, at
    /// which a refit ends.
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
            interval_longest_step: 3.0,
            interval_steps: 8,
            interval_tolerance: 3e-5,
        }
    }
}
