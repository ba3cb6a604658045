//! Sampled records of periodic motions, with white noise on input and response.

use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use rustfft::FftPlanner;
use std::f64::consts::TAU;

use crate::measurement::{
    Complex, Experiment, Harmonic, Record, RecordError, RecordStatement, ResponseKind,
};

/// Points of a period per highest line at which the peak of a multisine is looked for.
const POINTS_PER_LINE: usize = 16;

/// An input and the exact response to it, both of the same period.
#[derive(Debug, Clone, PartialEq)]
pub struct PeriodicMotion {
    /// Fundamental, rad/s.
    pub omega_rad_s: f64,
    /// U₀, U₁ …, input units.
    pub input: Vec<Complex>,
    /// Y₀, Y₁ …, response units.
    pub response: Vec<Complex>,
    /// Mean velocity of a response that is a position, response units per second: beside its
    /// periodic motion it moves on at this rate. 0 for other responses.
    pub mean_velocity: f64,
}

/// How a motion is sampled.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Sampling {
    /// Samples in a period; more than twice the number of lines of input and response.
    pub samples: usize,
    /// Number of periods.
    pub periods: usize,
}

/// Standard deviations of the white noise of a record, and what rounding adds to it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RecordNoise {
    /// Of every sample of the input, input units.
    pub input: f64,
    /// Of every sample of the response, response units.
    pub response: f64,
    /// Resolution to which a sensor rounds the response, noise and all, response units; 0 if it does
    /// not round.
    pub step: f64,
}

impl RecordNoise {
    /// All of it `factor` times as large.
    pub fn times(self, factor: f64) -> Self {
        let Self { input, response, step } = self;
        Self { input: factor * input, response: factor * response, step: factor * step }
    }
}

impl RecordNoise {
    /// Standard deviation of every sample of the response, with that of rounding: a step is uniform
    /// over its width.
    fn response_std(&self) -> f64 {
        self.response.hypot(self.step / 12.0_f64.sqrt())
    }
}

impl Sampling {
    /// Lines of an input that a converter holds from each sample to the next, without their images:
    /// sin(x)/x·exp(−jx) of those of its samples, x = πk/N.
    pub fn held(self, lines: &[Complex]) -> Vec<Complex> {
        lines.iter().enumerate().map(|(k, line)| line * self.hold(k)).collect()
    }

    fn hold(self, k: usize) -> Complex {
        let x = 0.5 * TAU * k as f64 / self.samples as f64;
        Complex::from_polar(if k == 0 { 1.0 } else { x.sin() / x }, -x)
    }

    /// Standard deviation of re and im of a harmonic, averaged over all periods, from that of a
    /// sample: √(2/(number of samples)) of it.
    fn harmonic_std(self, sample_std: f64) -> f64 {
        sample_std * (2.0 / (self.samples * self.periods) as f64).sqrt()
    }
}

/// Lines 1 to `count` of equal size and random phase, half the peak-to-peak value of whose sum is
/// `magnitude` (input units).
pub fn multisine(count: usize, magnitude: f64, rng: &mut ChaCha8Rng) -> Vec<Complex> {
    let phases = (0..count).map(|_| Complex::from_polar(1.0, rng.random_range(0.0..TAU)));
    with_magnitude(phases, magnitude)
}

/// Lines 1 to `count` of equal size whose phases −πk²/`count` make a sweep of their sum (M. R. Schroeder
/// 1970, doi:10.1109/TIT.1970.1054411), half the peak-to-peak value of which is `magnitude` (input
/// units).
pub fn sweep(count: usize, magnitude: f64) -> Vec<Complex> {
    let phase = |k: usize| -0.5 * TAU * (k * k) as f64 / count as f64;
    with_magnitude((1..=count).map(|k| Complex::from_polar(1.0, phase(k))), magnitude)
}

fn with_magnitude(lines: impl Iterator<Item = Complex>, magnitude: f64) -> Vec<Complex> {
    let mut lines: Vec<Complex> = std::iter::once(Complex::new(0.0, 0.0)).chain(lines).collect();
    let count = lines.len() - 1;
    let values = sampled(&lines, (POINTS_PER_LINE * count).next_power_of_two());
    let highest = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let lowest = values.iter().copied().fold(f64::INFINITY, f64::min);
    let factor = 2.0 * magnitude / (highest - lowest);
    lines.iter_mut().for_each(|line| *line *= factor);
    lines
}

