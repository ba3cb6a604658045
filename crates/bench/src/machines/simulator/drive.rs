//! Torque behind the actuator, computed from the command over one period.

use super::chain::Command;
use super::stepping::runge_kutta;
use crate::plant::Actuator;

/// Fewest steps between two kinks. They give five samples; the cubic interpolation needs four.
const MIN_STEPS: usize = 2;

/// Torque τ(t) over one period, divided into segments at the kinks of the command.
pub(super) struct Drive {
    segments: Vec<Segment>,
}

/// A stretch of time without a kink, divided into equal steps.
pub(super) struct Segment {
    from_s: f64,
    step_s: f64,
    /// Torque at every half step, both ends included.
    half_steps: Vec<f64>,
}

impl Drive {
    /// The torque in the periodic state of the actuator; no step is longer than `longest_step_s`.
    pub(super) fn periodic(actuator: &Actuator, command: &Command, longest_step_s: f64) -> Self {
        let commands = sampled(actuator, command, longest_step_s);
        let segments = match *actuator {
            Actuator::Direct => commands,
            Actuator::FirstOrder { corner_rad_s } => {
                periodic_torque(first_order(corner_rad_s), &commands)
            }
            Actuator::SecondOrder { natural_frequency_rad_s: wn, damping_ratio: zeta } => {
                periodic_torque(second_order(wn, zeta), &commands)
            }
        };
        Self { segments }
    }

    /// The torque from given initial values of τ and τ'.
    pub(super) fn from_start(
        actuator: &Actuator,
        command: &Command,
        longest_step_s: f64,
        [torque, rate]: [f64; 2],
    ) -> Self {
        let commands = sampled(actuator, command, longest_step_s);
        let segments = match *actuator {
            Actuator::Direct => commands,
            Actuator::FirstOrder { corner_rad_s } => {
                one_period(&first_order(corner_rad_s), &commands, 1.0, [torque]).0
            }
            Actuator::SecondOrder { natural_frequency_rad_s: wn, damping_ratio: zeta } => {
                one_period(&second_order(wn, zeta), &commands, 1.0, [torque, rate]).0
            }
        };
        Self { segments }
    }

    pub(super) fn segments(&self) -> &[Segment] {
        &self.segments
    }

    /// Torque at the beginning of the period.
    pub(super) fn first(&self) -> f64 {
        self.segments[0].half_steps[0]
    }

    /// Lowest and highest torque at a sample.
    pub(super) fn range(&self) -> (f64, f64) {
        let torques = self.segments.iter().flat_map(|segment| &segment.half_steps);
        torques.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), torque| {
            (low.min(*torque), high.max(*torque))
        })
    }
}

/// The command in steps no longer than `longest_step_s`, sampled at every half step, or at every
/// quarter step if there is an actuator to integrate.
fn sampled(actuator: &Actuator, command: &Command, longest_step_s: f64) -> Vec<Segment> {
    let samples_a_step = if *actuator == Actuator::Direct { 2 } else { 4 };
    let sampled = command.stretches().iter().map(|stretch| {
        let length_s = stretch.to_s - stretch.from_s;
        // Rounding errors must not add a step: the number of steps per period is a power of two,
        // which the FFT in `Command::sampled` needs.
        let steps = ((length_s / longest_step_s - 1e-9).ceil() as usize).max(MIN_STEPS);
        Segment {
            from_s: stretch.from_s,
            step_s: length_s / steps as f64,
            half_steps: command.sampled(stretch, samples_a_step * steps),
        }
    });
    sampled.collect()
}

fn first_order(corner_rad_s: f64) -> impl Fn(f64, [f64; 1]) -> [f64; 1] {
    move |command, [torque]| [corner_rad_s * (command - torque)]
}

fn second_order(wn: f64, zeta: f64) -> impl Fn(f64, [f64; 2]) -> [f64; 2] {
    move |command, [torque, rate]| [rate, wn * wn * (command - torque) - 2.0 * zeta * wn * rate]
}

impl Segment {
    pub(super) fn steps(&self) -> usize {
        self.half_steps.len() / 2
    }

    pub(super) fn step_s(&self) -> f64 {
        self.step_s
    }

    /// Time at a position in the segment, given in steps from its beginning, s.
    pub(super) fn time_s(&self, steps: f64) -> f64 {
        self.from_s + steps * self.step_s
    }

    /// Torque at the beginning, middle and end of a whole step.
    #[inline]
    pub(super) fn whole_step(&self, step: usize) -> [f64; 3] {
        let first = 2 * step;
        [self.half_steps[first], self.half_steps[first + 1], self.half_steps[first + 2]]
    }

