//! The two systems of the contract and their reference responses.

use std::collections::BTreeMap;

use serde_json::Value;
use servoscope_bench::machines::draw::{Draw, NoiseStatement, measure};
use servoscope_core::measurement::formats::{self, Source};
use servoscope_core::measurement::{Complex, Measurement};
use servoscope_core::plant::{Actuator, Friction, Plant};

use crate::shared_files::{reference, shared};

/// One experiment of a reference file.
pub struct Point {
    pub magnitude: f64,
    pub omega_rad_s: f64,
    /// Position in the order of acquisition.
    pub run: u64,
    /// Y₀ … Y_H.
    pub harmonics: Vec<Complex>,
}

/// G1 (actuator order 0) or G2 (order 2) of the contract's section 1.
pub fn g(order: u8) -> Plant {
    let actuator = match order {
        2 => Actuator::SecondOrder {
            natural_frequency_rad_s: 1000.0_f64.sqrt(),
            damping_ratio: 2.5 / 1000.0_f64.sqrt(),
        },
        _ => Actuator::Direct,
    };
    Plant {
        viscous_rate_rad_s: 10.0,
        constant: 10.0,
        actuator,
        friction: Friction::coulomb(0.5, 0.4),
    }
}

/// What the reference files of G1 and G2 hold, as a draw without noise: magnitudes 1, 2
/// and 4 at 13 frequencies, harmonics 0 to 9.
pub fn g_draw(order: u8) -> Draw {
    let highest_rad_s: f64 = if order == 2 { 80.0 } else { 100.0 };
    let design = [1.0, 2.0, 4.0]
        .into_iter()
        .flat_map(|m| (0..13).map(move |i| (m, highest_rad_s.powf(f64::from(i) / 12.0))))
        .collect();
    Draw {
        plant: g(order),
        effects: Vec::new(),
        design,
        harmonics: 9,
        noise_db: None,
        noise_statement: NoiseStatement::Silent,
    }
}

/// G1 or G2 without noise, from the independent simulator.
pub fn g_measurement(order: u8) -> Measurement {
    measure(&g_draw(order), 1).expect("G1 and G2 have periodic responses")
}

/// A reference file as a measurement.
pub fn measurement(name: &str) -> Measurement {
    let bytes = std::fs::read(reference(name)).expect("a readable reference");
    formats::read(&[Source { name, bytes: &bytes }]).expect("a valid reference")
}

/// Points of a reference file in the order of acquisition.
pub fn points(name: &str) -> Vec<Point> {
    let mut reader = csv::Reader::from_path(reference(name)).expect("a readable reference");
    let mut points: BTreeMap<u64, Point> = BTreeMap::new();
    for row in reader.deserialize() {
        let (magnitude, omega_rad_s, harmonic, re, im, run): (f64, f64, usize, f64, f64, u64) =
            row.expect("a row of the reference");
        let point = points.entry(run).or_insert(Point {
            magnitude,
            omega_rad_s,
            run,
            harmonics: Vec::new(),
        });
        assert_eq!(point.harmonics.len(), harmonic, "harmonics in order");
        point.harmonics.push(Complex::new(re, im));
    }
    points.into_values().collect()
}

/// The index of the reference files.
fn index() -> Vec<Value> {
    let index = std::fs::read_to_string(reference("index.json")).expect("an index");
    serde_json::from_str(&index).expect("an index")
}

/// Names of every reference file.
pub fn names() -> Vec<String> {
    let name = |entry: &Value| entry["file"].as_str().expect("a name").to_owned();
    let names: Vec<String> = index().iter().map(name).collect();
    assert_eq!(names.len(), 21);
    names
}

/// What the index says of a reference file.
fn entry(name: &str) -> Value {
    index().into_iter().find(|entry| entry["file"] == name).expect("an entry")
}

/// Id and parameters of the effect in a reference file, if it has one.
pub fn effect(name: &str) -> Option<(String, BTreeMap<String, f64>)> {
    let effect = entry(name)["effect"].take();
    let id = effect["name"].as_str()?.to_owned();
    let parameters = serde_json::from_value(effect["parameters"].clone()).expect("parameters");
    Some((id, parameters))
}

/// Plant and friction of a reference file, from the index beside it.
pub fn plant(name: &str) -> Plant {
    let entry = entry(name);
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

/// Largest deviation of simulated harmonics from a reference file, as a share of the
/// file's largest component.
pub fn largest_deviation(name: &str, simulate: impl Fn(&Plant, &Point) -> Vec<Complex>) -> f64 {
    let points = points(name);
    assert_eq!(points.len(), 39, "{name}");
    let plant = plant(name);
    let (mut worst, mut largest) = (0.0_f64, 0.0_f64);
    for point in &points {
        let simulated = simulate(&plant, point);
        assert_eq!(simulated.len(), point.harmonics.len());
        for (simulated, expected) in simulated.iter().zip(&point.harmonics) {
            worst = worst.max((simulated - expected).norm());
            largest = largest.max(expected.re.abs()).max(expected.im.abs());
        }
    }
    worst / largest
}

/// Where the originals are at hand, the copies in this repository are still the same.
#[test]
fn the_contract_and_its_reference_responses_are_copied_to_the_letter() {
    let read = |path: &std::path::Path| std::fs::read(path).expect("a readable file");
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
    if let Some(contract) = shared("contract.md") {
        assert!(read(&contract) == read(&root.join("docs/contract.md")), "docs/contract.md");
    }
    let Some(folder) = shared("reference") else { return };
    let files: Vec<_> = std::fs::read_dir(folder).expect("a folder").collect();
    assert_eq!(files.len(), names().len() + 1);
    for file in files {
        let file = file.expect("a file");
        let name = file.file_name();
        let copy = reference(name.to_str().expect("a name"));
        assert!(read(&file.path()) == read(&copy), "{}", copy.display());
    }
}
