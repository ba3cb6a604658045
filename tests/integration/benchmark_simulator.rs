//! The benchmark's simulator against the reference responses of the base model.

use std::collections::BTreeMap;
use std::path::PathBuf;

use serde_json::Value;
use servoscope::benchmark::simulator::{Settings, respond};
use servoscope::measurement::Complex;
use servoscope::plant::{Actuator, Friction, Plant};

fn reference() -> Option<PathBuf> {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../shared/reference");
    let found = folder.join("index.json").is_file();
    if !found {
        eprintln!("SKIPPED: no reference responses in {}", folder.display());
    }
    found.then_some(folder)
}

fn plant_of(entry: &Value) -> Plant {
    let number = |value: &Value| value.as_f64().expect("a number");
    let (plant, friction) = (&entry["plant"], &entry["friction"]);
    let actuator = match entry["actuator_order"].as_u64() {
        Some(0) => Actuator::Direct,
        Some(2) => Actuator::SecondOrder {
            natural_frequency_rad_s: number(&plant["actuator"]["natural_frequency"]),
            damping_ratio: number(&plant["actuator"]["damping_ratio"]),
        },
        order => panic!("actuator order {order:?}"),
    };
    Plant {
        viscous_rate_rad_s: -number(&plant["pole"]),
        constant: number(&plant["constant"]),
        actuator,
        friction: Friction {
            fc_plus: number(&friction["fc_plus"]),
            fc_minus: number(&friction["fc_minus"]),
            fs_plus: number(&friction["fs_plus"]),
            fs_minus: number(&friction["fs_minus"]),
        },
    }
}

/// Magnitude, frequency and harmonics of each point of a file, by its run.
fn points_of(text: &str) -> BTreeMap<u64, (f64, f64, Vec<Complex>)> {
    let mut points = BTreeMap::new();
    for row in csv::Reader::from_reader(text.as_bytes()).deserialize() {
        let (magnitude, omega, harmonic, re, im, run): (f64, f64, usize, f64, f64, u64) =
            row.expect("a row of the reference");
        let point = points.entry(run).or_insert((magnitude, omega, Vec::new()));
        assert_eq!(point.2.len(), harmonic, "harmonics in order");
        point.2.push(Complex::new(re, im));
    }
    points
}

// The references are accurate to 1e-6 of the largest component of their file.
#[test]
fn the_base_model_and_static_friction_agree_with_the_reference_to_2e_6() {
    let Some(folder) = reference() else { return };
    let index = std::fs::read_to_string(folder.join("index.json")).expect("index");
    let index: Vec<Value> = serde_json::from_str(&index).expect("index");
    for file in ["g1.csv", "g2.csv", "g1_static_friction.csv"] {
        let entry = index.iter().find(|entry| entry["file"] == file).expect("an entry");
        let plant = plant_of(entry);
        let points = points_of(&std::fs::read_to_string(folder.join(file)).expect("a file"));
        assert_eq!(points.len(), 39, "{file}");
        let components = || points.values().flat_map(|point| &point.2);
        let largest = components().flat_map(|y| [y.re.abs(), y.im.abs()]).fold(0.0, f64::max);
        let mut worst = 0.0_f64;
        for (magnitude, omega, expected) in points.values() {
            let input = [Complex::new(0.0, 0.0), Complex::new(*magnitude, 0.0)];
            let found = respond(&plant, *omega, &input, 9, &Settings::default())
                .unwrap_or_else(|error| panic!("{file}, {magnitude} at {omega}: {error}"));
            for (found, expected) in found.iter().zip(expected) {
                worst = worst.max((found - expected).norm() / largest);
            }
        }
        assert!(worst <= 2e-6, "{file}: {worst:e}");
    }
}
