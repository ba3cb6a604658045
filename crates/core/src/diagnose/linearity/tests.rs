//! Tests with responses of the independent simulator.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;

use super::*;
use crate::answers::Parity;
use crate::machines::simulator::{self, Machine, Settings};
use crate::measurement::{Experiment, Harmonic, Metadata, Repeat};
use crate::plant::{Actuator, Friction, Plant};

const HIGHEST: usize = 61;

fn plant(fc_plus: f64, fc_minus: f64) -> Plant {
    Plant {
        viscous_rate_rad_s: 10.0,
        constant: 10.0,
        actuator: Actuator::Direct,
        friction: Friction::coulomb(fc_plus, fc_minus),
    }
}

/// Without noise. Half the peak-to-peak value of a multisine is not needed here.
fn experiment(plant: Plant, omega_rad_s: f64, input: Vec<Complex>, highest: usize) -> Experiment {
    let (machine, settings) = (Machine::base(plant), Settings::default());
    let velocity = simulator::respond(&machine, 0.0, omega_rad_s, &input, highest, &settings);
    let harmonic = |(order, value)| Harmonic { order, value, std: None };
    Experiment {
        magnitude: input.iter().map(|u| u.norm_sqr()).sum::<f64>().sqrt(),
        omega_rad_s,
        input,
        input_mean_measured: false,
        mean_velocity: 0.0,
        rounding_std: 0.0,
        open_samples: None,
        bad_samples: None,
        clipping: None,
        range: None,
        unknown_input: Vec::new(),
        response: velocity.unwrap().into_iter().enumerate().map(harmonic).collect(),
        run: None,
        repeats: Vec::new(),
        from_record: false,
    }
}

fn cosine(plant: Plant, magnitude: f64, omega_rad_s: f64) -> Experiment {
    experiment(plant, omega_rad_s, vec![Complex::ZERO, Complex::new(magnitude, 0.0)], 7)
}

/// Every second odd line from 1 to 61, of random phases: half of the odd lines are left out.
fn multisine(plant: Plant, amplitude: f64, seed: u64) -> Experiment {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut input = vec![Complex::ZERO; HIGHEST + 1];
    for k in (1..=HIGHEST).step_by(4) {
        input[k] = Complex::from_polar(amplitude, rng.random_range(0.0..std::f64::consts::TAU));
    }
    experiment(plant, 0.5, input, HIGHEST)
}

/// Adds noise of this deviation to each part, and states it.
fn stated(mut experiment: Experiment, std: f64, seed: u64) -> Experiment {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut drawn = || std * rng.sample::<f64, _>(StandardNormal);
    for harmonic in &mut experiment.response {
        harmonic.value += Complex::new(drawn(), drawn());
        harmonic.std = Some(std);
    }
    experiment
}

fn found(experiments: Vec<Experiment>) -> Linearity {
    let measurement =
        Measurement::new(Metadata::default(), experiments, Vec::new(), String::new()).unwrap();
    linearity(&measurement).unwrap()
}

/// Two magnitudes at five frequencies.
fn stepped_sine(plant: Plant, std: f64) -> Linearity {
    let places = [2.0, 4.0].into_iter().flat_map(|m| (0..5).map(move |i| (m, 2_f64.powi(i))));
    let experiments = places.enumerate().map(|(seed, (magnitude, omega))| {
        stated(cosine(plant, magnitude, omega), std, seed as u64)
    });
    found(experiments.collect())
}

#[test]
fn a_linear_axis_has_neither_distortion_nor_a_gain_that_changes() {
    let linear = plant(0.0, 0.0);
    let cosines = stepped_sine(linear, 1e-3);
    assert_eq!(cosines.levels.len(), 2);
    let multisines = found(
        [(0.3, 1), (0.3, 2), (0.3, 3), (1.0, 4)]
            .map(|(amplitude, seed)| stated(multisine(linear, amplitude, seed), 1e-3, seed))
            .to_vec(),
    );
    for Linearity { levels, change_with_level, sentence } in [cosines, multisines] {
        for level in &levels {
            let shares = [level.even, level.odd, level.stochastic];
            assert!(shares.iter().flatten().all(|share| share.value == 0.0), "{shares:?}");
            assert!(level.even.is_some() && level.odd.is_some());
        }
        assert_eq!(change_with_level.unwrap().value, 0.0, "{sentence}");
        assert!(sentence.contains("there is no odd distortion above"), "{sentence}");
        assert!(sentence.contains("does not change with the magnitude"), "{sentence}");
    }
}

