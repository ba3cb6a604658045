//! Numbers at the edges of what floating point holds, through a whole diagnosis.

use servoscope_core::answers::{Answer, IdentifyOptions, PlantRequest};
use servoscope_core::diagnose::diagnose;
use servoscope_core::identify::IdentifyRequest;
use servoscope_core::measurement::Measurement;
use servoscope_core::measurement::formats::{ParseError, Source, read};
use servoscope_core::observer::Silent;

use crate::process::simulated;

/// A simulated measurement of 12 experiments in other units: each column times a factor.
fn in_units(input: f64, omega: f64, response: f64) -> Result<Measurement, ParseError> {
    let magnitudes = ["--magnitudes", "1,2,4", "--frequencies-rad-s", "1,3,10,30"];
    let table = simulated(
        &[&magnitudes[..], &["--fs-plus", "0.8", "--fs-minus", "0.6", "--noise-db", "60"]].concat(),
    );
    let table = String::from_utf8(table).unwrap();
    let mut rows = table.lines().filter(|line| !line.starts_with('#'));
    let names: Vec<&str> = rows.next().unwrap().split(',').collect();
    let scaled = rows.map(|row| {
        let cells = names.iter().zip(row.split(',')).map(|(name, cell)| {
            let factor = match *name {
                "magnitude" => input,
                "omega_rad_s" => omega,
                "re" | "im" | "std" => response,
                _ => 1.0,
            };
            cell.parse::<f64>().map_or(String::new(), |value| format!("{:e}", value * factor))
        });
        cells.collect::<Vec<_>>().join(",")
    });
    let text = format!("{}\n{}\n", names.join(","), scaled.collect::<Vec<_>>().join("\n"));
    read(&[Source { name: "a.csv", bytes: text.as_bytes() }])
}

/// A small search: what is asked is whether numbers hold.
fn diagnosed(measurement: &Measurement) -> Answer {
    let mut options = IdentifyOptions { most_effects: 1, ..IdentifyOptions::default() };
    options.network.enabled = false;
    options.colony.cycles = 10;
    let plant = Some(PlantRequest { actuator_order: 0 });
    let request = IdentifyRequest { plant, options, ..IdentifyRequest::default() };
    diagnose(measurement, &request, &Silent).expect("an answer").into()
}

// The units are divided out before anything is computed, by factors that are not powers of 2: the
// answers differ by rounding, which a search may make larger.
#[test]
fn a_diagnosis_is_the_same_in_units_of_thirty_decades_either_way() {
    let usual = diagnosed(&in_units(1.0, 1.0, 1.0).unwrap());
    let causes = |answer: &Answer| -> Vec<String> {
        answer.causes().iter().map(|cause| cause.effect.clone()).collect()
    };
    assert_eq!(causes(&usual), ["static_friction"]);
    for (input, omega, response) in
        [(1e30, 1.0, 1e-30), (1e-30, 1.0, 1e30), (1.0, 1e15, 1.0), (1e35, 1e-15, 1e35)]
    {
        let answer = diagnosed(&in_units(input, omega, response).unwrap());
        let units = format!("{input:e} {omega:e} {response:e}");
        assert_eq!(
            (answer.verdict(), causes(&answer)),
            (usual.verdict(), causes(&usual)),
            "{units}"
        );
        // Of a velocity, the constant is velocity/(input·s).
        let constant = |answer: &Answer| answer.base().parameters["constant"].value.unwrap();
        let ratio = constant(&answer) / constant(&usual) / (response / input * omega);
        assert!((ratio - 1.0).abs() < 1e-3, "{units}: {ratio}");
        let json = serde_json::to_string(&answer).unwrap();
        assert!(Answer::from_json(&json).is_ok(), "{units}: a number cannot be written");
    }
}

#[test]
fn what_cannot_be_computed_with_is_refused_before_it_is() {
    for (input, omega, response) in [
        (1e60, 1.0, 1.0),
        (1e-60, 1.0, 1.0),
        (1.0, 1e40, 1.0),
        (1.0, 1e-40, 1.0),
        (1.0, 1.0, 1e300),
        (1e308, 1e308, 1e308),
        (5e-324, 1.0, 5e-324),
    ] {
        let refused = in_units(input, omega, response).unwrap_err().to_string();
        assert!(!refused.is_empty(), "{input:e} {omega:e} {response:e}");
    }
}
