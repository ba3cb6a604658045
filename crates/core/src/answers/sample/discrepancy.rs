//! A made-up comparison with a simulation, and the patterns in it.

use crate::answers::{ComparedExperiment, ComparedHarmonic, Comparison, Discrepancy, Pattern};

/// Three magnitudes at six frequencies with harmonics 0 to 3; every measured value is 1 % above the
/// simulated one.
pub fn comparison() -> Comparison {
    let experiment = |index: usize, magnitude: f64, omega_rad_s: f64| {
        let harmonic = |order: usize| {
            let slow = 1.0 + omega_rad_s / 10.0;
            let size = magnitude / (slow * (1.0 + (order * order) as f64));
            let [re, im] = if order == 0 { [-0.02 * size, 0.0] } else { [size, -0.4 * size] };
            ComparedHarmonic {
                order,
                input: [if order == 1 { magnitude } else { 0.0 }, 0.0],
                measured: [1.01 * re, 1.01 * im],
                simulated: [re, im],
                std: 0.002,
            }
        };
        ComparedExperiment {
            experiment: index,
            magnitude,
            omega_rad_s,
            run: Some(index as f64),
            harmonics: (0..4).map(harmonic).collect(),
        }
    };
    let design = [1.0, 2.0, 4.0].into_iter();
    let design = design.flat_map(|m| [1.0, 2.0, 5.0, 10.0, 20.0, 50.0].map(|omega| (m, omega)));
    Comparison {
        input_unit: "A".into(),
        response_unit: "rad/s".into(),
        response_quantity: "velocity".into(),
        std_estimated: false,
        experiments: design.enumerate().map(|(i, (m, w))| experiment(i, m, w)).collect(),
        unanswered: Vec::new(),
    }
}

/// A pattern that covers the whole measurement.
pub fn pattern(sentence: &str) -> Pattern {
    Pattern {
        magnitudes: None,
        frequencies_hz: None,
        harmonics: Vec::new(),
        runs: None,
        count: 12,
        rms_sigmas: 9.0,
        rms_response: 0.02,
        relative_size: Some(0.01),
        phase_deg: None,
        share: 0.4,
        sentence: sentence.to_owned(),
    }
}

/// Three overlapping patterns of [`comparison`].
pub fn discrepancy() -> Discrepancy {
    let high = Pattern {
        magnitudes: Some([4.0, 4.0]),
        frequencies_hz: Some([0.3, 3.0]),
        harmonics: vec![1],
        ..pattern("At 4 A from 0.3 to 3 Hz the fundamental is 1 % larger than simulated (9 σ).")
    };
    let odd = Pattern {
        harmonics: vec![1, 3],
        ..pattern("At every magnitude the odd harmonics are larger than simulated.")
    };
    let late = Pattern { runs: Some([10.0, 17.0]), ..pattern("It grows with the run.") };
    Discrepancy {
        sentence: "The simulation is wrong in the fundamental at the largest magnitude.".into(),
        noise_like: false,
        tests: Vec::new(),
        patterns: vec![high, odd, late],
        by_magnitude: Vec::new(),
        by_frequency: Vec::new(),
        by_harmonic: Vec::new(),
        by_run: Vec::new(),
    }
}
