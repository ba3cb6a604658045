//! Time records drawn far outside what the benchmark draws, as the text that a lab would send.

use std::f64::consts::TAU;
use std::fmt::Write as _;

use proptest::prelude::*;
use proptest::sample::select;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use servoscope_bench::machines::simulator::{Machine, Settings, respond};
use servoscope_core::measurement::Complex;
use servoscope_core::plant::{Actuator, Friction, Plant};

/// Highest harmonic of the response that is written.
const HIGHEST: usize = 40;

/// One drawn record of an axis with friction. Its period is 1 s before the scales are applied.
#[derive(Debug, Clone)]
pub struct RecordCase {
    /// Amplitudes of lines 1, 2, … of the input.
    pub lines: Vec<f64>,
    /// Fc⁺ and Fc⁻ as a share of the first line; 0: a linear axis.
    pub friction: f64,
    /// Periods that are recorded.
    pub periods: f64,
    /// Samples a period.
    pub samples: usize,
    /// Stated period over the true one; `None`: nothing is stated.
    pub stated: Option<f64>,
    /// Deviation of every sample as a share of the largest.
    pub noise: f64,
    /// Decades by which input and response are scaled.
    pub decades: [i32; 2],
    pub seed: u64,
}

impl RecordCase {
    /// Whether the stated period is one of the input: the true one, or a whole number of them.
    pub fn is_periodic(&self) -> bool {
        self.stated.is_none_or(|ratio| (ratio - ratio.round()).abs() < 1e-9 && ratio > 0.5)
    }

    /// The record that is sent; `None` where the axis has no periodic response.
    pub fn text(&self) -> Option<String> {
        let rng = &mut ChaCha8Rng::seed_from_u64(self.seed);
        let level = self.friction * self.lines[0];
        let plant = Plant {
            viscous_rate_rad_s: 10.0,
            constant: 10.0,
            actuator: Actuator::Direct,
            friction: Friction::coulomb(level, 0.9 * level),
        };
        let phase = |k: usize| Complex::from_polar(1.0, (k * k) as f64);
        let lines = self.lines.iter().enumerate().map(|(k, size)| size * phase(k));
        let input: Vec<Complex> = std::iter::once(Complex::ZERO).chain(lines).collect();
        let machine = Machine::base(plant);
        let output = respond(&machine, 0.0, TAU, &input, HIGHEST, &Settings::default()).ok()?;
        let at = |harmonics: &[Complex], time_s: f64| -> f64 {
            let turned = |(k, y): (usize, &Complex)| {
                (y * Complex::from_polar(1.0, k as f64 * TAU * time_s)).re
            };
            harmonics.iter().enumerate().map(turned).sum()
        };
        let [input_scale, output_scale] = self.decades.map(|decades| 10f64.powi(decades));
        let mut text = String::from("# response: velocity\n");
        if let Some(ratio) = self.stated {
            let _ = writeln!(text, "# period_s: {ratio}");
        }
        text += "time_s,input,output\n";
        let count = (self.periods * self.samples as f64).round() as usize;
        let largest = output.iter().map(|y| y.norm()).sum::<f64>();
        for n in 0..count {
            let time_s = n as f64 / self.samples as f64;
            let noise: f64 = StandardNormal.sample(rng);
            let u = at(&input, time_s) * input_scale;
            let y = (at(&output, time_s) + self.noise * largest * noise) * output_scale;
            let _ = writeln!(text, "{time_s:.9},{u:.12e},{y:.12e}");
        }
        Some(text)
    }
}

/// Every kind of record.
pub fn records() -> impl Strategy<Value = RecordCase> {
    let lines = proptest::collection::vec(0.2..2.0, 1..=5);
    let friction = prop_oneof![1 => Just(0.0), 5 => 0.05..0.6];
    let stated = prop_oneof![
        3 => Just(None),
        3 => Just(Some(1.0)),
        1 => Just(Some(2.0)),
        3 => select(vec![0.5, 0.9, 0.97, 0.99, 1.01, 1.05, 1.3, 1.5]).prop_map(Some),
    ];
    let noise = prop_oneof![1 => Just(0.0), 4 => (-5.0..-1.0).prop_map(|e| 10f64.powf(e))];
    let decades =
        prop_oneof![3 => Just([0; 2]), 1 => (-20..=20, -20..=20).prop_map(|(u, y)| [u, y])];
    let design = (1.0..6.0, select(vec![64usize, 100, 128]));
    (lines, friction, design, stated, noise, decades, 0..1000u64).prop_map(
        |(lines, friction, (periods, samples), stated, noise, decades, seed)| RecordCase {
            lines,
            friction,
            periods,
            samples,
            stated,
            noise,
            decades,
            seed,
        },
    )
}
