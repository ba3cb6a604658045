//! A trajectory in a closed position loop.
//!
//! The loop is solved in its periodic state, harmonic by harmonic: with the controller C the
//! command is Uₖ = C(jkω)·(Wₖ − Vₖ), with W the velocity of the set point, and V₀ = 0. The machine
//! is linearised for the corrections alone.

use rustfft::FftPlanner;

use super::records::PeriodicMotion;
use super::simulator::{Machine, Settings, SimulatorError, respond};
use crate::measurement::Complex;
use crate::plant::Plant;

/// Corrections of the command.
const CORRECTIONS: usize = 25;
/// Further corrections of its mean alone, until the axis does not drift.
const MEAN_CORRECTIONS: usize = 40;
/// Mean velocity of a position that is held, as a share of the largest line.
const HELD: f64 = 1e-9;
/// Instants at which the set point is sampled.
const INSTANTS: usize = 4096;

/// A position loop and its set point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PositionLoop {
    /// Fundamental of the set point, rad/s.
    pub omega_rad_s: f64,
    /// Its highest velocity, response units: there and back at this velocity, and at half of it.
    pub velocity: f64,
    /// Bandwidth of the loop, rad/s.
    pub bandwidth_rad_s: f64,
    /// Number of lines of the command.
    pub lines: usize,
    /// Highest harmonic of the response.
    pub harmonics: usize,
}

impl PositionLoop {
    /// The motion of a machine in the loop, its response a velocity; `None` if no constant part of
    /// the command holds the position.
    ///
    /// # Errors
    /// See [`SimulatorError`].
    pub fn motion(
        &self,
        machine: &Machine,
        run_share: f64,
        settings: &Settings,
    ) -> Result<Option<PeriodicMotion>, SimulatorError> {
        let omega_rad_s = self.omega_rad_s;
        let set_point = self.set_point();
        let harmonics = self.harmonics.max(self.lines);
        let velocity = |input: &[Complex]| {
            respond(machine, run_share, omega_rad_s, input, harmonics, settings)
        };
        let controller: Vec<Complex> =
            (0..=self.lines).map(|k| self.controller(machine, k)).collect();
        let gain = |k: usize| {
            let at = k as f64 * omega_rad_s;
            machine.plant.actuator.response(at) * machine.plant.mechanics_response(at)
        };
        let mut input: Vec<Complex> = (0..=self.lines)
            .map(|k| match k {
                0 => Complex::new(0.0, 0.0),
                _ => controller[k] * set_point[k] / (1.0 + controller[k] * gain(k)),
            })
            .collect();
        let mut response = velocity(&input)?;
        for _ in 0..CORRECTIONS {
            for k in 1..=self.lines {
                let wanted = controller[k] * (set_point[k] - response[k]);
                let step = (wanted - input[k]) / (1.0 + controller[k] * gain(k));
                input[k] += step;
            }
            input[0] -= response[0] / gain(0);
            response = velocity(&input)?;
        }
        let held = |response: &[Complex]| {
            let largest = response.iter().skip(1).map(|line| line.norm()).fold(0.0, f64::max);
            response[0].norm() <= HELD * largest
        };
        let mut slope = gain(0).re;
        for _ in 0..MEAN_CORRECTIONS {
            if held(&response) {
                response.truncate(self.harmonics + 1);
                return Ok(Some(PeriodicMotion {
                    omega_rad_s,
                    input,
                    response,
                    mean_velocity: 0.0,
                }));
            }
            let (before, step) = (response[0].re, -response[0].re / slope);
            input[0].re += step;
            response = velocity(&input)?;
            let secant = (response[0].re - before) / step;
            if secant.is_finite() && secant > 0.0 {
                slope = secant;
            }
        }
        Ok(None)
    }

