//! Time of one point of an axis with each effect, with the derivatives that a fit asks for.
//!
//! `cargo bench --bench points`, or of some: `cargo bench --bench points -- spring`
//!
//! One machine of order 0 with each effect. The bench `effects` has the medians over many machines.

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use servoscope_bench::naming::effect_draws::ids;
use servoscope_bench::workloads::axes::AxisWithEffect;

/// The mean over the 48 points of the axis's design.
fn with_gradient(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("point_with_gradient");
    for id in ids() {
        let axis = AxisWithEffect::draw(id, 0, 1);
        let mut points = axis.points.iter().cycle();
        group.bench_function(id, |bencher| {
            bencher
                .iter(|| points.next().map(|point| axis.respond_with_gradient(black_box(point))));
        });
    }
    group.finish();
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(20);
    targets = with_gradient
}
criterion_main!(benches);
