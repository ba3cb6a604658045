//! Phases of a multisine of equal amplitudes for which its peak is low.
//!
//! The crest factor is the peak over the rms. From Schroeder's phases (M. R. Schroeder 1970,
//! doi:10.1109/TIT.1970.1054411) and from random ones, the signal is clipped and the phases of the
//! clipped one are taken, again and again (E. Van der Ouderaa, J. Schoukens, J. Renneboog 1988,
//! doi:10.1109/19.6055). Then the L₂ₚ norm is minimised by Levenberg–Marquardt for p = 2, 4, 8 …,
//! which tends to the peak (P. Guillaume, J. Schoukens, R. Pintelon, I. Kollár 1991,
//! doi:10.1109/19.85353).

use std::f64::consts::{PI, TAU};

use nalgebra::{DMatrix, DVector};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;

/// Samples of a period in the search, as a multiple of the highest line.
const OVERSAMPLING: usize = 8;
/// The highest line that sets the number of samples is at least this.
const FEWEST_LINES: usize = 16;
/// Starts with random phases, beside Schroeder's.
const RANDOM_STARTS: usize = 1;
/// Times that the signal is clipped, and at which share of its peak.
const CLIPPINGS: usize = 60;
const CLIPPED_AT: f64 = 0.85;
/// Norms that are minimised, as p of L₂ₚ, and the steps for each.
const NORMS: [i32; 6] = [2, 4, 8, 16, 32, 64];
const STEPS: usize = 12;
/// Damping of Levenberg–Marquardt: at the start, and its factors after a failed and a good step.
const DAMPING: f64 = 1e-2;
const RAISED: f64 = 10.0;
const LOWERED: f64 = 0.3;

/// Lines of equal amplitude 1 with their phases, rad.
#[derive(Debug, Clone)]
pub(super) struct Phased {
    /// Lines, ascending.
    pub lines: Vec<usize>,
    /// Phase of each.
    pub phases: Vec<f64>,
}

impl Phased {
    /// One period, in so many samples.
    pub fn waveform(&self, samples: usize) -> Vec<f64> {
        (0..samples).map(|sample| self.at(sample, samples)).collect()
    }

    fn at(&self, sample: usize, samples: usize) -> f64 {
        let angle = |line: usize| TAU * (line * sample % samples) as f64 / samples as f64;
        let pairs = self.lines.iter().zip(&self.phases);
        pairs.map(|(line, phase)| (angle(*line) + phase).cos()).sum()
    }

    /// Peak over rms.
    pub fn crest_factor(&self) -> f64 {
        let highest = self.lines.last().copied().unwrap_or(1);
        let peak = largest(&self.waveform(2 * OVERSAMPLING * highest.max(FEWEST_LINES)));
        peak / (0.5 * self.lines.len() as f64).sqrt()
    }
}

/// Phases of these lines (ascending) with a low crest factor.
pub(super) fn optimised(lines: &[usize], rng: &mut ChaCha8Rng) -> Phased {
    let mut starts = vec![schroeder(lines)];
    for _ in 0..RANDOM_STARTS {
        starts.push(lines.iter().map(|_| rng.random_range(0.0..TAU)).collect());
    }
    let ends = starts.into_iter().map(|phases| {
        let start = Phased { lines: lines.to_vec(), phases };
        let end = flattened(clipped(start));
        (end.crest_factor(), end)
    });
    let best = ends.min_by(|a, b| a.0.total_cmp(&b.0));
    best.map_or(Phased { lines: lines.to_vec(), phases: schroeder(lines) }, |(_, best)| best)
}

/// −πn(n − 1)/N.
fn schroeder(lines: &[usize]) -> Vec<f64> {
    let count = lines.len() as f64;
    (0..lines.len()).map(|n| -PI * (n * (n + 1)) as f64 / count).collect()
}

/// The angles of the lines at the samples of a period: a row for each sample.
fn angles(lines: &[usize]) -> DMatrix<f64> {
    let samples = OVERSAMPLING * lines.last().copied().unwrap_or(1).max(4);
    DMatrix::from_fn(samples, lines.len(), |i, j| {
        TAU * (lines[j] * i % samples) as f64 / samples as f64
    })
}

fn largest(values: &[f64]) -> f64 {
    values.iter().map(|value| value.abs()).fold(0.0, f64::max)
}