    /// Torque at a position in the segment, given in steps from its beginning, by cubic
    /// interpolation through four neighbouring samples.
    pub(super) fn at(&self, steps: f64) -> f64 {
        let position = 2.0 * steps;
        let first = (position.floor() as usize).saturating_sub(1).min(self.half_steps.len() - 4);
        let [before, here, next, after]: [f64; 4] =
            std::array::from_fn(|i| self.half_steps[first + i]);
        let x = position - (first + 1) as f64;
        here * (x * x - 1.0) * (x - 2.0) / 2.0
            - next * x * (x + 1.0) * (x - 2.0) / 2.0
            - before * x * (x - 1.0) * (x - 2.0) / 6.0
            + after * x * (x * x - 1.0) / 6.0
    }
}

/// First state of the linear system x' = slope(command, x) in its periodic motion, at every
/// other sample of the command.
///
/// One period maps x to Φx + b. Integration from x = 0 gives b, and integration of unit vectors
/// without a command gives the columns of Φ. The periodic state is x = (1 − Φ)⁻¹ b.
fn periodic_torque<const N: usize>(
    slope: impl Fn(f64, [f64; N]) -> [f64; N],
    commands: &[Segment],
) -> Vec<Segment> {
    let (_, forced) = one_period(&slope, commands, 1.0, [0.0; N]);
    let columns: [_; N] = std::array::from_fn(|column| {
        let mut unit = [0.0; N];
        unit[column] = 1.0;
        one_period(&slope, commands, 0.0, unit).1
    });
    let remaining = nalgebra::SMatrix::<f64, N, N>::from_fn(|row, column| {
        f64::from(u8::from(row == column)) - columns[column][row]
    });
    let forced = nalgebra::SVector::from(forced);
    let start = remaining.try_inverse().map_or(forced, |inverse| inverse * forced);
    one_period(&slope, commands, 1.0, start.into()).0
}

/// Integrates over one period with the command multiplied by `gain`; the command is sampled at
/// every quarter step. Returns the first state at every half step, and all states at the end.
fn one_period<const N: usize>(
    slope: &impl Fn(f64, [f64; N]) -> [f64; N],
    commands: &[Segment],
    gain: f64,
    start: [f64; N],
) -> (Vec<Segment>, [f64; N]) {
    let mut state = start;
    let mut segments = Vec::with_capacity(commands.len());
    for command in commands {
        let samples = &command.half_steps;
        let mut half_steps = Vec::with_capacity(samples.len() / 2 + 1);
        half_steps.push(state[0]);
        for i in (0..samples.len() - 1).step_by(2) {
            let samples = [gain * samples[i], gain * samples[i + 1], gain * samples[i + 2]];
            state = runge_kutta(slope, samples, state, 0.5 * command.step_s);
            half_steps.push(state[0]);
        }
        segments.push(Segment { half_steps, ..*command });
    }
    (segments, state)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;
    use crate::machines::simulator::effect::Effect;
    use crate::measurement::Complex;

    #[test]
    fn the_input_is_sampled_as_the_sum_of_its_lines() {
        let input = [Complex::new(0.2, 0.0), Complex::new(1.0, -0.3), Complex::new(-0.4, 0.7)];
        // The FFT and direct summation must agree.
        for effects in [vec![], vec![Effect::GainAsymmetry { gamma: 0.0 }]] {
            let command = Command::periodic(&effects, TAU / 256.0, &input);
            let drive = Drive::periodic(&Actuator::Direct, &command, 1.0);
            let [segment] = drive.segments() else { panic!("an input without kinks is cut") };
            for time_s in [0.0, 0.5, 17.0, 100.3, 255.999] {
                let angle = TAU * time_s / 256.0;
                let expected: f64 = (0..3)
                    .map(|k| (input[k] * Complex::from_polar(1.0, k as f64 * angle)).re)
                    .sum();
                // The error of cubic interpolation of the second harmonic is
                // (2π·2/512)⁴·3/128 = 9e-9; at the ends it is four times that.
                assert!((segment.at(time_s) - expected).abs() < 4e-8, "{time_s}");
            }
            assert_eq!(segment.whole_step(255)[2], segment.whole_step(0)[0]);
        }
    }

    #[test]
    fn the_torque_is_the_actuators_steady_state() {
        let omega = 3.0;
        for actuator in [
            Actuator::FirstOrder { corner_rad_s: 2.0 },
            Actuator::SecondOrder { natural_frequency_rad_s: 5.0, damping_ratio: 0.05 },
        ] {
            let input = [Complex::new(0.1, 0.0), Complex::new(1.0, 0.5)];
            let command = Command::periodic(&[], omega, &input);
            let drive = Drive::periodic(&actuator, &command, TAU / omega / 512.0);
            for step in [0, 1, 100, 511] {
                let phasor = Complex::from_polar(1.0, TAU * step as f64 / 512.0);
                let expected = 0.1 + (actuator.response(omega) * input[1] * phasor).re;
                // The fourth-order error (ωₙh)⁴/120, with h half a step, is 1e-9 per radian.
                let found = drive.segments()[0].whole_step(step)[0];
                assert!((found - expected).abs() < 2e-9, "{actuator:?}");
            }
        }
    }
}
