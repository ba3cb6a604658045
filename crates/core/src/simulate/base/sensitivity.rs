//! Derivatives of the harmonics by implicit differentiation of the switching times.
//!
//! A slide with friction σ from t_s to t_e ends where g = w(t_e) − w(t_s)·E − σ·(1 − E)/a = 0. Here
//! E = exp(−a(t_e − t_s)), and w is the steady response of 1/(s + a) to τ. A phase of rest ends
//! where τ meets the static level. Differentiating these equations gives the derivative of each
//! switching time as a linear function of the one before. Around the period they close to one
//! linear equation for the first. The cost is linear in the number of switches.

use crate::effects::{Axis, Wide};
use crate::measurement::Complex;
use crate::plant::{Actuator, Plant, Scalar};

use super::Settled;
use super::spectrum::{PhaseIntegrals, sliding_friction, weight};
use super::switching_times::{Motion, SwitchingTimes};
use crate::simulate::signal::excitation::Excitation;

/// A direction of differentiation: how fast parameters and torque lines change along it.
pub(crate) struct Direction {
    viscous_rate: f64,
    fc_plus: f64,
    fc_minus: f64,
    fs_plus: f64,
    fs_minus: f64,
    /// Change of the torque lines; empty if they do not change.
    lines: Vec<Complex>,
}

impl Direction {
    fn none() -> Self {
        Self {
            viscous_rate: 0.0,
            fc_plus: 0.0,
            fc_minus: 0.0,
            fs_plus: 0.0,
            fs_minus: 0.0,
            lines: Vec::new(),
        }
    }

    /// The direction in which the input changes by `deviation` (δU₀, δU₁ …).
    pub fn of_input(plant: &Plant, excitation: &Excitation, deviation: &[Complex]) -> Self {
        Self { lines: excitation.through(&plant.actuator, deviation), ..Self::none() }
    }

    /// Change of the friction while sliding.
    fn sliding(&self, motion: Motion) -> f64 {
        match motion {
            Motion::Forward => self.fc_plus,
            Motion::Backward => -self.fc_minus,
            Motion::Stuck => 0.0,
        }
    }

    /// Change of the torque at which a motion starts from rest.
    fn breakaway(&self, motion: Motion) -> f64 {
        match motion {
            Motion::Forward => self.fs_plus,
            Motion::Backward => -self.fs_minus,
            Motion::Stuck => 0.0,
        }
    }
}

/// Derivatives of the torque lines by the actuator's parameters (p; or ωₙ and ζ), in this order.
pub(crate) fn actuator_derivatives(
    actuator: &Actuator,
    excitation: &Excitation,
) -> Vec<Vec<Complex>> {
    let lines = |derivative: &dyn Fn(f64) -> Complex| {
        let input = excitation.input().iter().enumerate();
        input.map(|(l, u)| u * derivative(l as f64 * excitation.omega_rad_s())).collect()
    };
    match *actuator {
        Actuator::Direct => vec![],
        Actuator::FirstOrder { corner_rad_s: p } => {
            // A = p/(s + p), ∂A/∂p = s/(s + p)².
            let by_corner = |omega: f64| {
                let s_plus_p = Complex::new(p, omega);
                Complex::new(0.0, omega) / (s_plus_p * s_plus_p)
            };
            vec![lines(&by_corner)]
        }
        Actuator::SecondOrder { natural_frequency_rad_s: wn, damping_ratio: zeta } => {
            // A = ωₙ²/D, D = s² + 2ζωₙs + ωₙ².
            let denominator =
                |omega: f64| Complex::new(wn * wn - omega * omega, 2.0 * zeta * wn * omega);
            let by_frequency = |omega: f64| {
                let d = denominator(omega);
                (2.0 * wn * d - wn * wn * Complex::new(2.0 * wn, 2.0 * zeta * omega)) / (d * d)
            };
            let by_damping = |omega: f64| {
                let d = denominator(omega);
                -wn * wn * Complex::new(0.0, 2.0 * wn * omega) / (d * d)
            };
            vec![lines(&by_frequency), lines(&by_damping)]
        }
    }
}

