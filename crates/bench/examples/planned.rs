//! Whether plans name more than logarithmic sweeps of the same duration.
//!
//! `cargo run --release -p servoscope-bench --example planned -- MACHINES SEED [BUDGET [NOISE_DB [LEAST_SIZE]]]`
//! prints a line for each machine and the comparison of both.

use std::error::Error;

use servoscope_bench::planning::{Paired, Settings, trial};
use servoscope_core::observer::Silent;

fn main() -> Result<(), Box<dyn Error>> {
    let given: Vec<String> = std::env::args().skip(1).collect();
    let number = |index: usize, default: f64| -> Result<f64, Box<dyn Error>> {
        Ok(given.get(index).map_or(Ok(default), |text| text.parse())?)
    };
    let default = Settings::default();
    let machines = number(0, 20.0)? as usize;
    let settings = Settings {
        seed: number(1, 1.0)? as u64,
        budget: number(2, default.budget)?,
        noise_db: number(3, default.noise_db)?,
        least_size: number(4, default.least_size)?,
        ..default
    };
    println!("{settings:?}");
    let (mut first, mut equivalent) = (Paired::default(), Paired::default());
    let mut unmade = 0;
    for index in 0..machines {
        match trial(index, &settings, &Silent) {
            Ok(trial) => {
                let (plan, sweep) = (&trial.planned, &trial.swept);
                first.add(plan.first, sweep.first);
                equivalent.add(plan.equivalent, sweep.equivalent);
                let mark = |named: bool| if named { "named" } else { "-" };
                println!(
                    "{index:3} {:20} o{} plan {:5} {:2} in {:6.2} s {:?}; sweep {:5} {:2} in {:6.2} s {:?}; expected {:.2} {:.2}",
                    trial.effect,
                    trial.order,
                    mark(plan.equivalent),
                    plan.experiments,
                    plan.duration_s,
                    plan.named,
                    mark(sweep.equivalent),
                    sweep.experiments,
                    sweep.duration_s,
                    sweep.named,
                    trial.expected[0],
                    trial.expected[1],
                );
            }
            Err(error) => {
                unmade += 1;
                println!("{index:3} not made: {error}");
            }
        }
    }
    for (what, paired) in [("named first", first), ("first or an equivalent", equivalent)] {
        let [plan, sweep] = paired.rates();
        println!(
            "{what}: plan {} of {}, sweep {} of {}; only the plan {}, only the sweep {}, p = {:.2e}",
            plan.hits,
            plan.of,
            sweep.hits,
            sweep.of,
            paired.first,
            paired.second,
            paired.p_value()
        );
    }
    println!("{unmade} not made");
    Ok(())
}
