//! Estimates the time left from the progress so far.

/// Shortest time after which there is an estimate, seconds.
const EARLIEST_S: f64 = 5.0;

/// Smallest fraction at which there is an estimate.
const LEAST_FRACTION: f64 = 0.05;

/// An estimate is given while the forecasts of the latest third of the time agree to within this
/// factor.
const LARGEST_SPREAD: f64 = 2.0;

/// Where the latest third of the time begins.
const LATEST: f64 = 2.0 / 3.0;

/// Forecasts that differ by less than this agree, seconds: near the end no factor matters.
const NEGLIGIBLE_S: f64 = 2.0;

/// Samples whose fraction grew by less than this are not kept, which bounds their number.
const RESOLUTION: f64 = 1.0 / 512.0;

/// The history of progress, and the estimate of the time left that follows from it.
///
/// It begins when the rest of the computation is certain. Each sample of the latest third of the
/// time since then forecasts the end: if the rest takes as long as the part of it that is done, in
/// proportion, it ends after elapsed/fraction. So does the speed over that third. If these
/// forecasts agree, their geometric middle is the estimate; if they do not, the fraction has not
/// grown steadily, and nothing is known.
#[derive(Debug, Clone, Default)]
pub(super) struct RemainingTime {
    /// Seconds elapsed and fraction of the whole done when the rest became certain.
    begin: Option<(f64, f64)>,
    /// (seconds elapsed, fraction of the rest done) since then, in order.
    samples: Vec<(f64, f64)>,
}

impl RemainingTime {
    /// The rest is certain after `elapsed_s` seconds, when `fraction` of the whole is done.
    pub fn since(elapsed_s: f64, fraction: f64) -> Self {
        Self { begin: Some((elapsed_s, fraction)), samples: Vec::new() }
    }

    /// The time left, seconds, when `fraction` is done after `elapsed_s`; `None` while it is not
    /// known to within a factor of two.
    pub fn after(&mut self, elapsed_s: f64, fraction: f64) -> Option<f64> {
        let (begin_s, begin) = self.begin?;
        self.after_of_rest(elapsed_s - begin_s, (fraction - begin) / (1.0 - begin))
    }

    /// The same; both since the rest was certain, and as a fraction of the rest.
    fn after_of_rest(&mut self, elapsed_s: f64, fraction: f64) -> Option<f64> {
        if self.samples.last().is_none_or(|(_, last)| fraction - last >= RESOLUTION) {
            self.samples.push((elapsed_s, fraction));
        }
        if elapsed_s < EARLIEST_S || fraction < LEAST_FRACTION {
            return None;
        }
        let begin = self.samples.partition_point(|(at, _)| *at < LATEST * elapsed_s);
        let latest = &self.samples[begin..];
        let (since, from) = *latest.first()?;
        let speed = (fraction - from) / (elapsed_s - since);
        let by_speed = (1.0 - fraction) / speed;
        let (mut least, mut most) = (by_speed, by_speed);
        for (at, done) in latest.iter().chain([&(elapsed_s, fraction)]) {
            let left = at / done - elapsed_s;
            (least, most) = (least.min(left), most.max(left));
        }
        let agree = most <= LARGEST_SPREAD * least || most - least.max(0.0) <= NEGLIGIBLE_S;
        (agree && most.is_finite()).then(|| (most * least.max(0.25 * most)).sqrt())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The estimates after each of these (seconds, fraction).
    fn estimates(samples: impl IntoIterator<Item = (f64, f64)>) -> Vec<Option<f64>> {
        let mut remaining = RemainingTime::since(0.0, 0.0);
        samples.into_iter().map(|(at, fraction)| remaining.after(at, fraction)).collect()
    }

    /// One sample a second of a computation that takes 100 s.
    fn steady(seconds: std::ops::Range<u32>) -> impl Iterator<Item = (f64, f64)> {
        seconds.map(|second| (f64::from(second), 0.01 * f64::from(second)))
    }

    #[test]
    fn steady_progress_is_extrapolated() {
        for (second, left) in estimates(steady(0..100)).into_iter().enumerate().skip(5) {
            let left = left.expect("it is steady");
            assert!((left - (100 - second) as f64).abs() < 1e-9, "{left} after {second} s");
        }
    }

    #[test]
    fn too_early_nothing_is_known() {
        assert!(estimates(steady(0..5)).iter().all(Option::is_none));
        // After long enough, but hardly anything is done.
        assert_eq!(estimates((0..20).map(|s| (f64::from(s), 1e-3 * f64::from(s)))), [None; 20]);
        // At the beginning of everything, as where the observer has no clock.
        assert_eq!(estimates([(0.0, 0.0), (0.0, 0.5), (0.0, 1.0)]), [None; 3]);
    }

    // 30 s for 30 %, then 10 s for the next percent: at the average speed 89 s are left, at that of
    // the latest third of the time 224 s.
    #[test]
    fn after_a_stall_nothing_is_known_until_progress_is_steady_again() {
        let again = (0..=60).map(|s| (40.0 + f64::from(s), 0.31 + 0.01 * f64::from(s)));
        let recovered = estimates(steady(0..31).chain(again));
        assert_eq!(recovered[31], None);
        let left = recovered.last().unwrap().expect("steady for long enough");
        assert!((4.5..18.0).contains(&left), "{left}, not 9");
    }

    // From 30 to 80 % at once.
    #[test]
    fn after_a_jump_nothing_is_known() {
        let jumped = steady(0..31).chain([(31.0, 0.8)]);
        assert_eq!(estimates(jumped).last(), Some(&None));
    }

    #[test]
    fn the_history_kept_is_bounded() {
        let mut remaining = RemainingTime::since(0.0, 0.0);
        for step in 0..100_000 {
            remaining.after(f64::from(step), 1e-5 * f64::from(step));
        }
        assert!(remaining.samples.len() <= 513, "{}", remaining.samples.len());
    }
}
