//! The normalised square difference function r(L) of a signal, at whole lags and between them.

use rustfft::FftPlanner;

use crate::measurement::Complex;

/// Samples on each side of a point that its interpolation uses.
pub(in super::super) const INTERPOLATION_REACH: usize = 8;

/// Largest number of samples compared at one lag; bounds the cost on long records.
pub(super) const MOST_COMPARED: usize = 50_000;

/// Inverse golden ratio, (√5 − 1)/2.
const GOLDEN: f64 = 0.618_033_988_749_894_8;

/// 1 − r(L) at the integer lags 0 … n/2, by FFT.
pub(super) fn similarity(signal: &[f64]) -> Vec<f64> {
    let count = signal.len();
    let products = products(signal);
    let mut energy = 2.0 * signal.iter().map(|x| x * x).sum::<f64>();
    (0..=count / 2)
        .map(|lag| {
            if lag > 0 {
                energy -= signal[lag - 1].powi(2) + signal[count - lag].powi(2);
            }
            if energy > 0.0 { 2.0 * products[lag].re / energy } else { 0.0 }
        })
        .collect()
}

/// Σ x(n)·x(n+L) at the integer lags L = 0 … n − 1, in the real part, by FFT.
pub(in super::super) fn products(signal: &[f64]) -> Vec<Complex> {
    let padded = (2 * signal.len()).next_power_of_two();
    let mut spectrum = vec![Complex::ZERO; padded];
    for (value, x) in spectrum.iter_mut().zip(signal) {
        value.re = *x;
    }
    let mut planner = FftPlanner::new();
    planner.plan_fft_forward(padded).process(&mut spectrum);
    for value in &mut spectrum {
        *value = Complex::new(value.norm_sqr() / padded as f64, 0.0);
    }
    planner.plan_fft_inverse(padded).process(&mut spectrum);
    spectrum
}

/// r at a lag that may lie between samples, from at most `most` samples.
pub(super) fn difference(signal: &[f64], lag: f64, most: usize) -> f64 {
    // The sample before the point n + lag has the index n + whole.
    let whole = lag.floor() as usize;
    let weights = interpolation(lag.fract());
    let first = (INTERPOLATION_REACH - 1).saturating_sub(whole);
    let places = (signal.len()).saturating_sub(whole + INTERPOLATION_REACH + first);
    let (mut squares, mut energy) = (0.0, 0.0);
    let mut compare = |n: usize| {
        let around =
            &signal[n + whole + 1 - INTERPOLATION_REACH..n + whole + 1 + INTERPOLATION_REACH];
        let later: f64 = around.iter().zip(&weights).map(|(x, w)| x * w).sum();
        squares += (signal[n] - later).powi(2);
        energy += signal[n].powi(2) + later.powi(2);
    };
    if places <= most {
        (first..first + places).for_each(&mut compare);
    } else {
        // Multiples of the golden ratio are evenly spread and cannot alias with a period.
        for index in 0..most {
            let share = (index as f64 * GOLDEN).fract();
            compare(first + ((share * places as f64) as usize).min(places - 1));
        }
    }
    if energy > 0.0 { squares / energy } else { 1.0 }
}

/// Weights that interpolate a point `fraction` of a step after a sample, for the samples −7 … 8
/// counted from that sample: a sinc with a Blackman window, normalised to unit sum.
///
/// Amplitude and delay are accurate to −74 dB below two thirds of the Nyquist frequency. The more
/// common Lanczos window would shift a sine by several thousandths of a sample.
pub(super) fn interpolation(fraction: f64) -> [f64; 2 * INTERPOLATION_REACH] {
    use std::f64::consts::PI;
    let weights: [f64; 2 * INTERPOLATION_REACH] = std::array::from_fn(|index| {
        let distance = fraction - (index as f64 - (INTERPOLATION_REACH as f64 - 1.0));
        let sinc = if distance == 0.0 { 1.0 } else { (PI * distance).sin() / (PI * distance) };
        let angle = PI * distance / INTERPOLATION_REACH as f64;
        sinc * (0.42 + 0.5 * angle.cos() + 0.08 * (2.0 * angle).cos())
    });
    let sum: f64 = weights.iter().sum();
    weights.map(|weight| weight / sum)
}

/// The lag within ±1 sample of `lag` at which r is smallest, by golden-section search.
pub(super) fn minimum_near(signal: &[f64], lag: f64) -> f64 {
    const ACCURACY: f64 = 1e-7;
    let (mut low, mut high) = (lag - 1.0, lag + 1.0);
    let mut inner = [high - GOLDEN * (high - low), low + GOLDEN * (high - low)];
    let mut values = inner.map(|lag| difference(signal, lag, MOST_COMPARED));
    while high - low > ACCURACY {
        if values[0] < values[1] {
            high = inner[1];
            inner = [high - GOLDEN * (high - low), inner[0]];
            values = [difference(signal, inner[0], MOST_COMPARED), values[0]];
        } else {
            low = inner[0];
            inner = [inner[1], low + GOLDEN * (high - low)];
            values = [values[1], difference(signal, inner[1], MOST_COMPARED)];
        }
    }
    0.5 * (low + high)
}
