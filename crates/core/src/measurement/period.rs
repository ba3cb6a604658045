//! Period detection by the normalised square difference function.
//!
//! A lag L is a candidate period if the signal hardly differs from itself L samples later:
//!
//! ```text
//!   r(L) = Σ [x(n) − x(n+L)]² / Σ [x(n)² + x(n+L)²]
//! ```
//!
//! The sums run over all n for which both samples exist. r is 0 at a period and about 1 at a lag
//! at which the signal is uncorrelated with itself. 1 − r is the normalised square difference
//! function of P. McLeod and G. Wyvill, "A smarter way to find pitch", Proc. ICMC 2005. Steps:
//!
//! 1. Evaluate r at all integer lags from the autocorrelation. The best lag is the period or a
//!    multiple of it.
//! 2. Refine that lag to a fraction of a sample.
//! 3. Find the smallest divisor L/q that repeats as well as L.
//! 4. Refine the longest multiple of it that fits in the record. The error of the period is the
//!    error of that lag divided by the multiple.
//! 5. Round to a whole number of samples unless the data contradict it.
//!
//! Pitch detectors usually take the first high peak. Here that would mistake half-periods of a
//! trajectory and beats of a multisine for the period.

mod square_difference;

pub(super) use square_difference::{INTERPOLATION_REACH, products};
use square_difference::{MOST_COMPARED, difference, interpolation, minimum_near, similarity};

/// Largest relative difference between a period in samples and a whole number at which it is
/// rounded to that number.
pub(super) const WHOLE_SAMPLES_TOLERANCE: f64 = 1e-6;

/// Largest r at the best lag for which the signal counts as periodic. Tuned.
const LARGEST_DIFFERENCE: f64 = 0.25;

/// Shortest period, samples. A shorter one leaves hardly any harmonic below the Nyquist frequency.
pub(super) const SHORTEST: f64 = 4.0;

/// Largest number of samples compared at each lag of the search near a stated period.
const MOST_SEARCHED: usize = 5000;

/// Number of samples compared in the quick check that rejects most lags.
const QUICK_CHECK_SAMPLES: usize = 500;

/// Period of a signal in samples; `None` if the signal does not hold two periods of a repeating
/// pattern.
pub(super) fn find(signal: &[f64]) -> Option<f64> {
    let mean = signal.iter().sum::<f64>() / signal.len() as f64;
    let signal: Vec<f64> = signal.iter().map(|x| x - mean).collect();
    if signal.len() < 2 * SHORTEST as usize {
        return None;
    }
    let similarity = similarity(&signal);
    // Skip the peak at lag 0, which ends where the similarity changes sign.
    let peak_end = similarity.iter().position(|value| *value < 0.0)?;
    let shortest = peak_end.max(SHORTEST as usize);
    let best =
        (shortest..similarity.len()).max_by(|a, b| similarity[*a].total_cmp(&similarity[*b]))?;
    if 1.0 - similarity[best] > LARGEST_DIFFERENCE {
        return None;
    }
    let multiple = minimum_near(&signal, best as f64);
    let period = smallest_part(&signal, &similarity, shortest, multiple);
    Some(refined(&signal, period))
}

/// Best period within `searched` times `stated` of it, in samples, from the change over at most
/// `periods` periods; `None` if the signal is too short for one of them.
pub(super) fn find_near(signal: &[f64], stated: f64, searched: f64, periods: f64) -> Option<f64> {
    let mean = signal.iter().sum::<f64>() / signal.len() as f64;
    let signal: Vec<f64> = signal.iter().map(|x| x - mean).collect();
    let last = signal.len().checked_sub(4 * INTERPOLATION_REACH)?;
    let lags = [1.0 - searched, 1.0 + searched].map(|share| (share * stated).round() as usize);
    let apart = |lag: usize| {
        let places = signal.len() - lag;
        let stride = places.div_ceil(MOST_SEARCHED);
        let (mut squares, mut energy) = (0.0, 0.0);
        for (earlier, later) in signal.iter().zip(&signal[lag..]).step_by(stride) {
            squares += (earlier - later).powi(2);
            energy += earlier * earlier + later * later;
        }
        if energy > 0.0 { squares / energy } else { 1.0 }
    };
    let best = (lags[0].max(SHORTEST as usize)..=lags[1].min(last))
        .map(|lag| (apart(lag), lag))
        .min_by(|a, b| a.0.total_cmp(&b.0))?;
    Some(refined_over(&signal, minimum_near(&signal, best.1 as f64), periods))
}

/// The changes x(n + lag) − x(n) for two lags, at the same n.
pub(super) fn changes(signal: &[f64], lags: [f64; 2]) -> [Vec<f64>; 2] {
    let longest = lags[0].max(lags[1]).floor() as usize;
    let count = signal.len().saturating_sub(longest + 2 * INTERPOLATION_REACH);
    let places = INTERPOLATION_REACH..INTERPOLATION_REACH + count;
    lags.map(|lag| {
        let (whole, weights) = (lag.floor() as usize, interpolation(lag.fract()));
        let change = |n: usize| {
            let around = &signal[n + whole + 1 - INTERPOLATION_REACH..];
            around.iter().zip(&weights).map(|(x, w)| x * w).sum::<f64>() - signal[n]
        };
        places.clone().map(change).collect()
    })
}

