//! Extremes of a periodic signal given by its harmonics.

use rustfft::FftPlanner;

use super::Complex;

/// Half the peak-to-peak value of x(t) = Re Σ Xₖ exp(jkωt).
///
/// Exact for a single harmonic. Otherwise the signal is sampled at 16 or more points per period of
/// the highest harmonic, and a parabola through the three points around each extreme refines it.
pub(crate) fn half_peak_to_peak(harmonics: &[Complex]) -> f64 {
    let [top, bottom] = extremes(harmonics);
    0.5 * (top + bottom)
}

/// Largest absolute value of x(t) without its mean, to the same accuracy.
pub(crate) fn peak(harmonics: &[Complex]) -> f64 {
    extremes(harmonics).into_iter().fold(0.0, f64::max)
}

/// How far x(t) goes above and below its mean.
fn extremes(harmonics: &[Complex]) -> [f64; 2] {
    let alternating = harmonics.get(1..).unwrap_or(&[]);
    let mut nonzero = alternating.iter().filter(|value| value.norm_sqr() > 0.0);
    match (nonzero.next(), nonzero.next()) {
        (None, _) => return [0.0; 2],
        (Some(only), None) => return [only.norm(); 2],
        _ => {}
    }
    let points = (16 * harmonics.len()).next_power_of_two().max(256);
    let mut wave = vec![Complex::ZERO; points];
    wave[1..harmonics.len()].copy_from_slice(alternating);
    FftPlanner::new().plan_fft_inverse(points).process(&mut wave);
    [1.0, -1.0].map(|sign: f64| {
        let height = |index: usize| sign * wave[index % points].re;
        let top = (0..points).max_by(|a, b| height(*a).total_cmp(&height(*b))).unwrap_or(0);
        let (left, middle, right) = (height(top + points - 1), height(top), height(top + 1));
        let curvature = 2.0 * middle - left - right;
        let rise = if curvature > 0.0 { (right - left).powi(2) / (8.0 * curvature) } else { 0.0 };
        middle + rise
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cosine_of_any_phase_has_its_amplitude() {
        let one = [Complex::ZERO, Complex::from_polar(2.5, 1.1)];
        assert_eq!(half_peak_to_peak(&one), one[1].norm());
    }

    #[test]
    fn a_mean_does_not_count_and_two_lines_add_where_they_meet() {
        let phase = 0.3;
        let lines = [
            Complex::new(7.0, 0.0),
            Complex::from_polar(1.0, phase),
            Complex::ZERO,
            Complex::from_polar(0.5, 3.0 * phase),
        ];
        // Both lines peak at ωt = −phase. With points 1/64 of the third harmonic's period apart
        // the parabola has a relative error of about (2π/64)⁴/384.
        assert!((half_peak_to_peak(&lines) - 1.5).abs() < 1e-6);
    }
}
