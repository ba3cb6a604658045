//! Levels of a stepped sine: the distortion of a cosine is all that is measured at its harmonics.

use crate::answers::{DistortionLine, LinearLine, LinearityLevel, Parity};
use crate::measurement::Experiment;

use super::SAME_FREQUENCY;
use super::level::{Part, Power, median, noise_share};
use super::lines::{Line, Lines};

/// One level for each magnitude: the smallest at each frequency, the second smallest, and so on.
/// A level that lacks frequencies is one still.
pub(super) fn levels(experiments: &[Experiment]) -> Vec<LinearityLevel> {
    let mut sorted: Vec<&Experiment> = experiments.iter().collect();
    sorted.sort_by(|a, b| {
        a.omega_rad_s.total_cmp(&b.omega_rad_s).then(a.magnitude.total_cmp(&b.magnitude))
    });
    let mut levels: Vec<Vec<&Experiment>> = Vec::new();
    let is_same = |a: &&Experiment, b: &&Experiment| {
        b.omega_rad_s - a.omega_rad_s < SAME_FREQUENCY * b.omega_rad_s
    };
    for at_one_frequency in sorted.chunk_by(is_same) {
        let at_one_magnitude = |a: &&Experiment, b: &&Experiment| a.magnitude == b.magnitude;
        for (rank, same) in at_one_frequency.chunk_by(at_one_magnitude).enumerate() {
            levels.resize(levels.len().max(rank + 1), Vec::new());
            levels[rank].extend(same);
        }
    }
    levels.iter().map(|experiments| level(experiments)).collect()
}

fn level(experiments: &[&Experiment]) -> LinearityLevel {
    let (mut approximation, mut distortion) = (Vec::new(), Vec::new());
    let (mut even, mut odd) = (Part::default(), Part::default());
    let mut fundamentals = Vec::new();
    for experiment in experiments {
        let omega_rad_s = experiment.omega_rad_s;
        let Lines { excited, others, degrees, .. } = Lines::of(experiment);
        let Some(fundamental) = excited.first() else { continue };
        fundamentals.push(power(fundamental));
        approximation.push(linear_line(omega_rad_s, fundamental));
        for (parity, part) in [(Parity::Even, &mut even), (Parity::Odd, &mut odd)] {
            let own = others
                .iter()
                .filter(|line| line.order.is_multiple_of(2) == (parity == Parity::Even));
            let own: Vec<Power> = own.map(power).collect();
            own.iter().for_each(|line| part.add(*line, degrees));
            let noise: Option<f64> = own.iter().map(|line| line.noise).sum();
            let amplitude = own.iter().map(|line| line.power).sum::<f64>().sqrt();
            if !own.is_empty() {
                let noise = noise.map(f64::sqrt);
                distortion.push(DistortionLine { omega_rad_s, parity, amplitude, noise });
            }
        }
    }
    let whole: f64 = fundamentals.iter().map(|line| line.power).sum();
    LinearityLevel {
        magnitude: median(experiments.iter().map(|e| e.magnitude).collect()),
        realisations: 1,
        approximation,
        distortion,
        noise: noise_share(&fundamentals),
        even: even.share(whole, 1.0),
        odd: odd.share(whole, 1.0),
        stochastic: None,
    }
}

/// The gain at one line with its noise.
fn linear_line(omega_rad_s: f64, line: &Line) -> LinearLine {
    let gain = line.gain();
    let noise_std = line.noise.map(|noise| (0.5 * noise).sqrt() / line.input.norm());
    let (amplitude, noise) = (line.response.norm(), line.noise.map(f64::sqrt));
    let gain = [gain.re, gain.im];
    LinearLine { omega_rad_s, gain, noise_std, total_std: None, amplitude, noise }
}

pub(super) fn power(line: &Line) -> Power {
    Power { power: line.response.norm_sqr(), noise: line.noise }
}
