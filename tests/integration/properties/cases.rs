//! Measurements drawn far outside what the benchmark draws, as the text that a lab would send.

use std::fmt::Write as _;

use proptest::prelude::*;
use proptest::sample::{select, subsequence};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use servoscope_bench::machines::simulator::{Machine, Settings, respond};
use servoscope_core::measurement::Complex;
use servoscope_core::plant::{Actuator, Friction, Plant};

/// What answers the input.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Subject {
    /// An axis with friction, moved by every magnitude.
    Axis,
    /// The same without any friction: linear.
    Linear,
    /// An axis whose friction exceeds some or all magnitudes.
    Stuck,
    /// Nothing: all that is measured is noise.
    Noise,
    /// Every harmonic of every experiment has the same value.
    Constant,
}

/// How a measurement states its noise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Statement {
    /// It does not.
    Silent,
    /// By a standard deviation this many times the true one.
    Std(f64),
    /// By so many repeats.
    Repeats(usize),
}

/// One drawn measurement. Sizes are in units of the axis (a = 10 1/s, K = 10, friction near
/// 0.5) before the scales are applied.
#[derive(Debug, Clone)]
pub struct Case {
    pub subject: Subject,
    /// Order of the actuator of the axis.
    pub order: u8,
    pub magnitudes: Vec<f64>,
    pub omegas: Vec<f64>,
    pub harmonics: Vec<usize>,
    pub statement: Statement,
    /// Deviation of re and im as a share of the largest response; 0: none.
    pub noise: f64,
    /// Significant digits of every number written.
    pub digits: usize,
    /// Decades by which input, response and frequency are scaled.
    pub decades: [i32; 3],
    /// First word of the response: velocity, position or acceleration.
    pub response: &'static str,
    pub seed: u64,
}

impl Case {
    /// A modest case from which others are made by changing single members.
    pub fn ordinary() -> Self {
        Self {
            subject: Subject::Axis,
            order: 0,
            magnitudes: vec![1.0, 2.0],
            omegas: vec![2.0, 8.0, 30.0],
            harmonics: vec![0, 1, 2, 3],
            statement: Statement::Std(1.0),
            noise: 1e-3,
            digits: 12,
            decades: [0; 3],
            response: "velocity",
            seed: 1,
        }
    }

    fn plant(&self) -> Plant {
        let friction = match self.subject {
            Subject::Linear => Friction::coulomb(0.0, 0.0),
            Subject::Stuck => {
                // Above some of the magnitudes, or above all of them.
                let middle = self.magnitudes[self.magnitudes.len() / 2];
                let level = if self.seed.is_multiple_of(2) { 0.9 * middle } else { 1.5 * middle };
                Friction::coulomb(level, 0.9 * level)
            }
            _ => {
                let least = self.magnitudes.iter().copied().fold(f64::INFINITY, f64::min);
                Friction::coulomb(0.5 * least, 0.4 * least)
            }
        };
        let actuator = match self.order {
            0 => Actuator::Direct,
            1 => Actuator::FirstOrder { corner_rad_s: 40.0 },
            _ => Actuator::SecondOrder { natural_frequency_rad_s: 50.0, damping_ratio: 0.3 },
        };
        Plant { viscous_rate_rad_s: 10.0, constant: 10.0, actuator, friction }
    }

    /// Y₀ … Y_H at a point, before noise; nothing where the axis has no periodic response.
    fn exact(&self, plant: &Plant, magnitude: f64, omega: f64, highest: usize) -> Vec<Complex> {
        match self.subject {
            Subject::Noise => vec![Complex::ZERO; highest + 1],
            Subject::Constant => vec![Complex::new(1.0, 0.0); highest + 1],
            Subject::Linear => {
                let gain = plant.actuator.response(omega) * plant.mechanics_response(omega);
                let mut harmonics = vec![Complex::ZERO; highest + 1];
                if highest > 0 {
                    harmonics[1] = gain * magnitude;
                }
                harmonics
            }
            Subject::Axis | Subject::Stuck => {
                let input = [Complex::ZERO, Complex::new(magnitude, 0.0)];
                let machine = Machine::base(*plant);
                respond(&machine, 0.0, omega, &input, highest, &Settings::default())
                    .unwrap_or_default()
            }
        }
    }