/// One direction for each of a, Fc⁺, Fc⁻, Fs⁺, Fs⁻ and two parameters of the actuator (p; or ωₙ and
/// ζ), zero for those that it does not have.
pub(crate) fn parameter_directions(plant: &Plant, excitation: &Excitation) -> Vec<Direction> {
    let mut actuator = actuator_derivatives(&plant.actuator, excitation).into_iter();
    let mut by_actuator =
        || Direction { lines: actuator.next().unwrap_or_default(), ..Direction::none() };
    vec![
        Direction { viscous_rate: 1.0, ..Direction::none() },
        Direction { fc_plus: 1.0, ..Direction::none() },
        Direction { fc_minus: 1.0, ..Direction::none() },
        Direction { fs_plus: 1.0, ..Direction::none() },
        Direction { fs_minus: 1.0, ..Direction::none() },
        by_actuator(),
        by_actuator(),
    ]
}

/// Chain rule: derivatives of the harmonics by every lane of an axis. `by_number` are the
/// derivatives by the axis's numbers, in the order of [`parameter_directions`].
pub(crate) fn by_lane(
    axis: &Axis<Wide>,
    velocity: &[Complex],
    by_number: &[Vec<Complex>],
    lanes: usize,
) -> Vec<Vec<Complex>> {
    let levels = axis.levels();
    let plant = &axis.plant;
    let (first, second) = match plant.actuator {
        Actuator::Direct => (None, None),
        Actuator::FirstOrder { corner_rad_s } => (Some(corner_rad_s), None),
        Actuator::SecondOrder { natural_frequency_rad_s, damping_ratio } => {
            (Some(natural_frequency_rad_s), Some(damping_ratio))
        }
    };
    let friction = [levels.fc_plus, levels.fc_minus, levels.fs_plus, levels.fs_minus];
    let numbers = [Some(plant.viscous_rate_rad_s)]
        .into_iter()
        .chain(friction.map(Some))
        .chain([first, second]);
    let weighted: Vec<(Wide, &Vec<Complex>)> =
        numbers.zip(by_number).filter_map(|(number, row)| Some((number?, row))).collect();
    (0..lanes)
        .map(|lane| {
            // The response is proportional to K.
            let by_constant = plant.constant.lane(lane) / plant.constant.value();
            let mut row: Vec<Complex> = velocity.iter().map(|v| v * by_constant).collect();
            for (number, derivatives) in &weighted {
                let slope = number.lane(lane);
                if slope != 0.0 {
                    row.iter_mut().zip(*derivatives).for_each(|(sum, d)| *sum += d * slope);
                }
            }
            row
        })
        .collect()
}

/// Derivatives of V₀ … V_H, one row per direction.
pub(crate) fn along(
    settled: &Settled<'_>,
    velocity: &[Complex],
    directions: &[Direction],
) -> Vec<Vec<Complex>> {
    let Settled { plant, lines, orbit, .. } = settled;
    let zero = Complex::new(0.0, 0.0);
    if settled.rests() {
        return vec![vec![zero; velocity.len()]; directions.len()];
    }
    let omega = std::f64::consts::TAU / orbit.period_s;
    let a = plant.viscous_rate_rad_s;
    let integrals = PhaseIntegrals::new(orbit, velocity.len() - 1);
    let instants = Instants::new(plant, lines, orbit, directions);
    directions
        .iter()
        .enumerate()
        .map(|(d, direction)| {
            let mut friction = if direction.lines.is_empty() {
                vec![zero; velocity.len()]
            } else {
                settled.held_of(&direction.lines, velocity.len() - 1)
            };
            for (k, sum) in friction.iter_mut().enumerate() {
                *sum += direction.fc_plus * integrals.forward[k]
                    - direction.fc_minus * integrals.backward[k];
            }
            if orbit.switches() {
                instants.add_moves(plant, direction, d, &mut friction);
            }
            (0..velocity.len())
                .map(|k| {
                    let torque = direction.lines.get(k).copied().unwrap_or(zero);
                    let torque = if k == 0 { Complex::new(torque.re, 0.0) } else { torque };
                    let by_forces =
                        (torque - friction[k] * weight(k, orbit.period_s)) * plant.constant;
                    (by_forces - velocity[k] * direction.viscous_rate)
                        / Complex::new(a, k as f64 * omega)
                })
                .collect()
        })
        .collect()
}

/// The signals at each switching time.
struct Instants<'a> {
    orbit: &'a SwitchingTimes,
    torque: Vec<f64>,
    torque_rate: Vec<f64>,
    /// w: steady response of 1/(s + a) to the torque.
    steady: Vec<f64>,
    /// Change of τ and of w along each direction, indexed by direction and switching time.
    torque_change: Vec<Vec<f64>>,
    steady_change: Vec<Vec<f64>>,
}