impl PeriodicMotion {
    /// The same motion with its velocity as a position: Yₖ = Vₖ/(jkω), Y₀ = 0, beside which it moves
    /// on with the mean of the velocity.
    pub fn converted_to_position(mut self) -> Self {
        self.mean_velocity = self.response[0].re;
        for (k, value) in self.response.iter_mut().enumerate() {
            *value /= Complex::new(0.0, k.max(1) as f64 * self.omega_rad_s);
        }
        self.response[0] = Complex::new(0.0, 0.0);
        self
    }

    /// The same motion with the samples of its input that a converter holds.
    pub fn read_before_holding(&self, sampling: Sampling) -> Self {
        let lines = self.input.iter().enumerate();
        Self { input: lines.map(|(k, line)| line / sampling.hold(k)).collect(), ..self.clone() }
    }

    /// Root mean square of the input without its mean, input units.
    pub fn input_rms(&self) -> f64 {
        rms(&self.input)
    }

    /// Root mean square of the response without its mean, response units.
    pub fn response_rms(&self) -> f64 {
        rms(&self.response)
    }

    /// Half the peak-to-peak value of the input, input units.
    fn magnitude(&self) -> f64 {
        let values = sampled(&self.input, (POINTS_PER_LINE * self.input.len()).next_power_of_two());
        let highest = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        0.5 * (highest - values.iter().copied().fold(f64::INFINITY, f64::min))
    }

    /// The exact response up to a harmonic. Its standard deviations are those of the noise of a
    /// record; that of the input counts as the linear machine passes it on, by `gain` of a harmonic
    /// (response units per input unit).
    pub fn exact(
        &self,
        kind: ResponseKind,
        highest: usize,
        noise: &RecordNoise,
        sampling: Sampling,
        run: f64,
        gain: impl Fn(usize) -> f64,
    ) -> Experiment {
        let [of_input, of_response] =
            [noise.input, noise.response_std()].map(|std| sampling.harmonic_std(std));
        let harmonic = |(order, value): (usize, &Complex)| {
            let std = of_response.hypot(gain(order) * of_input);
            Harmonic { order, value: *value, std: Some(std) }
        };
        let first = usize::from(kind != ResponseKind::Velocity);
        let response = self.response.iter().enumerate().take(highest + 1).skip(first);
        Experiment {
            magnitude: self.magnitude(),
            omega_rad_s: self.omega_rad_s,
            input: self.input.clone(),
            input_mean_measured: true,
            mean_velocity: self.mean_velocity,
            rounding_std: 0.0,
            open_samples: None,
            response: response.map(harmonic).collect(),
            run: Some(run),
            repeats: Vec::new(),
            from_record: true,
        }
    }

    /// The motion as it is recorded with noise, over all periods.
    pub fn record(
        &self,
        noise: &RecordNoise,
        sampling: Sampling,
        run: f64,
        rng: &mut ChaCha8Rng,
    ) -> Record {
        let Sampling { samples, periods } = sampling;
        let step_s = TAU / self.omega_rad_s / samples as f64;
        let mut noisy = |lines: &[Complex], per_sample: f64, std: f64, step: f64| -> Vec<f64> {
            let period = sampled(lines, samples);
            let all = period.iter().cycle().take(samples * periods).enumerate();
            all.map(|(n, value)| {
                let normal: f64 = StandardNormal.sample(rng);
                let value = value + per_sample * n as f64 + std * normal;
                if step > 0.0 { (value / step).round() * step } else { value }
            })
            .collect()
        };
        Record {
            input: noisy(&self.input, 0.0, noise.input, 0.0),
            output: noisy(&self.response, self.mean_velocity * step_s, noise.response, noise.step),
            time_s: (0..samples * periods).map(|n| n as f64 * step_s).collect(),
            run: Some(run),
        }
    }

