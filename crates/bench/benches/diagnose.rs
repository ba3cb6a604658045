//! Time of a diagnosis, of tables and of records of real machines.
//!
//! `cargo bench --bench diagnose`, or of some: `cargo bench --bench diagnose -- table`
//!
//! The records are in `../shared/data`, or where `SERVO_DATA_DIR` says. One that is not there is
//! passed over with a line. Each takes a minute or two, and is diagnosed eleven times.

use std::path::{Path, PathBuf};

use criterion::{Criterion, SamplingMode, criterion_group, criterion_main};
use servoscope_bench::workloads::tables::{Hidden, measured, order_given};
use servoscope_core::diagnose::diagnose;
use servoscope_core::identify::IdentifyRequest;
use servoscope_core::measurement::Measurement;
use servoscope_core::measurement::formats::{Source, read};
use servoscope_core::observer::Silent;

/// Records by name.
const RECORDS: [(&str, &str); 3] = [
    ("emps", "emps/emps.csv"),
    ("motor_bench", "motor-bench/multisine_a.csv"),
    ("flexible_joint", "flexible-joint/multisine.csv"),
];

/// 48 points of 8 harmonics each, the order of the actuator given.
fn tables(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("diagnose_table");
    group.sampling_mode(SamplingMode::Flat);
    for (name, hidden) in Hidden::ALL {
        let machine = hidden.machine();
        let (measurement, request) = (measured(&machine), order_given(&machine));
        group.bench_function(name, |bencher| {
            bencher.iter(|| diagnose(&measurement, &request, &Silent).expect("an answer"));
        });
    }
    group.finish();
}

/// With default options.
fn records(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("diagnose_record");
    group.sampling_mode(SamplingMode::Flat);
    for (name, path) in RECORDS {
        let Some(measurement) = record(path) else { continue };
        group.bench_function(name, |bencher| {
            let request = IdentifyRequest::default();
            bencher.iter(|| diagnose(&measurement, &request, &Silent).expect("an answer"));
        });
    }
    group.finish();
}

/// A record, if it is there.
fn record(path: &str) -> Option<Measurement> {
    let beside = || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data");
    let file = std::env::var_os("SERVO_DATA_DIR").map_or_else(beside, PathBuf::from).join(path);
    if !file.exists() {
        eprintln!("SKIPPED: {} is absent", file.display());
        return None;
    }
    let bytes = std::fs::read(&file).expect("a file that can be read");
    Some(read(&[Source { name: path, bytes: &bytes }]).expect("a measurement"))
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(10);
    targets = tables, records
}
criterion_main!(benches);
