//! Finds the highest harmonic of a measured response that is significantly above the noise, by an
//! F test per line with a Bonferroni correction over all lines.

use super::Complex;

/// Probability that any harmonic of a spectrum of pure noise passes.
const FALSE_ALARM: f64 = 0.01;

/// Number of lines on each side whose scatter is pooled with that of a line.
const NEIGHBOURS: usize = 8;

/// A gap is at least this many harmonics without a response, even if that is more than an octave.
const SHORTEST_GAP: usize = 50;

/// Most harmonics used of a single period, whose noise level is only a rough estimate.
const MOST_OF_ONE_PERIOD: usize = 1000;

/// Of a single period, the band that holds this share of the input's power is always used.
const INPUT_BAND: f64 = 0.99;

/// Highest harmonic above the noise, at least 1, from the scatter of M ≥ 2 periods about their
/// mean.
///
/// Let S = Σ|Yₖ⁽ᵐ⁾ − Yₖ|² be the scatter of line k, averaged over its neighbours. v = S/(M(M−1)) is
/// the estimated variance of the mean Yₖ, with ν degrees of freedom. For noise alone |Yₖ|²/v
/// follows an F distribution with (2, ν) degrees of freedom, which exceeds x with probability
/// (1 + 2x/ν)^(−ν/2).
pub(super) fn highest_of_periods(mean: &[Complex], deviations: &[&[Complex]]) -> usize {
    let periods = deviations.len() as f64;
    let scatter: Vec<f64> = (0..mean.len())
        .map(|k| deviations.iter().map(|deviation| deviation[k].norm_sqr()).sum())
        .collect();
    let level = FALSE_ALARM / mean.len() as f64;
    let above = |k: usize| {
        let pool =
            &scatter[k.saturating_sub(NEIGHBOURS).max(1)..mean.len().min(k + NEIGHBOURS + 1)];
        let count = pool.len() as f64;
        let variance = pool.iter().sum::<f64>() / (count * periods * (periods - 1.0));
        let freedom = 2.0 * (periods - 1.0) * count;
        let threshold = 0.5 * freedom * (level.powf(-2.0 / freedom) - 1.0);
        mean[k].norm_sqr() > threshold * variance
    };
    last_before_gap(mean, above)
}

/// Searches upwards from the strongest harmonic and returns the last one above the noise before a
/// gap of an octave.
///
/// Lines beyond such a gap are not part of the response but a disturbance synchronous with the
/// period (a resonance of the table, the switching of an amplifier). Keeping them would also mean
/// simulating all lines of the gap.
fn last_before_gap(spectrum: &[Complex], above: impl Fn(usize) -> bool) -> usize {
    let strongest = (1..spectrum.len())
        .max_by(|a, b| spectrum[*a].norm_sqr().total_cmp(&spectrum[*b].norm_sqr()));
    let mut last = strongest.filter(|k| above(*k)).unwrap_or(1);
    let mut next = last + 1;
    while next < spectrum.len() && next - last <= last.max(SHORTEST_GAP) {
        if above(next) {
            last = next;
        }
        next += 1;
    }
    last
}

/// Highest harmonic of a single period above the noise: at most [`MOST_OF_ONE_PERIOD`], but at
/// least 1 and at least the band of the input.
///
/// The noise level comes from the median of |Yₖ|² over the highest quarter of the spectrum, which
/// is taken to be noise. There |Yₖ|² is exponentially distributed, so its mean is median/ln 2.
pub(super) fn highest_of_one_period(response: &[Complex], input: &[Complex]) -> usize {
    let mut quarter: Vec<f64> =
        response[response.len() - response.len() / 4..].iter().map(Complex::norm_sqr).collect();
    quarter.sort_by(f64::total_cmp);
    let median = quarter.get(quarter.len() / 2).copied().unwrap_or(0.0);
    let noise = median / std::f64::consts::LN_2;
    let threshold = noise * (response.len() as f64 / FALSE_ALARM).ln();
    let above = |k: usize| response[k].norm_sqr() > threshold;
    let highest = last_before_gap(response, above).min(MOST_OF_ONE_PERIOD);
    highest.max(input_band(input)).min(response.len() - 1)
}