/// Clips and takes the phases, and keeps the best.
fn clipped(start: Phased) -> Phased {
    let angles = angles(&start.lines);
    let signal = |phases: &[f64]| -> Vec<f64> {
        let row = |i: usize| -> f64 {
            phases.iter().enumerate().map(|(j, phase)| (angles[(i, j)] + phase).cos()).sum()
        };
        (0..angles.nrows()).map(row).collect()
    };
    let mut phases = start.phases;
    let mut best = (f64::INFINITY, phases.clone());
    for _ in 0..CLIPPINGS {
        let mut values = signal(&phases);
        let peak = largest(&values);
        if peak < best.0 {
            best = (peak, phases.clone());
        }
        let limit = CLIPPED_AT * peak;
        values.iter_mut().for_each(|value| *value = value.clamp(-limit, limit));
        for (j, phase) in phases.iter_mut().enumerate() {
            let products = values.iter().enumerate().map(|(i, value)| {
                let (sin, cos) = angles[(i, j)].sin_cos();
                (value * cos, -value * sin)
            });
            let (re, im) = products.fold((0.0, 0.0), |sum, part| (sum.0 + part.0, sum.1 + part.1));
            *phase = im.atan2(re);
        }
    }
    Phased { lines: start.lines, phases: best.1 }
}

/// Minimises one norm after the other.
fn flattened(start: Phased) -> Phased {
    let angles = angles(&start.lines);
    let mut phases = DVector::from_vec(start.phases);
    for power in NORMS {
        phases = minimised(&angles, phases, power);
    }
    Phased { lines: start.lines, phases: phases.iter().copied().collect() }
}

/// Minimises Σx²ᵖ, x in units of its peak at the start.
fn minimised(angles: &DMatrix<f64>, mut phases: DVector<f64>, power: i32) -> DVector<f64> {
    let signal = |phases: &DVector<f64>| {
        DVector::from_fn(angles.nrows(), |i, _| {
            (0..phases.len()).map(|j| (angles[(i, j)] + phases[j]).cos()).sum::<f64>()
        })
    };
    let unit = signal(&phases).amax();
    let residuals = |phases: &DVector<f64>| signal(phases).map(|x| (x / unit).powi(power));
    let mut damping = DAMPING;
    let mut here = residuals(&phases);
    for _ in 0..STEPS {
        let slopes = signal(&phases).map(|x| f64::from(power) * (x / unit).powi(power - 1) / unit);
        let jacobian = DMatrix::from_fn(angles.nrows(), phases.len(), |i, j| {
            -slopes[i] * (angles[(i, j)] + phases[j]).sin()
        });
        let mut normal = jacobian.tr_mul(&jacobian);
        let gradient = jacobian.tr_mul(&here);
        let size = normal.diagonal().mean();
        (0..phases.len()).for_each(|j| normal[(j, j)] += damping * size);
        let Some(factor) = normal.cholesky() else { break };
        let moved = &phases - factor.solve(&gradient);
        let there = residuals(&moved);
        if there.norm_squared() < here.norm_squared() {
            (phases, here) = (moved, there);
            damping *= LOWERED;
        } else {
            damping *= RAISED;
        }
    }
    phases
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;

    use super::*;

    // P. Guillaume and others reach 1.39 for 31 flat lines; Schroeder's phases give about 1.7.
    #[test]
    fn thirty_one_flat_lines_have_a_low_crest_factor() {
        let lines: Vec<usize> = (1..=31).collect();
        let schroeder = Phased { phases: schroeder(&lines), lines: lines.clone() };
        let found = optimised(&lines, &mut ChaCha8Rng::seed_from_u64(1)).crest_factor();
        println!("31 flat lines: {found:.3}, Schroeder {:.3}", schroeder.crest_factor());
        assert!(found < 1.5 && found < schroeder.crest_factor(), "{found}");
    }

    #[test]
    fn odd_lines_with_gaps_have_a_low_crest_factor_too() {
        let lines = [1, 3, 7, 9, 11, 13, 17, 23, 25, 29, 31, 35, 37, 41];
        let found = optimised(&lines, &mut ChaCha8Rng::seed_from_u64(1)).crest_factor();
        println!("14 odd lines: {found:.3}");
        assert!(found < 1.6, "{found}");
    }

    #[test]
    fn one_line_is_a_cosine() {
        let one = optimised(&[1], &mut ChaCha8Rng::seed_from_u64(1));
        assert!((one.crest_factor() - 2.0_f64.sqrt()).abs() < 1e-3);
    }
}
