//! Other units are the same machine.

use rayon::prelude::*;
use servoscope_bench::machines::draw::{Draw, NoiseStatement, draw, measure};
use servoscope_core::answers::IdentifyOptions;
use servoscope_core::measurement::{Complex, Experiment, Measurement, ResponseKind};

use crate::machines::{ask, changed};
use crate::reference::g_measurement;

/// What input, response and time are multiplied by.
#[derive(Debug, Clone, Copy)]
struct Units {
    input: f64,
    response: f64,
    time: f64,
}

const NONE: Units = Units { input: 1.0, response: 1.0, time: 1.0 };

impl Units {
    /// One quantity after the other times the factor.
    fn each(factor: f64) -> [Units; 3] {
        [
            Units { input: factor, ..NONE },
            Units { response: factor, ..NONE },
            Units { time: factor, ..NONE },
        ]
    }

    fn apply(self, measurement: &Measurement) -> Measurement {
        let scale = |values: &mut Vec<Complex>, by: f64| values.iter_mut().for_each(|z| *z *= by);
        changed(
            measurement,
            |_| (),
            |experiments| {
                for experiment in experiments {
                    experiment.magnitude *= self.input;
                    experiment.omega_rad_s /= self.time;
                    scale(&mut experiment.input, self.input);
                    for harmonic in &mut experiment.response {
                        harmonic.value *= self.response;
                        harmonic.std = harmonic.std.map(|std| std * self.response);
                    }
                    for repeat in &mut experiment.repeats {
                        scale(&mut repeat.response, self.response);
                        scale(&mut repeat.input, self.input);
                    }
                }
            },
        )
    }

    /// What a parameter is multiplied by.
    fn factor(self, name: &str, kind: ResponseKind) -> f64 {
        let velocity = match kind {
            ResponseKind::Velocity => self.response,
            ResponseKind::Position => self.response / self.time,
            ResponseKind::Acceleration => self.response * self.time,
        };
        match name {
            "pole" | "actuator_pole" | "natural_frequency" => 1.0 / self.time,
            "constant" => velocity / (self.input * self.time),
            "dc_gain" => velocity / self.input,
            "fc_plus" | "fc_minus" => self.input,
            "damping_ratio" => 1.0,
            other => panic!("no unit is known of {other}"),
        }
    }
}

/// The same motion, its position measured.
fn as_position(measurement: &Measurement) -> Measurement {
    let per_velocity = |k: usize, e: &Experiment| Complex::new(0.0, k as f64 * e.omega_rad_s).inv();
    changed(
        measurement,
        |metadata| metadata.response_kind = ResponseKind::Position,
        |experiments| {
            for experiment in experiments {
                let from: Vec<Complex> =
                    experiment.response.iter().map(|h| per_velocity(h.order, experiment)).collect();
                assert_eq!(experiment.response[0].order, 0);
                experiment.response.remove(0);
                for (harmonic, factor) in experiment.response.iter_mut().zip(&from[1..]) {
                    harmonic.value *= factor;
                    harmonic.std = harmonic.std.map(|std| std * factor.norm());
                }
                for repeat in &mut experiment.repeats {
                    repeat.response.remove(0);
                    repeat.response.iter_mut().zip(&from[1..]).for_each(|(z, f)| *z *= f);
                }
            }
        },
    )
}

fn noisy(order: u8, noise_statement: NoiseStatement) -> Measurement {
    let machine = Draw { noise_statement, ..draw(order, 77) };
    measure(&machine, 5).expect("a periodic response")
}

/// What rounding of the cost leaves undecided in a noisy fit: a relative ε in χ² = N is
/// √(ε·N) = 4e-7 standard deviations at N = 720, and those are up to 1 % of a value.
const NOISY: f64 = 5e-9;

/// Asserts that values deviate from the scaled ones by less than `values`, deviations and
/// ends of intervals by less than `spreads`.
fn assert_scales(
    measurement: &Measurement,
    order: u8,
    factors: &[f64],
    [values, spreads]: [f64; 2],
) {
    let kind = measurement.metadata().response_kind;
    let options = IdentifyOptions::default();
    let plain = ask(measurement, Some(order), options).expect("an answer");
    for units in factors.iter().flat_map(|factor| Units::each(*factor)) {
        let other = ask(&units.apply(measurement), Some(order), options).expect("an answer");
        assert!(plain.parameters.keys().eq(other.parameters.keys()));
        for (name, before) in &plain.parameters {
            let after = &other.parameters[name];
            let factor = units.factor(name, kind);
            let check = |before: f64, after: f64, tolerance: f64| {
                let deviation = (after / (before * factor) - 1.0).abs();
                assert!(deviation < tolerance, "{units:?} {name}: {deviation:e}");
            };
            check(before.value.unwrap(), after.value.unwrap(), values);
            check(before.std.unwrap(), after.std.unwrap(), spreads);
            let (before, after) = (before.interval95.unwrap(), after.interval95.unwrap());
            check(before[0], after[0], spreads);
            check(before[1], after[1], spreads);
        }
        assert_eq!(plain.fit.adequate, other.fit.adequate);
    }
}

const STATEMENTS: [NoiseStatement; 3] =
    [NoiseStatement::Std, NoiseStatement::Repeats(6), NoiseStatement::Silent];

#[test]
fn other_units_of_velocity_data_change_the_parameters_by_exactly_that() {
    (0..3_u8).into_par_iter().for_each(|order| {
        let data = noisy(order, STATEMENTS[usize::from(order)]);
        assert_scales(&data, order, &[1e3], [NOISY; 2]);
    });
}

#[test]
fn other_units_of_position_data_change_the_parameters_by_exactly_that() {
    (0..3_u8).into_par_iter().for_each(|order| {
        let data = as_position(&noisy(order, STATEMENTS[usize::from(2 - order)]));
        assert_scales(&data, order, &[1e-3], [NOISY; 2]);
    });
}

#[test]
#[ignore = "slow: 126 identifications"]
fn other_units_change_the_parameters_by_exactly_that_whatever_is_said_of_the_noise() {
    (0..9_usize).into_par_iter().for_each(|case| {
        let order = (case % 3) as u8;
        let velocity = noisy(order, STATEMENTS[case / 3]);
        for data in [as_position(&velocity), velocity] {
            assert_scales(&data, order, &[1e3, 1e-3], [NOISY; 2]);
        }
    });
}

// Without noise the residual is what the data's simulator leaves, 1e-9 of the response:
// of it 1e-7 is rounding, and of the deviations made of it ten times that.
#[test]
fn other_units_of_g1_without_noise_change_the_parameters_by_exactly_that() {
    let velocity = g_measurement(0);
    let position = as_position(&velocity);
    assert_scales(&velocity, 0, &[1e3], [1e-9, 1e-5]);
    assert_scales(&position, 0, &[1e-3], [1e-9, 1e-5]);
}