/// The shortest of L, L/2, L/3 … that repeats as well as L, with L = `multiple`.
fn smallest_part(signal: &[f64], similarity: &[f64], shortest: usize, multiple: f64) -> f64 {
    // For noise, r has a relative standard error of about √(3/n). The interpolation between
    // samples adds up to about 10⁻⁵ of the energy.
    let reference = difference(signal, multiple, MOST_COMPARED);
    let accepted = reference * (1.0 + 6.0 * (3.0 / signal.len() as f64).sqrt()) + 1e-5;
    let passes_quick_check = |lag: f64| {
        // Up to half a sample away from a period even a rough signal still resembles itself, so
        // the similarity at the nearest integer lags rejects most lags cheaply.
        let nearest = similarity[lag.floor() as usize].max(similarity[lag.ceil() as usize]);
        nearest > 0.25 * (1.0 - reference)
            && difference(signal, lag, QUICK_CHECK_SAMPLES) <= 1.5 * accepted
    };
    let mut best: Option<(f64, f64)> = None;
    for part in (2..=(multiple / shortest as f64) as usize).rev() {
        let lag = multiple / part as f64;
        let repeats = passes_quick_check(lag).then(|| difference(signal, lag, MOST_COMPARED));
        match (repeats.filter(|r| *r <= accepted), best) {
            (Some(r), None) => best = Some((r, lag)),
            // Adjacent divisors can lie on the flanks of the same minimum; keep the lowest.
            (Some(r), Some((least, _))) if r < least => best = Some((r, lag)),
            (Some(_), Some(_)) | (None, None) => {}
            (None, Some(_)) => break,
        }
    }
    best.map_or(multiple, |(_, lag)| lag)
}

/// The period, refined over the longest multiple of it that fits in the record.
fn refined(signal: &[f64], period: f64) -> f64 {
    let room = signal.len() as f64 - period.max(2.0 * INTERPOLATION_REACH as f64) - 1.0;
    refined_over(signal, period, (room / period).floor().max(1.0))
}

/// The same over `most` periods.
fn refined_over(signal: &[f64], period: f64, most: f64) -> f64 {
    let mut period = period;
    let mut multiple = 1.0;
    // Doubling the multiple keeps the error of the starting lag within the ±1 sample that
    // `minimum_near` searches.
    loop {
        period = minimum_near(signal, multiple * period) / multiple;
        if multiple >= most {
            break;
        }
        multiple = (2.0 * multiple).min(most);
    }
    let whole = period.round();
    let least = difference(signal, most * period, MOST_COMPARED);
    // A free parameter lowers r by about r/n by chance. The whole number is rejected only if it
    // raises r by more than 30·r/n, plus 1 % because the interpolation smooths noise.
    let accepted = least * (1.01 + 30.0 / signal.len() as f64) + 1e-12;
    if difference(signal, most * whole, MOST_COMPARED) <= accepted { whole } else { period }
}

/// The nearest whole number if `samples` hardly differs from it, else `samples`.
pub(super) fn whole_if_nearly(samples: f64) -> f64 {
    let whole = samples.round();
    if (samples - whole).abs() <= WHOLE_SAMPLES_TOLERANCE * samples { whole } else { samples }
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};

    use super::*;

    const TAU: f64 = std::f64::consts::TAU;

    fn with_noise(signal: impl Iterator<Item = f64>, level: f64, seed: u64) -> Vec<f64> {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        signal
            .map(|x| {
                let noise: f64 = StandardNormal.sample(&mut rng);
                x + level * noise
            })
            .collect()
    }

    #[test]
    fn a_pure_tone_between_samples_is_found() {
        for (period, count) in [(62.37, 500), (4.7, 300), (333.3, 700), (100.0, 1050), (10.0, 21)] {
            let tone: Vec<f64> = (0..count).map(|n| (TAU * n as f64 / period).cos()).collect();
            let found = find(&tone).unwrap();
            // The interpolation is good to 10⁻⁵ of the energy.
            assert!((found / period - 1.0).abs() < 1e-4, "{found} for {period}");
        }
    }

    #[test]
    fn a_noisy_tone_is_found_to_the_accuracy_of_its_phase() {
        for seed in 0..5 {
            let period = 87.3;
            let tone = with_noise((0..2000).map(|n| (TAU * n as f64 / period).cos()), 0.1, seed);
            let found = find(&tone).unwrap();
            // Standard error: 1/(2π)·√2·0.1·√(2/87) of a period over 22 periods; 5 times that.
            assert!((found / period - 1.0).abs() < 8e-4, "{found}");
        }
    }

    #[test]
    fn a_noisy_multisine_has_the_period_of_its_line_spacing() {
        for (period, noise) in [(500.0, 0.3), (500.0, 0.0), (431.27, 0.1)] {
            let lines = 7..60;
            let wave = |n: f64| -> f64 {
                lines
                    .clone()
                    .map(|k| {
                        let k = f64::from(k);
                        (TAU * k * n / period - std::f64::consts::PI * k * k / 53.0).cos()
                    })
                    .sum::<f64>()
                    / 53f64.sqrt()
            };
            for count in [1000, 1490, 4321] {
                let signal = with_noise((0..count).map(|n| wave(f64::from(n))), noise, 3);
                let Some(found) = find(&signal) else { panic!("{period} in {count}: none") };
                if period.fract() == 0.0 {
                    assert_eq!(found, period, "{count} {noise}");
                } else {
                    assert!((found / period - 1.0).abs() < 1e-4, "{found} in {count}");
                }
            }
        }
    }

    #[test]
    fn two_close_tones_have_the_period_of_their_beat() {
        // 10 and 11 cycles in 600 samples.
        let wave = |n: usize| {
            let angle = TAU * n as f64 / 600.0;
            (10.0 * angle).cos() + 0.3 * (11.0 * angle).sin()
        };
        let signal = with_noise((0..1300).map(wave), 0.02, 4);
        assert_eq!(find(&signal), Some(600.0));
    }

    #[test]
    fn noise_and_standstill_have_no_period() {
        assert_eq!(find(&with_noise((0..5000).map(|_| 0.0), 1.0, 5)), None);
        assert_eq!(find(&[3.0; 100]), None);
    }
}