    /// The table that is sent.
    pub fn text(&self) -> String {
        let rng = &mut ChaCha8Rng::seed_from_u64(self.seed);
        let plant = self.plant();
        let highest = self.harmonics.iter().copied().max().unwrap_or(1);
        let points = self.magnitudes.iter().flat_map(|m| self.omegas.iter().map(move |w| (*m, *w)));
        let mut responses: Vec<(f64, f64, Vec<Complex>)> = Vec::new();
        for (magnitude, omega) in points {
            let velocity = self.exact(&plant, magnitude, omega, highest);
            let reported = velocity.iter().enumerate().map(|(k, v)| {
                let s = Complex::new(0.0, k as f64 * omega);
                match (self.response, k) {
                    (_, 0) | ("velocity", _) => *v,
                    ("position", _) => v / s,
                    _ => v * s,
                }
            });
            responses.push((magnitude, omega, reported.collect()));
        }
        let all = responses.iter().flat_map(|(.., harmonics)| harmonics);
        let largest = all.map(|y| y.norm()).fold(0.0, f64::max);
        let std = self.noise * if largest > 0.0 { largest } else { 1.0 };
        let repeats = if let Statement::Repeats(count) = self.statement { count } else { 1 };
        let scatter = std * (repeats as f64).sqrt();
        let [input, response, frequency] = self.decades.map(|decades| 10f64.powi(decades));
        let digits = self.digits.saturating_sub(1);
        let mut text = format!("# response: {}\nmagnitude,omega_rad_s,harmonic", self.response);
        text += match self.statement {
            Statement::Silent => ",re,im\n",
            Statement::Std(_) => ",re,im,std\n",
            Statement::Repeats(_) => ",repeat,re,im\n",
        };
        for (magnitude, omega, harmonics) in &responses {
            for repeat in 0..repeats {
                for k in self.harmonics.iter().filter(|k| **k < harmonics.len()) {
                    let mut normal = || -> f64 { StandardNormal.sample(rng) };
                    let noise = Complex::new(normal(), normal()) * scatter;
                    let y = (harmonics[*k] + noise) * response;
                    let (m, w) = (magnitude * input, omega * frequency);
                    let _ = write!(text, "{m:.digits$e},{w:.digits$e},{k},");
                    if let Statement::Repeats(_) = self.statement {
                        let _ = write!(text, "{repeat},");
                    }
                    let im = if *k == 0 { 0.0 } else { y.im };
                    let _ = write!(text, "{:.digits$e},{im:.digits$e}", y.re);
                    if let Statement::Std(ratio) = self.statement {
                        let told = ratio * if std > 0.0 { std } else { 1e-6 } * response;
                        let _ = write!(text, ",{told:.6e}");
                    }
                    text.push('\n');
                }
            }
        }
        text
    }
}

fn log_uniform(low: f64, high: f64) -> impl Strategy<Value = f64> {
    (low.ln()..high.ln()).prop_map(f64::exp)
}

/// Ascending values, each so much larger than the one before.
fn ladder(count: std::ops::RangeInclusive<usize>, first: f64) -> impl Strategy<Value = Vec<f64>> {
    (log_uniform(0.1, 10.0), proptest::collection::vec(log_uniform(1.05, 6.0), count)).prop_map(
        move |(lowest, steps)| {
            let mut value = first * lowest;
            let next = |step: f64| {
                let here = value;
                value *= step;
                here
            };
            steps.into_iter().map(next).collect()
        },
    )
}

fn statements() -> impl Strategy<Value = Statement> {
    prop_oneof![
        3 => Just(Statement::Silent),
        4 => Just(Statement::Std(1.0)),
        2 => log_uniform(1e-6, 1e6).prop_map(Statement::Std),
        3 => select(vec![2, 3, 6]).prop_map(Statement::Repeats),
    ]
}

/// Every kind of case, with at most so many magnitudes and frequencies.
pub fn cases(magnitudes: usize, omegas: usize) -> impl Strategy<Value = Case> {
    let subjects = prop_oneof![
        5 => Just(Subject::Axis),
        2 => Just(Subject::Linear),
        2 => Just(Subject::Stuck),
        1 => Just(Subject::Noise),
        1 => Just(Subject::Constant),
    ];
    let decades = prop_oneof![
        3 => Just([0; 3]),
        2 => (-30..=30, -30..=30, -6..=6).prop_map(|(u, y, w)| [u, y, w]),
    ];
    let noise = prop_oneof![1 => Just(0.0), 5 => log_uniform(1e-6, 0.3)];
    let digits = prop_oneof![1 => 2..=5usize, 5 => Just(12)];
    let responses =
        prop_oneof![4 => Just("velocity"), 1 => Just("position"), 1 => Just("acceleration")];
    let design = (
        ladder(1..=magnitudes, 1.0),
        ladder(1..=omegas, 5.0),
        subsequence((0..=5).collect::<Vec<usize>>(), 1..=6),
    );
    (subjects, 0..=2u8, design, statements(), noise, digits, decades, responses, 0..1000u64)
        .prop_map(|(subject, order, design, statement, noise, digits, decades, response, seed)| {
            let (magnitudes, omegas, harmonics) = design;
            Case {
                subject,
                order,
                magnitudes,
                omegas,
                harmonics,
                statement,
                noise,
                digits,
                decades,
                response,
                seed,
            }
        })
}