#[test]
fn symmetric_friction_makes_odd_distortion_and_asymmetric_friction_even_distortion_as_well() {
    let symmetric = stepped_sine(plant(0.5, 0.5), 1e-4);
    let asymmetric = stepped_sine(plant(0.6, 0.4), 1e-4);
    let odd = |found: &Linearity| found.levels[0].odd.unwrap().value;
    let even = |found: &Linearity| found.levels[0].even.unwrap().value;
    assert!(odd(&symmetric) > 0.03 && odd(&asymmetric) > 0.03, "{symmetric:?}");
    assert_eq!(even(&symmetric), 0.0, "{}", symmetric.sentence);
    assert!(even(&asymmetric) > 0.003, "{}", asymmetric.sentence);
    // Friction takes a larger share of a smaller command.
    assert!(odd(&symmetric) > 1.5 * symmetric.levels[1].odd.unwrap().value);
    assert!(symmetric.change_with_level.unwrap().value > 0.1);
}

// By its definition: Σ|Y₃|² + |Y₅|² + |Y₇|² over Σ|Y₁|².
#[test]
fn the_distortion_of_cosines_is_their_total_harmonic_distortion() {
    let axis = plant(0.5, 0.5);
    let experiments: Vec<Experiment> = (0..4).map(|i| cosine(axis, 2.0, 2_f64.powi(i))).collect();
    let sum = |orders: &[usize]| {
        let all = experiments.iter().flat_map(|e| orders.iter().filter_map(|k| e.harmonic(*k)));
        all.map(|harmonic| harmonic.value.norm_sqr()).sum::<f64>()
    };
    let expected = (sum(&[3, 5, 7]) / sum(&[1])).sqrt();
    let found = found(experiments);
    let share = found.levels[0].odd.unwrap();
    assert!((share.value / expected - 1.0).abs() < 1e-12 && share.detectable.is_none());
    assert!(found.sentence.contains("odd distortion, noise included, is"), "{}", found.sentence);
}

#[test]
fn lines_that_a_multisine_leaves_out_tell_even_from_odd_distortion() {
    let found_of = |axis| found(vec![stated(multisine(axis, 0.8, 5), 1e-4, 6)]);
    let [symmetric, asymmetric] = [(0.5, 0.5), (0.7, 0.3)].map(|(p, m)| found_of(plant(p, m)));
    let level = &symmetric.levels[0];
    assert!(level.odd.unwrap().value > 0.05, "{}", symmetric.sentence);
    assert_eq!(level.even.unwrap().value, 0.0, "{}", symmetric.sentence);
    assert!(asymmetric.levels[0].even.unwrap().value > 0.02, "{}", asymmetric.sentence);
    let parity = |parity| level.distortion.iter().filter(|line| line.parity == parity).count();
    // Between the lines 1 and 61: 30 even ones, and 3, 7, … 59.
    assert_eq!((parity(Parity::Even), parity(Parity::Odd)), (30, 15));
    // The 15 odd lines left out stand for all 31.
    let power = |values: &mut dyn Iterator<Item = f64>| values.map(|y| y * y).sum::<f64>();
    let odd = level.distortion.iter().filter(|line| line.parity == Parity::Odd);
    let distortion = power(&mut odd.map(|line| line.amplitude)) * 31.0 / 15.0;
    let whole = power(&mut level.approximation.iter().map(|line| line.amplitude));
    // The noise, of 1e-4, is next to nothing.
    let ratio = level.odd.unwrap().value / (distortion / whole).sqrt();
    assert!((ratio - 1.0).abs() < 1e-3, "{ratio}");
}

// Both estimate the same distortion, one from 15 lines and one from 16 lines of eight inputs; each
// scatters by about a fifth.
#[test]
fn the_scatter_between_realisations_is_as_large_as_the_distortion_at_the_lines_left_out() {
    let axis = plant(0.5, 0.5);
    let realisations = (0..8).map(|seed| stated(multisine(axis, 0.8, seed), 1e-4, 100 + seed));
    let found = found(realisations.collect());
    assert_eq!((found.levels.len(), found.levels[0].realisations), (1, 8));
    let level = &found.levels[0];
    let [odd, stochastic] = [level.odd, level.stochastic].map(|share| share.unwrap().value);
    // Of 31 odd lines, 16 are excited.
    let ratio = stochastic / (odd * (16.0_f64 / 31.0).sqrt());
    assert!((0.6..1.6).contains(&ratio), "{stochastic} beside {odd}");
    assert!(level.approximation.iter().all(|line| line.total_std > line.noise_std));
}

