//! What the network and the bee colony do, each on its own.

use rayon::prelude::*;
use servoscope_bench::machines::draw::{Draw, NoiseStatement, draw, measure};
use servoscope_core::answers::{ColonyOptions, Identification, IdentifyOptions, NetworkOptions};
use servoscope_core::measurement::Measurement;

use crate::machines::{Watcher, ask, ask_watched, largest_error, median, relative_errors};
use crate::reference::{g, g_draw, g_measurement};

const WITHOUT_NETWORK: NetworkOptions =
    NetworkOptions { enabled: false, hidden_neurons: 20, training_plants: 800, epochs: 60 };

/// Network and colony alone: no closed form before, no refinement after them.
fn search_only(seed: u64) -> IdentifyOptions {
    IdentifyOptions { seed, closed_form_start: false, refine: false, ..IdentifyOptions::default() }
}

// Every plant is new to the network, which is trained on draws of its own range.
#[test]
#[ignore = "slow: 100 networks to train"]
fn the_network_alone_has_a_median_error_of_at_most_15_percent_over_100_plants() {
    let errors: Vec<(u8, f64)> = (0..100_u64)
        .into_par_iter()
        .flat_map_iter(|index| {
            let machine = draw((index % 3) as u8, 1000 + index);
            let order = machine.plant.actuator.order();
            let measurement = measure(&machine, 2000 + index).expect("a periodic response");
            let colony = ColonyOptions { enabled: false, ..ColonyOptions::default() };
            let options = IdentifyOptions { colony, ..search_only(index) };
            let answer = ask(&measurement, Some(order), options).expect("an answer");
            assert_eq!(stages(&answer), ["network"]);
            let errors = relative_errors(&answer, &machine.plant);
            errors.into_iter().map(move |(_, error)| (order, error))
        })
        .collect();
    for order in 0..3 {
        let of_order = errors.iter().filter(|(o, _)| *o == order).map(|(_, error)| *error);
        println!("order {order}: median error {:.3}", median(&of_order.collect::<Vec<_>>()));
    }
    let overall = median(&errors.iter().map(|(_, error)| *error).collect::<Vec<_>>());
    println!("overall: {overall:.3}");
    assert!(overall <= 0.15, "{overall}");
}

#[test]
fn the_colony_alone_comes_within_1_percent_on_g1_in_1010_evaluations() {
    let measurement = g_measurement(0);
    let errors: Vec<f64> = (1..=20)
        .into_par_iter()
        .map(|seed| {
            let options = IdentifyOptions { network: WITHOUT_NETWORK, ..search_only(seed) };
            let answer = ask(&measurement, Some(0), options).expect("an answer");
            assert_eq!(stages(&answer), ["colony"]);
            assert_eq!(answer.stages[0].evaluations, 1010);
            largest_error(&answer, &g(0))
        })
        .collect();
    let median = median(&errors);
    println!("largest parameter error, median of 20 seeds: {median:.1e}");
    assert!(median <= 0.01, "{median}");
}

// The colony's evaluations are compared; the 800 simulations the network is trained on
// stand in its own stage. 40 of 50 against even odds have a probability of 1e-5. The
// upper quartile of the ratios lies near 0.45, and so the median below it.
#[test]
#[ignore = "slow: 50 networks to train and 100 colonies"]
fn started_from_the_network_the_colony_needs_clearly_fewer_evaluations() {
    let g = |order| Draw {
        noise_db: Some(60.0),
        noise_statement: NoiseStatement::Std,
        ..g_draw(order)
    };
    let machines: Vec<Draw> = (0..10)
        .flat_map(|_| [g(0), g(2)])
        .chain((0..30).map(|i| draw((i % 3) as u8, 3000 + i)))
        .collect();
    let counts: Vec<(u64, u64)> = machines
        .par_iter()
        .enumerate()
        .map(|(index, machine)| {
            let seed = index as u64;
            let measurement = measure(machine, seed).expect("a periodic response");
            let order = machine.plant.actuator.order();
            let count = |network| {
                let options = IdentifyOptions { network, ..search_only(seed) };
                evaluations_to_5_percent(&measurement, order, options)
            };
            (count(NetworkOptions::default()), count(WITHOUT_NETWORK))
        })
        .collect();
    let ratios: Vec<f64> =
        counts.iter().map(|(with, without)| *with as f64 / *without as f64).collect();
    let fewer = counts.iter().filter(|(with, without)| with < without).count();
    println!("median ratio {:.2}; fewer in {fewer} of {}", median(&ratios), ratios.len());
    assert!(median(&ratios) < 0.45, "{ratios:?}");
    assert!(fewer >= 40, "{counts:?}");
}

/// Evaluations after which the colony's best source leaves an NRMSE of at most 5 %.
fn evaluations_to_5_percent(measurement: &Measurement, order: u8, options: IdentifyOptions) -> u64 {
    let harmonics = measurement.experiments().iter().flat_map(|e| &e.response);
    let size: f64 = harmonics.map(|h| h.value.norm_sqr() / h.std.unwrap().powi(2)).sum();
    let watcher = Watcher::patient();
    ask_watched(measurement, Some(order), options, &watcher).expect("an answer");
    let rows = watcher.rows();
    let mut of_colony = rows.iter().filter(|row| row.stage == "colony");
    let last = of_colony.clone().next_back().expect("rows of the colony").evaluations;
    of_colony.find(|row| row.best <= 0.05_f64.powi(2) * size).map_or(last, |row| row.evaluations)
}

fn stages(answer: &Identification) -> Vec<&str> {
    answer.stages.iter().map(|stage| stage.name.as_str()).collect()
}
