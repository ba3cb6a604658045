//! Time of the exact simulation.
//!
//! `cargo bench --bench simulate`

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use servoscope_core::effects::Wide;
use servoscope_core::measurement::Complex;
use servoscope_core::plant::{Actuator, Friction, Plant};
use servoscope_core::simulate::{Counts, Excitation, respond, respond_with_sensitivities};

fn g1() -> Plant {
    Plant {
        viscous_rate_rad_s: 10.0,
        constant: 10.0,
        actuator: Actuator::Direct,
        friction: Friction::coulomb(0.5, 0.4),
    }
}

/// The same with a, K, Fc⁺ = Fs⁺ and Fc⁻ = Fs⁻ as variables.
fn variable(plant: &Plant) -> Plant<Wide> {
    let Friction { fc_plus, fc_minus, .. } = plant.friction;
    Plant {
        viscous_rate_rad_s: Wide::variable(plant.viscous_rate_rad_s, 0),
        constant: Wide::variable(plant.constant, 1),
        actuator: Actuator::Direct,
        friction: Friction::coulomb(Wide::variable(fc_plus, 2), Wide::variable(fc_minus, 3)),
    }
}

/// The 39 points of the reference file of G1; throughput is points a second.
fn stepped_sine(criterion: &mut Criterion) {
    let points: Vec<Excitation> = [1.0, 2.0, 4.0]
        .into_iter()
        .flat_map(|magnitude| {
            (0..13).map(move |i| Excitation::cosine(10_f64.powf(f64::from(i) / 6.0), magnitude))
        })
        .collect();
    let (plant, variable) = (g1(), variable(&g1()));
    let mut group = criterion.benchmark_group("g1_39_points_harmonics_0_to_9");
    group.throughput(Throughput::Elements(points.len() as u64));
    group.bench_function("response", |bencher| {
        bencher.iter(|| {
            for point in &points {
                black_box(respond(black_box(&plant), &[], point, 9)).expect("a response");
            }
        });
    });
    group.bench_function("with_sensitivities", |bencher| {
        bencher.iter(|| {
            for point in &points {
                black_box(respond_with_sensitivities(
                    Counts::EvenUnstable,
                    black_box(&variable),
                    4,
                    &[],
                    point,
                    9,
                ))
                .expect("a response");
            }
        });
    });
    group.finish();
}

/// Lines in a band that ends at 120 rad/s, and as many lines of zero as lengthen the list
/// to `padded`: they refine the sampling grid and nothing else.
fn multisine(lines: usize, padded: usize) -> Excitation {
    // Schroeder phases keep the crest low: the velocity crosses zero all the time.
    let phase = |k: usize| -std::f64::consts::PI * (k * (k - 1)) as f64 / lines as f64;
    let amplitude = (2.0 / lines as f64).sqrt();
    let mut input = vec![Complex::new(0.0, 0.0)];
    input.extend((1..=lines).map(|k| Complex::from_polar(amplitude, phase(k))));
    input.resize(padded + 1, Complex::new(0.0, 0.0));
    Excitation::new(120.0 / lines as f64, input)
}

/// 240 lines at 1, 2 and 4 times the samples; throughput is the padded lines a second,
/// which stays or grows where cost is linear in samples.
fn samples(criterion: &mut Criterion) {
    let cases = [240, 480, 960].map(|padded| (padded, multisine(240, padded), 240));
    multisines(criterion, "multisine_of_240_lines_on_a_grid_for", cases);
}

/// 1, 2 and 4 times the lines, crossings and harmonics; throughput is lines a second.
fn lines(criterion: &mut Criterion) {
    let cases = [240, 480, 960].map(|lines| (lines, multisine(lines, lines), lines));
    multisines(criterion, "multisine_of", cases);
}

fn multisines(criterion: &mut Criterion, name: &str, cases: [(usize, Excitation, usize); 3]) {
    let (plant, variable) = (g1(), variable(&g1()));
    let mut group = criterion.benchmark_group(name);
    for (size, excitation, highest) in &cases {
        group.throughput(Throughput::Elements(*size as u64));
        group.bench_function(BenchmarkId::new("response", size), |bencher| {
            bencher.iter(|| respond(black_box(&plant), &[], excitation, *highest).expect("one"));
        });
        group.bench_function(BenchmarkId::new("with_sensitivities", size), |bencher| {
            bencher.iter(|| {
                respond_with_sensitivities(
                    Counts::EvenUnstable,
                    black_box(&variable),
                    4,
                    &[],
                    excitation,
                    *highest,
                )
                .expect("one")
            });
        });
    }
    group.finish();
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(20);
    targets = stepped_sine, samples, lines
}
criterion_main!(benches);