/// Lowest harmonic K such that harmonics 1 … K hold [`INPUT_BAND`] of the input's power.
fn input_band(input: &[Complex]) -> usize {
    let power: f64 = input.iter().skip(1).map(Complex::norm_sqr).sum();
    let mut below = 0.0;
    for (k, value) in input.iter().enumerate().skip(1) {
        below += value.norm_sqr();
        if below >= INPUT_BAND * power {
            return k;
        }
    }
    1
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};

    use super::*;

    fn noise(rng: &mut ChaCha8Rng) -> Complex {
        Complex::new(StandardNormal.sample(rng), StandardNormal.sample(rng))
    }

    /// Mean and deviations of `count` periods with unit noise and the given lines.
    fn periods(
        rng: &mut ChaCha8Rng,
        count: usize,
        lines: &dyn Fn(usize) -> f64,
    ) -> (Vec<Complex>, Vec<Vec<Complex>>) {
        let spectra: Vec<Vec<Complex>> =
            (0..count).map(|_| (0..500).map(|k| noise(rng) + lines(k)).collect()).collect();
        let mean: Vec<Complex> = (0..500)
            .map(|k| spectra.iter().map(|s| s[k]).sum::<Complex>() / count as f64)
            .collect();
        let deviations =
            spectra.iter().map(|s| s.iter().zip(&mean).map(|(a, b)| a - b).collect()).collect();
        (mean, deviations)
    }

    #[test]
    fn noise_alone_shows_no_harmonic_but_the_fundamental() {
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        for count in [2, 3, 18] {
            let alarms = (0..200)
                .filter(|_| {
                    let (mean, deviations) = periods(&mut rng, count, &|_| 0.0);
                    let deviations: Vec<&[Complex]> =
                        deviations.iter().map(Vec::as_slice).collect();
                    highest_of_periods(&mean, &deviations) > 1
                })
                .count();
            // Expected are 2 of 200; more than 8 have a probability of 10⁻⁴.
            assert!(alarms <= 8, "{alarms} of 200 with {count} periods");
        }
    }

    #[test]
    fn lines_well_above_the_noise_are_kept_to_the_last() {
        let mut rng = ChaCha8Rng::seed_from_u64(2);
        let (mean, deviations) = periods(&mut rng, 4, &|k| if k <= 250 { 20.0 } else { 0.0 });
        let deviations: Vec<&[Complex]> = deviations.iter().map(Vec::as_slice).collect();
        assert_eq!(highest_of_periods(&mean, &deviations), 250);
    }

    #[test]
    fn a_disturbance_beyond_an_octave_of_noise_is_left_out() {
        let mut rng = ChaCha8Rng::seed_from_u64(4);
        let line = |k: usize| if (60..=100).contains(&k) || k == 300 { 20.0 } else { 0.0 };
        let (mean, deviations) = periods(&mut rng, 4, &line);
        let deviations: Vec<&[Complex]> = deviations.iter().map(Vec::as_slice).collect();
        assert_eq!(highest_of_periods(&mean, &deviations), 100);
    }

    #[test]
    fn one_period_is_cut_where_it_sinks_into_the_top_of_its_spectrum() {
        let mut rng = ChaCha8Rng::seed_from_u64(3);
        let response: Vec<Complex> =
            (0..500).map(|k| noise(&mut rng) + if k <= 40 { 20.0 } else { 0.0 }).collect();
        let tone = [Complex::ZERO, Complex::new(1.0, 0.0)];
        assert_eq!(highest_of_one_period(&response, &tone), 40);
        let band: Vec<Complex> =
            (0..500).map(|k| Complex::new(if k <= 100 { 1.0 } else { 0.0 }, 0.0)).collect();
        assert_eq!(highest_of_one_period(&response, &band), 99);
    }
}