    /// What a record with noise becomes as an experiment.
    ///
    /// # Errors
    /// See [`RecordError`].
    pub fn recorded(
        &self,
        kind: ResponseKind,
        noise: &RecordNoise,
        sampling: Sampling,
        run: f64,
        rng: &mut ChaCha8Rng,
    ) -> Result<Experiment, RecordError> {
        let record = self.record(noise, sampling, run, rng);
        let stated = RecordStatement {
            kind,
            period_s: Some(TAU / self.omega_rad_s),
            settle_periods: Some(0),
            ..RecordStatement::default()
        };
        let (mut experiment, _) = record.experiment(stated)?;
        if kind != ResponseKind::Velocity {
            // The mean of a position says nothing.
            experiment.response.remove(0);
            for repeat in &mut experiment.repeats {
                repeat.response.remove(0);
            }
        }
        Ok(experiment)
    }
}

/// Root mean square of a signal without its mean.
fn rms(lines: &[Complex]) -> f64 {
    (0.5 * lines.iter().skip(1).map(|line| line.norm_sqr()).sum::<f64>()).sqrt()
}

/// Σ Re Lₖ exp(jkωt) at `count` instants of the period.
pub(super) fn sampled(lines: &[Complex], count: usize) -> Vec<f64> {
    let mut values = vec![Complex::new(0.0, 0.0); count];
    values.iter_mut().zip(lines).for_each(|(value, line)| *value = *line);
    FftPlanner::new().plan_fft_inverse(count).process(&mut values);
    values.iter().map(|value| value.re).collect()
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;

    use super::*;

    const SAMPLING: Sampling = Sampling { samples: 256, periods: 4 };

    fn rng() -> ChaCha8Rng {
        ChaCha8Rng::seed_from_u64(1)
    }

    fn gain(k: usize) -> f64 {
        3.0 / Complex::new(1.0, 0.2 * k as f64).norm()
    }

    /// An axis of first order, without friction, under a multisine of 20 lines.
    fn motion() -> PeriodicMotion {
        let input = multisine(20, 2.0, &mut rng());
        let gain = |k: usize| 3.0 / Complex::new(1.0, 0.2 * k as f64);
        let response = input.iter().enumerate().map(|(k, line)| gain(k) * line).collect();
        PeriodicMotion { omega_rad_s: 2.5, input, response, mean_velocity: 0.0 }
    }

    #[test]
    fn a_multisine_has_lines_of_one_size_and_the_magnitude_that_is_asked_for() {
        let motion = motion();
        let sizes: Vec<f64> = motion.input[1..].iter().map(|line| line.norm()).collect();
        assert_eq!((sizes.len(), motion.input[0].norm()), (20, 0.0));
        // Rounding of a few operations.
        assert!(sizes.iter().all(|size| (size / sizes[0] - 1.0).abs() < 1e-12));
        let finely = sampled(&motion.input, 1 << 14);
        let highest = finely.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let lowest = finely.iter().copied().fold(f64::INFINITY, f64::min);
        // Between 16 points of a line its cosine falls by (π/16)²/2 = 2 % at most.
        let magnitude = 0.5 * (highest - lowest);
        assert!((2.0..2.04).contains(&magnitude), "{magnitude}");
        assert!((motion.input_rms() / (10.0_f64.sqrt() * sizes[0]) - 1.0).abs() < 1e-12);
        assert_ne!(multisine(20, 2.0, &mut ChaCha8Rng::seed_from_u64(2)), motion.input);
    }

    #[test]
    fn a_record_has_the_lines_of_its_motion_and_scatters_as_its_exact_response_states() {
        let motion = motion();
        let noise = RecordNoise { input: 0.0, response: 0.05, step: 0.0 };
        let exact = motion.exact(ResponseKind::Velocity, 20, &noise, SAMPLING, 3.0, gain);
        let found =
            motion.recorded(ResponseKind::Velocity, &noise, SAMPLING, 3.0, &mut rng()).unwrap();
        assert_eq!((found.repeats.len(), found.run, exact.run), (4, Some(3.0), Some(3.0)));
        assert!((found.omega_rad_s / 2.5 - 1.0).abs() < 1e-9);
        let mut deviations = Vec::new();
        for (found, exact) in found.response.iter().zip(&exact.response).skip(1) {
            let difference = (found.value - exact.value) / exact.std.unwrap();
            deviations.extend([difference.re, difference.im]);
        }
        assert!(deviations.len() >= 20, "{}", deviations.len());
        let count = deviations.len() as f64;
        let rms = (deviations.iter().map(|x| x * x).sum::<f64>() / count).sqrt();
        // The rms of n normal values has a relative standard error of 1/√(2n); 4 times that.
        assert!((rms - 1.0).abs() < 4.0 / (2.0 * count).sqrt(), "{rms}");
        for (found, line) in found.input.iter().zip(&motion.input) {
            // Rounding of an FFT there and back.
            assert!((found - line).norm() < 1e-12 * 2.0);
        }
    }

    #[test]
    fn noise_of_the_input_counts_as_the_machine_passes_it_on() {
        let motion = motion();
        let of = |input: f64, response: f64| {
            let noise = RecordNoise { input, response, step: 0.0 };
            motion.exact(ResponseKind::Velocity, 30, &noise, SAMPLING, 0.0, gain)
        };
        let std = |experiment: &Experiment, k: usize| experiment.harmonic(k).unwrap().std.unwrap();
        let (response, both) = (of(0.0, 0.1), of(0.1, 0.1));
        let expected = std(&response, 5) * (1.0 + gain(5).powi(2)).sqrt();
        assert!((std(&both, 5) / expected - 1.0).abs() < 1e-12);
        // White noise of N samples is in each of re and im √(2/N) of it.
        assert!((std(&response, 5) / (0.1 * (2.0_f64 / 1024.0).sqrt()) - 1.0).abs() < 1e-12);
        assert!(both.harmonic(25).is_none(), "there is no such harmonic");
    }

    #[test]
    fn a_position_is_the_integral_of_the_velocity_without_a_mean() {
        let velocity = motion();
        let position = velocity.clone().converted_to_position();
        let expected = velocity.response[4] / Complex::new(0.0, 10.0);
        assert!((position.response[4] - expected).norm() < 1e-15 * 3.0);
        let noise = RecordNoise { input: 0.1, response: 1e-3, step: 0.0 };
        let kind = ResponseKind::Position;
        let exact = position.exact(kind, 20, &noise, SAMPLING, 0.0, gain);
        let found = position.recorded(kind, &noise, SAMPLING, 0.0, &mut rng()).unwrap();
        for experiment in [&exact, &found] {
            assert_eq!(experiment.response[0].order, 1);
        }
        assert!(found.repeats.iter().all(|repeat| !repeat.input.is_empty()));
    }

    #[test]
    fn a_held_input_is_read_as_the_samples_that_are_held() {
        let motion = motion();
        let held = PeriodicMotion { input: SAMPLING.held(&motion.input), ..motion.clone() };
        let read = held.read_before_holding(SAMPLING);
        for (read, line) in read.input.iter().zip(&motion.input) {
            assert!((read - line).norm() < 1e-14 * 2.0);
        }
        // Half a sample late: line 20 of 256 samples by 20/256 of half a turn.
        let angle = (held.input[20] / motion.input[20]).arg();
        assert!((angle + 0.5 * TAU * 20.0 / 256.0).abs() < 1e-12, "{angle}");
    }

    #[test]
    fn a_position_moves_on_with_the_mean_velocity_and_has_the_same_harmonics() {
        let mut velocity = motion();
        velocity.response[0] = Complex::new(0.7, 0.0);
        let position = velocity.converted_to_position();
        let noise = RecordNoise { input: 0.0, response: 1e-6, step: 0.0 };
        let kind = ResponseKind::Position;
        let found = position.recorded(kind, &noise, SAMPLING, 0.0, &mut rng()).unwrap();
        // The standard error of a mean of 256 differences over three periods of 2π/2.5 s.
        let error = 1e-6 * (2.0_f64 / 256.0).sqrt() / 3.0 * 2.5 / TAU;
        assert!((found.mean_velocity - 0.7).abs() < 4.0 * error);
        for (found, expected) in found.response.iter().zip(&position.response[1..]) {
            // Noise, as of a mean of four periods.
            assert!((found.value - expected).norm() < 5.0 * 1e-6 * (2.0_f64 / 1024.0).sqrt());
        }
    }
}
