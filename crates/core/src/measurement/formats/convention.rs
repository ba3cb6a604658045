//! Amplitude and phase conventions of an upload, and their conversion to those of this crate.

use crate::measurement::Complex;

/// Signal to which phases are referred.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) enum Reference {
    /// x(t) = Re Σ Xₖ exp(jkωt).
    #[default]
    Cosine,
    /// x(t) = X₀ + Im Σ Zₖ exp(jkωt), with the input m·sin(ωt).
    Sine,
}

/// Meaning of an amplitude.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) enum AmplitudeUnit {
    #[default]
    Peak,
    Rms,
    PeakToPeak,
}

/// Phase reference and amplitude unit of an upload.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Convention {
    pub(super) reference: Reference,
    pub(super) amplitude: AmplitudeUnit,
}

impl Convention {
    /// Factor from an amplitude as written to a peak amplitude.
    pub(super) fn peak(self) -> f64 {
        match self.amplitude {
            AmplitudeUnit::Peak => 1.0,
            AmplitudeUnit::Rms => std::f64::consts::SQRT_2,
            AmplitudeUnit::PeakToPeak => 0.5,
        }
    }

    /// Standard deviation of harmonic k, scaled in the same way as the harmonic.
    pub(super) fn deviation(self, k: usize, std: f64) -> f64 {
        if k == 0 { std } else { std * self.peak() }
    }

    /// Harmonic k of an input or a response in the convention of this crate.
    ///
    /// The mean (k = 0) is the same in every convention. With a sine reference the origin of time
    /// moves by a quarter of a period, t = t′ + T/4. Then m·sin(ωt) = m·cos(ωt′) and
    /// Im Zₖ exp(jkωt) = Re Zₖ j^(k−1) exp(jkωt′), so harmonic k of both input and response is
    /// rotated by (k−1)·90°.
    pub(super) fn harmonic(self, k: usize, written: Complex) -> Complex {
        if k == 0 {
            return Complex::new(written.re, 0.0);
        }
        let Complex { re, im } = written * self.peak();
        let quarter_turns = match self.reference {
            Reference::Cosine => 0,
            Reference::Sine => (k - 1) % 4,
        };
        match quarter_turns {
            0 => Complex::new(re, im),
            1 => Complex::new(-im, re),
            2 => Complex::new(-re, -im),
            _ => Complex::new(im, -re),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// y(t) at ωt = `phase` from cosine-referenced harmonics.
    fn value(harmonics: &[Complex], phase: f64) -> f64 {
        harmonics
            .iter()
            .enumerate()
            .map(|(k, y)| (y * Complex::from_polar(1.0, k as f64 * phase)).re)
            .sum()
    }

    #[test]
    fn a_sine_reference_moves_the_origin_of_time_by_a_quarter_period() {
        let written = [
            Complex::new(0.3, 0.0),
            Complex::new(1.0, -0.4),
            Complex::new(0.2, 0.1),
            Complex::new(-0.1, 0.5),
            Complex::new(0.05, 0.02),
        ];
        let convention = Convention { reference: Reference::Sine, ..Convention::default() };
        let turned: Vec<Complex> =
            written.iter().enumerate().map(|(k, z)| convention.harmonic(k, *z)).collect();
        for step in 0..16 {
            let phase = f64::from(step) * 0.41;
            let sine_sum: f64 = written[0].re
                + written
                    .iter()
                    .enumerate()
                    .skip(1)
                    .map(|(k, z)| (z * Complex::from_polar(1.0, k as f64 * phase)).im)
                    .sum::<f64>();
            let shifted = value(&turned, phase - std::f64::consts::FRAC_PI_2);
            // Rounding of a handful of terms of order one.
            assert!((sine_sum - shifted).abs() < 1e-14);
        }
    }

    #[test]
    fn amplitudes_become_peaks_and_the_mean_stays() {
        let rms = Convention { amplitude: AmplitudeUnit::Rms, ..Convention::default() };
        let peak_to_peak =
            Convention { amplitude: AmplitudeUnit::PeakToPeak, ..Convention::default() };
        let one = Complex::new(1.0, 0.0);
        assert_eq!(rms.harmonic(1, one).re, std::f64::consts::SQRT_2);
        assert_eq!(rms.harmonic(0, one).re, 1.0);
        assert_eq!(peak_to_peak.harmonic(3, one).re, 0.5);
        assert_eq!(peak_to_peak.deviation(3, 1.0), 0.5);
        assert_eq!(peak_to_peak.deviation(0, 1.0), 1.0);
    }
}