    /// W₀ …: trapezia of velocity, forwards and backwards, fast and at half the speed.
    fn set_point(&self) -> Vec<Complex> {
        // Where in the period the velocity has which share of the highest one.
        const KNOTS: [(f64, f64); 17] = [
            (0.0, 0.0),
            (0.03, 1.0),
            (0.15, 1.0),
            (0.18, 0.0),
            (0.22, 0.0),
            (0.25, -1.0),
            (0.37, -1.0),
            (0.40, 0.0),
            (0.44, 0.0),
            (0.48, 0.5),
            (0.64, 0.5),
            (0.68, 0.0),
            (0.72, 0.0),
            (0.76, -0.5),
            (0.92, -0.5),
            (0.96, 0.0),
            (1.0, 0.0),
        ];
        let at = |time: f64| {
            let next = KNOTS.partition_point(|(knot, _)| *knot <= time).min(KNOTS.len() - 1);
            let ((from, first), (to, last)) = (KNOTS[next - 1], KNOTS[next]);
            self.velocity * (first + (last - first) * (time - from) / (to - from))
        };
        let instants = (0..INSTANTS).map(|n| Complex::new(at(n as f64 / INSTANTS as f64), 0.0));
        let mut values: Vec<Complex> = instants.collect();
        FftPlanner::new().plan_fft_forward(INSTANTS).process(&mut values);
        let factor = |k: usize| if k == 0 { 0.0 } else { 2.0 / INSTANTS as f64 };
        values.iter().take(self.lines + 1).enumerate().map(|(k, w)| w * factor(k)).collect()
    }

    /// C: proportional to the errors of position and velocity, so that without friction and
    /// actuator the loop has two poles at the bandwidth with a damping ratio of 0.7; from ten times
    /// the bandwidth on it falls. Input units per response unit, from an error of velocity.
    fn controller(&self, machine: &Machine, k: usize) -> Complex {
        let Plant { viscous_rate_rad_s, constant, .. } = machine.plant;
        let bandwidth = self.bandwidth_rad_s;
        let s = Complex::new(0.0, k.max(1) as f64 * self.omega_rad_s);
        let of_position = bandwidth * bandwidth / constant;
        let of_velocity = (1.4 * bandwidth - viscous_rate_rad_s).max(0.0) / constant;
        (of_velocity + of_position / s) / (1.0 + s / (10.0 * bandwidth))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::machines::simulator::Effect;
    use crate::plant::{Actuator, Friction};

    const LOOP: PositionLoop = PositionLoop {
        omega_rad_s: 1.0,
        velocity: 2.0,
        bandwidth_rad_s: 20.0,
        lines: 30,
        harmonics: 40,
    };

    fn plant(friction: Friction) -> Plant {
        let actuator = Actuator::FirstOrder { corner_rad_s: 60.0 };
        Plant { viscous_rate_rad_s: 10.0, constant: 10.0, actuator, friction }
    }

    fn motion(plant: Plant, effects: &[Effect]) -> PeriodicMotion {
        let machine = Machine { plant, effects };
        LOOP.motion(&machine, 0.0, &Settings::default()).unwrap().unwrap()
    }

    #[test]
    fn the_command_is_what_the_controller_makes_of_the_error() {
        let plant = plant(Friction::coulomb(0.3, 0.2));
        let motion = motion(plant, &[]);
        let machine = Machine::base(plant);
        let set_point = LOOP.set_point();
        let largest = motion.input.iter().map(|line| line.norm()).fold(0.0, f64::max);
        for (k, wanted) in set_point.iter().enumerate().skip(1) {
            let error = wanted - motion.response[k];
            let miss = (LOOP.controller(&machine, k) * error - motion.input[k]).norm();
            // The corrections converge by a factor of two or more each: friction is a small part
            // of the torque.
            assert!(miss < 1e-3 * largest, "{k}: {miss} of {largest}");
        }
    }

    #[test]
    fn a_position_that_is_held_does_not_drift_whatever_pulls_at_it() {
        let effects = [Effect::new("gain_asymmetry", [("gamma", 0.1)])];
        let motion = motion(plant(Friction::coulomb(0.4, 0.2)), &effects);
        let largest = motion.response.iter().map(|line| line.norm()).fold(0.0, f64::max);
        assert!(motion.response[0].norm() <= HELD * largest, "{}", motion.response[0]);
        assert!(motion.input[0].re.abs() > 1e-3, "what pulls needs a torque against it");
        assert_eq!((motion.input.len(), motion.response.len()), (31, 41));
    }

    #[test]
    fn the_axis_follows_its_set_point_which_has_no_mean() {
        let set_point = LOOP.set_point();
        assert_eq!(set_point[0].norm(), 0.0);
        let motion = motion(plant(Friction::coulomb(0.1, 0.1)), &[]);
        for (k, wanted) in set_point.iter().enumerate().skip(1).take(3) {
            // The loop is twenty times as fast as the fundamental.
            let miss = (motion.response[k] - wanted).norm();
            assert!(miss < 0.3 * wanted.norm(), "{k}: {miss} of {wanted}");
        }
    }
}