impl<'a> Instants<'a> {
    fn new(
        plant: &Plant,
        lines: &[Complex],
        orbit: &'a SwitchingTimes,
        directions: &[Direction],
    ) -> Self {
        let omega = std::f64::consts::TAU / orbit.period_s;
        let count = if orbit.switches() { orbit.phases.len() } else { 0 };
        let mut instants = Self {
            orbit,
            torque: vec![0.0; count],
            torque_rate: vec![0.0; count],
            steady: vec![0.0; count],
            torque_change: vec![vec![0.0; count]; directions.len()],
            steady_change: vec![vec![0.0; count]; directions.len()],
        };
        // A change of the input may have more lines than the input.
        let most =
            directions.iter().map(|direction| direction.lines.len()).fold(lines.len(), usize::max);
        let through: Vec<Complex> = (0..most)
            .map(|l| 1.0 / Complex::new(plant.viscous_rate_rad_s, l as f64 * omega))
            .collect();
        for i in 0..count {
            let turn = Complex::from_polar(1.0, omega * orbit.phases[i].start_s);
            let mut at = Complex::new(1.0, 0.0);
            for (l, through) in through.iter().enumerate() {
                let torque = lines.get(l).copied().unwrap_or_default() * at;
                let steady = torque * through;
                instants.torque[i] += torque.re;
                instants.torque_rate[i] -= l as f64 * omega * torque.im;
                instants.steady[i] += steady.re;
                for (d, direction) in directions.iter().enumerate() {
                    if let Some(change) = direction.lines.get(l) {
                        let change = change * at;
                        instants.torque_change[d][i] += change.re;
                        instants.steady_change[d][i] += (change * through).re;
                    }
                    if direction.viscous_rate != 0.0 {
                        instants.steady_change[d][i] -=
                            direction.viscous_rate * (steady * through).re;
                    }
                }
                at *= turn;
            }
        }
        instants
    }

    /// The coefficients A and B of dtᵢ = A·dtᵢ₋₁ + B.
    fn link(&self, plant: &Plant, direction: &Direction, d: usize, i: usize) -> (f64, f64) {
        let previous = self.orbit.before(i);
        let (start, end, motion) = self.orbit.span(previous);
        let Some(friction) = sliding_friction(&plant.friction, motion) else {
            let level = direction.breakaway(self.orbit.phases[i].motion);
            return (0.0, (level - self.torque_change[d][i]) / self.torque_rate[i]);
        };
        let a = plant.viscous_rate_rad_s;
        let duration = end - start;
        let lost = -(-a * duration).exp_m1(); // 1 − E
        let kept = 1.0 - lost;
        let by_rate =
            self.steady[previous] * duration * kept + friction * (lost / a - duration * kept) / a;
        let change = self.steady_change[d][i]
            - self.steady_change[d][previous] * kept
            - direction.sliding(motion) * lost / a
            + direction.viscous_rate * by_rate;
        let slope = self.torque[i] - friction;
        (kept * (self.torque[previous] - friction) / slope, -change / slope)
    }

    /// Adds the contribution of the shifting switching times to ∫ f exp(−jkωt) dt: the jump of f
    /// there times the derivative of the time.
    fn add_moves(&self, plant: &Plant, direction: &Direction, d: usize, friction: &mut [Complex]) {
        let count = self.orbit.phases.len();
        let links: Vec<(f64, f64)> =
            (0..count).map(|i| self.link(plant, direction, d, i)).collect();
        let (product, offset) =
            links.iter().fold((1.0, 0.0), |(p, b), (a_i, b_i)| (p * a_i, b * a_i + b_i));
        // After a period the derivative of the last time must be the same again.
        let mut change = offset / (1.0 - product);
        let omega = std::f64::consts::TAU / self.orbit.period_s;
        for (i, (a_i, b_i)) in links.iter().enumerate() {
            change = a_i * change + b_i;
            let level = |phase: usize| {
                sliding_friction(&plant.friction, self.orbit.phases[phase].motion)
                    .unwrap_or(self.torque[i])
            };
            let jump = level(self.orbit.before(i)) - level(i);
            let turn = Complex::from_polar(1.0, -omega * self.orbit.phases[i].start_s);
            let mut at = Complex::new(jump * change, 0.0);
            for sum in friction.iter_mut() {
                *sum += at;
                at *= turn;
            }
        }
    }
}
