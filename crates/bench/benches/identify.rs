//! Time of an identification with default options.
//!
//! `cargo bench --bench identify`

use criterion::{Criterion, criterion_group, criterion_main};
use servoscope_bench::machines::draw::{Draw, NoiseStatement, measure};
use servoscope_core::answers::PlantRequest;
use servoscope_core::identify::{IdentifyRequest, identify};
use servoscope_core::observer::Silent;
use servoscope_core::plant::{Actuator, Friction, Plant};

/// G1 or G2 as its reference file measures it: 39 points, harmonics 0 to 9, no noise.
fn machine(actuator: Actuator, highest_rad_s: f64) -> Draw {
    let plant = Plant {
        viscous_rate_rad_s: 10.0,
        constant: 10.0,
        actuator,
        friction: Friction::coulomb(0.5, 0.4),
    };
    let design = [1.0, 2.0, 4.0]
        .into_iter()
        .flat_map(|m| (0..13).map(move |i| (m, highest_rad_s.powf(f64::from(i) / 12.0))))
        .collect();
    Draw {
        plant,
        effects: Vec::new(),
        design,
        harmonics: 9,
        noise_db: None,
        noise_statement: NoiseStatement::Silent,
    }
}

fn identification(criterion: &mut Criterion) {
    let resonance = Actuator::SecondOrder {
        natural_frequency_rad_s: 1000.0_f64.sqrt(),
        damping_ratio: 2.5 / 1000.0_f64.sqrt(),
    };
    let mut group = criterion.benchmark_group("identify");
    for (name, machine) in
        [("g1", machine(Actuator::Direct, 100.0)), ("g2", machine(resonance, 80.0))]
    {
        let measurement = measure(&machine, 1).expect("a periodic response");
        let actuator_order = machine.plant.actuator.order();
        for (case, plant) in [
            ("order_given", Some(PlantRequest { actuator_order })),
            ("order_left_to_the_data", None),
        ] {
            let request = IdentifyRequest { plant, ..IdentifyRequest::default() };
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
