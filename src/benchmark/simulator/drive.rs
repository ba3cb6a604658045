//! From the input to the torque behind the actuator, over one period.

use rustfft::FftPlanner;

use super::stepping::runge_kutta;
use crate::measurement::Complex;
use crate::plant::Actuator;

/// Torque τ(t) of one period, sampled at every half step.
pub(super) struct Drive {
    half_steps: Vec<f64>,
}

impl Drive {
    /// The torque once the actuator has forgotten how it started.
    pub(super) fn periodic(
        actuator: &Actuator,
        input: &[Complex],
        steps: usize,
        step_s: f64,
    ) -> Self {
        let half_steps = match *actuator {
            Actuator::Direct => sample(input, 2 * steps),
            Actuator::FirstOrder { corner_rad_s } => {
                let slope = |command: f64, [torque]: [f64; 1]| [corner_rad_s * (command - torque)];
                periodic_torque(slope, &sample(input, 4 * steps), step_s / 2.0)
            }
            Actuator::SecondOrder { natural_frequency_rad_s: wn, damping_ratio: zeta } => {
                let slope = |command: f64, [torque, rate]: [f64; 2]| {
                    [rate, wn * wn * (command - torque) - 2.0 * zeta * wn * rate]
                };
                periodic_torque(slope, &sample(input, 4 * steps), step_s / 2.0)
            }
        };
        Self { half_steps }
    }

    /// Steps a period.
    pub(super) fn steps(&self) -> usize {
        self.half_steps.len() / 2
    }

    /// Torque at the beginning, middle and end of a whole step.
    pub(super) fn whole_step(&self, step: usize) -> [f64; 3] {
        let first = 2 * step;
        let end = if first + 2 == self.half_steps.len() { 0 } else { first + 2 };
        [self.half_steps[first], self.half_steps[first + 1], self.half_steps[end]]
    }

    /// Torque at any time, in steps from the beginning of the period: the cubic through
    /// the four nearest samples.
    pub(super) fn at(&self, time_steps: f64) -> f64 {
        let count = self.half_steps.len();
        let position = 2.0 * time_steps;
        let whole = position.floor();
        let x = position - whole;
        // One more period, so that the neighbour before the first is no negative index.
        let index = whole as usize + count;
        let [before, here, next, after] =
            [index - 1, index, index + 1, index + 2].map(|i| self.half_steps[i % count]);
        here * (x * x - 1.0) * (x - 2.0) / 2.0
            - next * x * (x + 1.0) * (x - 2.0) / 2.0
            - before * x * (x - 1.0) * (x - 2.0) / 6.0
            + after * x * (x * x - 1.0) / 6.0
    }
}

/// u(t) = Re Σ Uₖ exp(jkωt) at `count` instants of the period, by one inverse transform.
fn sample(input: &[Complex], count: usize) -> Vec<f64> {
    let mut values = vec![Complex::new(0.0, 0.0); count];
    values.iter_mut().zip(input).for_each(|(value, line)| *value = *line);
    FftPlanner::new().plan_fft_inverse(count).process(&mut values);
    values.iter().map(|value| value.re).collect()
}

/// First state of a linear system x' = slope(command, x) in its periodic state, at
/// every other sample of the command.
///
/// One period takes x to Φx + b. Runge–Kutta gives b from x = 0, and Φ column by column
/// without a command; the periodic state is x = (1 − Φ)⁻¹ b.
fn periodic_torque<const N: usize>(
    slope: impl Fn(f64, [f64; N]) -> [f64; N],
    command: &[f64],
    step_s: f64,
) -> Vec<f64> {
    let (_, forced) = one_period(&slope, command, [0.0; N], step_s);
    let silence = vec![0.0; command.len()];
    let columns: [_; N] = std::array::from_fn(|column| {
        let mut unit = [0.0; N];
        unit[column] = 1.0;
        one_period(&slope, &silence, unit, step_s).1
    });
    let remaining = nalgebra::SMatrix::<f64, N, N>::from_fn(|row, column| {
        f64::from(u8::from(row == column)) - columns[column][row]
    });
    let forced = nalgebra::SVector::from(forced);
    let start = remaining.try_inverse().map_or(forced, |inverse| inverse * forced);
    one_period(&slope, command, start.into(), step_s).0
}

/// First state at the beginning of every step, and all states at the end of the period.
fn one_period<const N: usize>(
    slope: &impl Fn(f64, [f64; N]) -> [f64; N],
    command: &[f64],
    start: [f64; N],
    step_s: f64,
) -> (Vec<f64>, [f64; N]) {
    let mut state = start;
    let mut first_state = Vec::with_capacity(command.len() / 2);
    for i in (0..command.len()).step_by(2) {
        first_state.push(state[0]);
        let samples = [command[i], command[i + 1], command[(i + 2) % command.len()]];
        state = runge_kutta(slope, samples, state, step_s);
    }
    (first_state, state)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;

    #[test]
    fn the_input_is_sampled_as_the_sum_of_its_lines() {
        let input = [Complex::new(0.2, 0.0), Complex::new(1.0, -0.3), Complex::new(-0.4, 0.7)];
        let drive = Drive::periodic(&Actuator::Direct, &input, 256, 1.0);
        for time_steps in [0.0, 0.5, 17.0, 100.3, 255.999] {
            let angle = TAU * time_steps / 256.0;
            let expected: f64 =
                (0..3).map(|k| (input[k] * Complex::from_polar(1.0, k as f64 * angle)).re).sum();
            // Cubic interpolation: (2π·2/512)⁴·3/128 of the second harmonic is 9e-9.
            assert!((drive.at(time_steps) - expected).abs() < 1e-8, "{time_steps}");
        }
        assert_eq!(drive.whole_step(255)[2], drive.whole_step(0)[0]);
    }

    #[test]
    fn the_torque_is_the_actuators_steady_state() {
        let (omega, steps) = (3.0, 512);
        for actuator in [
            Actuator::FirstOrder { corner_rad_s: 2.0 },
            Actuator::SecondOrder { natural_frequency_rad_s: 5.0, damping_ratio: 0.05 },
        ] {
            let input = [Complex::new(0.1, 0.0), Complex::new(1.0, 0.5)];
            let drive = Drive::periodic(&actuator, &input, steps, TAU / omega / steps as f64);
            for step in [0, 1, 100, 511] {
                let phasor = Complex::from_polar(1.0, TAU * step as f64 / steps as f64);
                let expected = 0.1 + (actuator.response(omega) * input[1] * phasor).re;
                // Fourth order: (ωₙh)⁴/120 with h half a step is 1e-9 a radian.
                assert!((drive.whole_step(step)[0] - expected).abs() < 2e-9, "{actuator:?}");
            }
        }
    }
}
