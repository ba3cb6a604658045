//! An axis that is kept moving by a constant part of its input, from the file to the fit.

use std::fmt::Write as _;

use servoscope_bench::machines::simulator::{Machine, Settings, respond};
use servoscope_core::answers::{Identification, IdentifyOptions};
use servoscope_core::measurement::Complex;
use servoscope_core::measurement::formats::{self, Source};

use crate::machines::{ask, largest_error};
use crate::reference::g;

/// G1 at two magnitudes and six frequencies with biases of either sign and without one, harmonics 0 to
/// 5, from the independent simulator.
fn table() -> String {
    let machine = Machine::base(g(0));
    let mut text = String::from("experiment,magnitude,omega_rad_s,bias,harmonic,re,im\n");
    let mut experiment = 0;
    for bias in [0.0, 0.4, -0.3] {
        for magnitude in [1.0, 2.0] {
            for omega in [1.0, 2.0, 5.0, 10.0, 20.0, 40.0] {
                let input = [Complex::new(bias, 0.0), Complex::new(magnitude, 0.0)];
                let settings = Settings::default();
                let response = respond(&machine, 0.0, omega, &input, 5, &settings).unwrap();
                for (harmonic, y) in response.iter().enumerate() {
                    let (re, im) = (y.re, y.im);
                    writeln!(text, "{experiment},{magnitude},{omega},{bias},{harmonic},{re},{im}")
                        .unwrap();
                }
                experiment += 1;
            }
        }
    }
    text
}

fn fitted(text: &str) -> Identification {
    let source = Source { name: "biased.csv", bytes: text.as_bytes() };
    let measurement = formats::read(&[source]).unwrap();
    ask(&measurement, Some(0), IdentifyOptions { seed: 1, ..IdentifyOptions::default() }).unwrap()
}

#[test]
fn a_bias_is_simulated_in_a_fit_and_without_its_column_the_fit_is_wrong() {
    let text = table();
    let answer = fitted(&text);
    assert!(answer.fit.nrmse < 1e-5, "{:e}", answer.fit.nrmse);
    let error = largest_error(&answer, &g(0));
    assert!(error < 1e-3, "{error:e}");
    let without = fitted(&text.replace(",bias,", ",unused,"));
    assert!(without.fit.nrmse > 0.05, "{:e}", without.fit.nrmse);
}