#[test]
fn the_noise_is_found_from_the_scatter_of_periods_and_what_the_input_leaves_there_is_taken_off() {
    let linear = plant(0.0, 0.0);
    let mut experiment = multisine(linear, 1.0, 7);
    let mut rng = ChaCha8Rng::seed_from_u64(8);
    let mut drawn = |std: f64| {
        let mut part = || std * rng.sample::<f64, _>(StandardNormal);
        Complex::new(part(), part())
    };
    // The input has a little at every line, and the response follows it.
    let gain = |k: usize| Complex::new(10.0, 0.0) / Complex::new(10.0, 0.5 * k as f64);
    for k in 1..=HIGHEST {
        let extra = Complex::from_polar(0.01, k as f64);
        experiment.input[k] += extra;
        experiment.response[k].value += gain(k) * extra;
    }
    const PERIODS: usize = 20;
    const STD: f64 = 1e-2;
    let mut deviations: Vec<Vec<Complex>> =
        (0..PERIODS).map(|_| (0..=HIGHEST).map(|_| drawn(STD)).collect()).collect();
    for k in 0..=HIGHEST {
        let mean = deviations.iter().map(|period| period[k]).sum::<Complex>() / PERIODS as f64;
        experiment.response[k].value += mean;
        deviations.iter_mut().for_each(|period| period[k] -= mean);
    }
    let repeat = |response| Repeat { input: Vec::new(), response };
    experiment.repeats = deviations.into_iter().map(repeat).collect();
    let excited = |k: &usize| k % 4 == 1;
    let power = |k: usize| experiment.response[k].value.norm_sqr();
    let whole: f64 = (1..=HIGHEST).filter(excited).map(power).sum();
    let expected = (16.0 * 2.0 * STD * STD / PERIODS as f64 / whole).sqrt();
    let found = found(vec![experiment.clone()]);
    let level = &found.levels[0];
    // 16 lines with 19 degrees of freedom each: 3 %.
    assert!((level.noise.unwrap() / expected - 1.0).abs() < 0.15, "{:?} {expected}", level.noise);
    assert_eq!(level.odd.unwrap().value, 0.0, "{}", found.sentence);
    assert_eq!(level.even.unwrap().value, 0.0, "{}", found.sentence);
}

#[test]
fn an_input_that_excites_every_line_hides_distortion_and_the_sentence_says_so() {
    let mut input = vec![Complex::ZERO];
    input.extend((1..=30).map(|k| Complex::from_polar(0.6, f64::from(k * k))));
    let full = experiment(plant(0.5, 0.5), 1.0, input, 30);
    let measurement =
        |e| Measurement::new(Metadata::default(), vec![e], Vec::new(), String::new()).unwrap();
    assert_eq!(linearity(&measurement(full.clone())), None);
    let found = linearity(&measurement(stated(full, 1e-3, 1))).unwrap();
    let level = &found.levels[0];
    assert_eq!((level.even, level.odd, level.stochastic), (None, None, None));
    assert!(found.sentence.contains("which hides distortion"), "{}", found.sentence);
}

#[test]
fn bare_gains_at_two_magnitudes_show_how_much_the_gain_changes() {
    let bare = |magnitude, axis| {
        let mut experiment = stated(cosine(axis, magnitude, 3.0), 1e-4, 2);
        experiment.response.retain(|harmonic| harmonic.order == 1);
        experiment
    };
    let axis = plant(0.5, 0.5);
    let gain = |m: f64| bare(m, axis).response[0].value / m;
    let expected = (gain(4.0) - gain(2.0)).norm() / gain(4.0).norm();
    let found = found(vec![bare(2.0, axis), bare(4.0, axis)]);
    assert!((found.change_with_level.unwrap().value / expected - 1.0).abs() < 1e-6);
    assert!(found.levels.iter().all(|level| level.odd.is_none()));
}
