//! A periodic motion, and what a record of it is.

use std::f64::consts::TAU;

use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

use super::{RecordNoise, Sampling, half_span, rms, sampled};
use crate::measurement::{
    Complex, Experiment, Harmonic, Record, RecordError, RecordStatement, ResponseKind,
};

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
        half_span(&self.input)
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
            bad_samples: None,
            clipping: None,
            range: None,
            unknown_input: Vec::new(),
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
        Self::read(&self.record(noise, sampling, run, rng), kind, self.omega_rad_s)
    }

    /// What a record of a periodic motion with this fundamental (rad/s) becomes as an experiment. The mean
    /// of a position says nothing and is left out.
    ///
    /// # Errors
    /// See [`RecordError`].
    pub fn read(
        record: &Record,
        kind: ResponseKind,
        omega_rad_s: f64,
    ) -> Result<Experiment, RecordError> {
        let stated = RecordStatement {
            kind,
            period_s: Some(TAU / omega_rad_s),
            settle_periods: Some(0),
            ..RecordStatement::default()
        };
        let (mut experiment, _) = record.experiment(stated)?;
        if kind != ResponseKind::Velocity {
            remove_mean(&mut experiment);
            experiment.bad_samples.iter_mut().for_each(|bad| remove_mean(&mut bad.mended));
        }
        Ok(experiment)
    }
}

fn remove_mean(experiment: &mut Experiment) {
    experiment.response.remove(0);
    for repeat in &mut experiment.repeats {
        repeat.response.remove(0);
    }
    let filled = experiment.clipping.iter_mut().filter_map(|clipping| clipping.filled.as_mut());
    filled.for_each(remove_mean);
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;

    use super::*;
    use crate::machines::records::multisine;

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
