//! Time of an identification with default options.
//!
//! `cargo bench --bench identify`

use criterion::{Criterion, criterion_group, criterion_main};
use servoscope_bench::workloads::tables::{g1, g2, measured, order_given};
use servoscope_core::identify::{IdentifyRequest, identify};
use servoscope_core::observer::Silent;

fn identification(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("identify");
    for (name, machine) in [("g1", g1()), ("g2", g2())] {
        let measurement = measured(&machine);
        for (case, request) in [
            ("order_given", order_given(&machine)),
            ("order_left_to_the_data", IdentifyRequest::default()),
        ] {
            group.bench_function(format!("{name}/{case}"), |bencher| {
                bencher.iter(|| identify(&measurement, &request, &Silent).expect("an answer"));
            });
        }
    }
    group.finish();
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(10);
    targets = identification
}
criterion_main!(benches);
