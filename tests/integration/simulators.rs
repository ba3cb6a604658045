//! The two simulators against each other: they share no code.

use std::f64::consts::TAU;

use rand::{Rng, RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use servoscope_bench::machines::draw::draw;
use servoscope_bench::machines::simulator::{self, Effect, Machine, Settings, SimulatorError};
use servoscope_core::effects::{self, ActiveEffect};
use servoscope_core::measurement::Complex;
use servoscope_core::plant::{Friction, Plant};
use servoscope_core::simulate::{Excitation, NoResponse, respond};

/// Machines of each order, with the static level raised and not.
const MACHINES: u64 = 40;

/// A machine and its input.
#[derive(Debug)]
pub struct Case {
    pub plant: Plant,
    pub effects: Vec<Effect>,
    pub run_share: f64,
    pub omega_rad_s: f64,
    pub input: Vec<Complex>,
}

/// What both simulators make of a case.
pub struct Both {
    /// The exact one's harmonics.
    pub exact: Result<Vec<Complex>, NoResponse>,
    /// The stepper's.
    pub stepped: Result<Vec<Complex>, SimulatorError>,
}

impl Case {
    /// Its effects, as the library knows them.
    pub fn active(&self) -> Vec<ActiveEffect> {
        let active = |effect: &Effect| {
            let values = effect.parameters().iter().map(|(_, value)| *value).collect();
            ActiveEffect::new(effects::find(effect.id()).unwrap(), values).unwrap()
        };
        self.effects.iter().map(active).collect()
    }

    /// Its input.
    pub fn excitation(&self) -> Excitation {
        Excitation::new(self.omega_rad_s, self.input.clone()).at_run_share(self.run_share)
    }

    /// Harmonics from the exact one.
    pub fn respond(&self, highest: usize) -> Result<Vec<Complex>, NoResponse> {
        respond(&self.plant, &self.active(), &self.excitation(), highest)
    }

    /// Harmonics 0 to 9, or to the highest line of the input, from both simulators.
    pub fn simulate(&self, settings: &Settings) -> Both {
        let highest = 9.max(self.input.len() - 1);
        let machine = Machine { plant: self.plant, effects: &self.effects };
        let (share, omega) = (self.run_share, self.omega_rad_s);
        Both {
            exact: self.respond(highest),
            stepped: simulator::respond(&machine, share, omega, &self.input, highest, settings),
        }
    }

    /// Largest difference between the simulators, as a share of the largest harmonic.
    pub fn difference(&self) -> f64 {
        // Steps so short that no visit to v = 0 hides within one.
        let settings = Settings { steps_per_input_line: 256, ..Settings::default() };
        let Both { exact, stepped } = self.simulate(&settings);
        let exact = exact.unwrap_or_else(|error| panic!("{self:?}: {error}"));
        let stepped = stepped.unwrap_or_else(|error| panic!("{self:?}: {error}"));
        let largest = stepped.iter().map(|v| v.norm()).fold(0.0, f64::max);
        let difference = largest_difference(&exact, &stepped);
        if difference > 0.0 { difference / largest } else { 0.0 }
    }
}

/// Largest difference of two lists of harmonics.
pub fn largest_difference(left: &[Complex], right: &[Complex]) -> f64 {
    left.iter().zip(right).map(|(l, r)| (l - r).norm()).fold(0.0, f64::max)
}

pub fn log_uniform(low: f64, high: f64, rng: &mut impl Rng) -> f64 {
    low * (high / low).powf(rng.random_range(0.0..=1.0))
}

fn machine(order: u8, raised: bool, seed: u64, rng: &mut impl Rng) -> Case {
    let plant = draw(order, seed).plant;
    let Friction { fc_plus, fc_minus, .. } = plant.friction;
    let raised = raised.then(|| {
        Effect::new(
            "static_friction",
            [
                ("fs_plus", fc_plus * rng.random_range(1.0..=1.8)),
                ("fs_minus", fc_minus * rng.random_range(1.0..=1.8)),
            ],
        )
    });
    let effects = raised.into_iter().collect();
    Case { plant, effects, run_share: 0.0, omega_rad_s: 0.0, input: Vec::new() }
}

/// A torque amplitude of 0.8 to 12 Coulomb levels: from no motion at all to sliding.
fn cosine(order: u8, raised: bool, seed: u64) -> Case {
    let rng = &mut ChaCha8Rng::seed_from_u64(seed);
    let case = machine(order, raised, seed, rng);
    let omega_rad_s = case.plant.viscous_rate_rad_s * log_uniform(0.05, 20.0, rng);
    let torque = case.plant.friction.fc_plus * log_uniform(0.8, 12.0, rng);
    let magnitude = torque / case.plant.actuator.response(omega_rad_s).norm();
    let input = vec![Complex::new(0.0, 0.0), Complex::new(magnitude, 0.0)];
    Case { omega_rad_s, input, ..case }
}

/// Lines of random sizes and phases up to 0.3 … 10 a, with a mean.
fn general(order: u8, raised: bool, seed: u64, lines: usize) -> Case {
    let rng = &mut ChaCha8Rng::seed_from_u64(seed);
    let case = machine(order, raised, seed, rng);
    let omega_rad_s = case.plant.viscous_rate_rad_s * log_uniform(0.3, 10.0, rng) / lines as f64;
    let mut input = vec![Complex::new(rng.random_range(-0.3..=0.3), 0.0)];
    input.extend(
        (0..lines)
            .map(|_| Complex::from_polar(rng.random_range(0.2..=1.0), rng.random_range(0.0..TAU))),
    );
    let rms = input.iter().map(|u| 0.5 * u.norm_sqr()).sum::<f64>().sqrt();
    let factor = case.plant.friction.fc_plus * log_uniform(0.6, 6.0, rng) / rms;
    input.iter_mut().for_each(|u| *u *= factor);
    Case { omega_rad_s, input, ..case }
}

fn worst(make: impl Fn(u8, bool, u64) -> Case + Sync) -> f64 {
    let cases = (0..3_u8).flat_map(|order| [(order, false), (order, true)]);
    let cases: Vec<(u8, bool, u64)> =
        cases.flat_map(|(o, raised)| (0..MACHINES).map(move |seed| (o, raised, seed))).collect();
    cases
        .par_iter()
        .map(|&(order, raised, seed)| make(order, raised, seed).difference())
        .reduce(|| 0.0, f64::max)
}

// The stepping is good to 1e-9 of the largest harmonic; a response hardly above
// breakaway is tens of times smaller than the torques it is the difference of.
#[test]
fn the_simulators_agree_on_cosines_from_sticking_to_sliding() {
    let worst = worst(cosine);
    assert!(worst < 2e-8, "{worst:e}");
}

#[test]
fn the_simulators_agree_on_few_lines_and_a_mean() {
    let worst = worst(|order, raised, seed| general(order, raised, seed, 4));
    assert!(worst < 2e-7, "{worst:e}");
}

// 40 lines on 512 samples: a line interpolated from 12.8 samples a cycle is good to
// (2π/12.8)⁶/46080 = 3e-7 of itself, and a response near breakaway is a few times
// smaller than the torque.
#[test]
fn the_simulators_agree_on_multisines_of_forty_lines() {
    let worst = worst(|order, raised, seed| general(order, raised, seed, 40));
    assert!(worst < 1e-6, "{worst:e}");
}

// 2048 samples, 8.5 a cycle of the highest line: (2π/8.5)⁶/46080 = 3.5e-6 of that line.
#[test]
fn the_simulators_agree_on_a_multisine_of_240_lines() {
    for seed in 0..2 {
        let difference = general(0, seed == 1, seed, 240).difference();
        assert!(difference < 1e-6, "{difference:e}");
    }
}
