//! Why a time record gives no experiment.

/// Why a record cannot be converted into an experiment. Sample indices start at 0.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum RecordError {
    /// Time stands still or runs backwards.
    #[error("time does not increase: {time_s} s comes after {before_s} s")]
    NotIncreasing {
        /// The later sample.
        sample: usize,
        /// Its time, s.
        time_s: f64,
        /// Time of the sample before, s.
        before_s: f64,
    },
    /// The time steps are not equal.
    #[error(
        "the sampling interval is not constant: a step of {step_s:.6e} s where {usual_s:.6e} s \
             is usual; resample the record"
    )]
    UnequalSampling {
        /// The sample at the end of the step that differs most.
        sample: usize,
        /// That step, s.
        step_s: f64,
        /// The median step, s.
        usual_s: f64,
    },
    /// The record has too few samples.
    #[error("the record has {samples} samples, which is too few")]
    TooShort {
        /// Number of samples.
        samples: usize,
    },
    /// No period was given, and none is found in the input.
    #[error(
        "no period is found in the input of {duration_s} s, which must repeat at least twice: \
         record longer, or give period_s"
    )]
    NoPeriodFound {
        /// Duration of the record, s.
        duration_s: f64,
    },
    /// The input does not repeat with the given period.
    #[error(
        "the input does not repeat with the period of {period_s} s that is given: from one period \
         to the next it changes by {percent:.0} % of its root mean square; give the right \
         period_s, leave it out to have the period found, or say period_s: none where the record \
         does not repeat"
    )]
    NotRepeating {
        /// The period, s.
        period_s: f64,
        /// Change of the input from one period to the next, % of its root mean square.
        percent: f64,
    },
    /// The input repeats with another period than the given one.
    #[error(
        "the input does not repeat with the period of {period_s} s that is given, but with \
         {found_s} s: give that as period_s, or leave period_s out to have the period found"
    )]
    OtherPeriod {
        /// The given period, s.
        period_s: f64,
        /// The period that the input shows, s.
        found_s: f64,
    },
    /// The period has too few samples.
    #[error("the period {period_s} s has {samples:.3} samples, and at least 4 are needed")]
    Undersampled {
        /// The period, s.
        period_s: f64,
        /// Samples in it.
        samples: f64,
    },
    /// The record does not hold one whole period after the dropped ones.
    #[error(
        "no whole period: the record lasts {duration_s:.6} s, its period is {period_s} s, and \
         {settle_periods} periods are dropped; record longer, or drop fewer (settle_periods)"
    )]
    NoWholePeriod {
        /// Duration of the record, s.
        duration_s: f64,
        /// The period, s.
        period_s: f64,
        /// Periods dropped at its beginning.
        settle_periods: usize,
    },
}
