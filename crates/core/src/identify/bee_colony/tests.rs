use std::f64::consts::TAU;
use std::sync::atomic::{AtomicUsize, Ordering};

use rand::SeedableRng;

use super::colony::draw_rank;
use super::*;
use crate::answers::ColonyVariant;

struct Function<F> {
    dimension: usize,
    cost: F,
}

impl<F: Fn(&[f64]) -> f64 + Sync> Objective for Function<F> {
    fn dimension(&self) -> usize {
        self.dimension
    }

    fn cost(&self, point: &[f64]) -> f64 {
        (self.cost)(point)
    }
}

fn options(variant: ColonyVariant, food_sources: usize, cycles: usize) -> ColonyOptions {
    ColonyOptions { variant, food_sources, cycles, ..ColonyOptions::default() }
}

fn run<F: Fn(&[f64]) -> f64 + Sync>(
    dimension: usize,
    cost: F,
    options: &ColonyOptions,
    seed: u64,
) -> (Outcome, Vec<Cycle>) {
    let mut history = Vec::new();
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let outcome =
        search(&Function { dimension, cost }, &[], options, &mut rng, &mut |cycle: &Cycle| {
            history.push(*cycle);
            ControlFlow::Continue(())
        });
    (outcome, history)
}

/// Minimum at (0.3, 0.37, 0.44, …), away from centre and edges.
fn sphere(point: &[f64]) -> f64 {
    point.iter().enumerate().map(|(j, x)| (x - 0.3 - 0.07 * j as f64).powi(2)).sum()
}

/// Rosenbrock's function on [−2, 2]², minimum at (1, 1).
fn rosenbrock(point: &[f64]) -> f64 {
    let [x, y] = [4.0 * point[0] - 2.0, 4.0 * point[1] - 2.0];
    (1.0 - x).powi(2) + 100.0 * (y - x * x).powi(2)
}

/// Rastrigin's function on [−4, 6]ⁿ, minimum at 0, one local minimum per unit.
fn rastrigin(point: &[f64]) -> f64 {
    let term = |x: f64| x * x + 10.0 * (1.0 - (TAU * x).cos());
    point.iter().map(|x| term(10.0 * x - 4.0)).sum()
}

fn worst_of_seeds(dimension: usize, cost: fn(&[f64]) -> f64, options: &ColonyOptions) -> f64 {
    (0..5).map(|seed| run(dimension, cost, options, seed).0.cost).fold(0.0, f64::max)
}

// Limits of the costs: within 1e-4 of the minimum in every dimension in the first test, within 1e-6
// in the second.
#[test]
fn the_default_colony_finds_the_bottom_of_a_sphere() {
    assert!(worst_of_seeds(5, sphere, &ColonyOptions::default()) < 1e-8);
}

#[test]
fn the_literal_colony_finds_the_bottom_of_a_sphere_in_more_cycles() {
    assert!(worst_of_seeds(5, sphere, &options(ColonyVariant::Literal, 10, 200)) < 1e-12);
}

// On the valley floor, a cost of 1e-4 is within 0.01 of the minimum.
#[test]
fn the_default_variant_follows_the_curved_valley_of_rosenbrock() {
    assert!(worst_of_seeds(2, rosenbrock, &options(ColonyVariant::GlobalBest, 20, 200)) < 1e-4);
}

// The nearest local minimum costs 1. A cost of 1e-6 is within 1e-4 of the global minimum.
#[test]
fn both_variants_find_the_right_basin_of_rastrigin() {
    for variant in [ColonyVariant::GlobalBest, ColonyVariant::Literal] {
        assert!(worst_of_seeds(4, rastrigin, &options(variant, 20, 200)) < 1e-6, "{variant:?}");
    }
}

#[test]
fn ten_sources_and_fifty_cycles_are_exactly_1010_evaluations_scouts_included() {
    for limit in [None, Some(1)] {
        let calls = AtomicUsize::new(0);
        let options = ColonyOptions { abandonment_limit: limit, ..ColonyOptions::default() };
        let counted = |point: &[f64]| {
            calls.fetch_add(1, Ordering::Relaxed);
            rastrigin(point)
        };
        let (outcome, history) = run(4, counted, &options, 3);
        assert_eq!(calls.load(Ordering::Relaxed), 1010);
        assert_eq!(outcome.evaluations, 1010);
        assert_eq!(outcome.stop, StopReason::CyclesDone);
        let expected: Vec<usize> = (0..=50).map(|cycle| 10 + 20 * cycle).collect();
        assert_eq!(history.iter().map(|cycle| cycle.evaluations).collect::<Vec<_>>(), expected);
    }
}

#[test]
fn the_search_is_bit_identical_at_one_and_four_threads() {
    let within = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| run(4, rastrigin, &ColonyOptions::default(), 7))
    };
    assert_eq!(within(1), within(4));
}

#[test]
fn another_seed_is_another_search() {
    let options = ColonyOptions::default();
    assert_ne!(run(4, rastrigin, &options, 1).0.best, run(4, rastrigin, &options, 2).0.best);
}

#[test]
fn scaling_the_cost_does_not_change_the_search() {
    for variant in [ColonyVariant::GlobalBest, ColonyVariant::Literal] {
        let options = options(variant, 10, 50);
        let (plain, _) = run(4, rastrigin, &options, 5);
        let (scaled, _) = run(4, |point| 1e-6 * rastrigin(point), &options, 5);
        assert_eq!(plain.best, scaled.best);
        assert_eq!(plain.abandoned, scaled.abandoned);
    }
}

#[test]
fn sources_that_keep_failing_are_abandoned_but_never_the_best() {
    let impatient = ColonyOptions { abandonment_limit: Some(2), ..ColonyOptions::default() };
    let (outcome, history) = run(4, rastrigin, &impatient, 11);
    assert!(outcome.abandoned > 10, "{}", outcome.abandoned);
    assert!(history.windows(2).all(|pair| pair[1].best_cost <= pair[0].best_cost));
    assert!(
        history.windows(2).any(|pair| pair[1].mean_cost > pair[0].mean_cost),
        "a scout brings a worse source"
    );

    let patient = ColonyOptions { abandonment_limit: Some(100_000), ..ColonyOptions::default() };
    assert_eq!(run(4, rastrigin, &patient, 11).0.abandoned, 0);
}

#[test]
fn initial_sources_are_used_and_clamped_to_the_cube() {
    let objective = Function { dimension: 2, cost: rosenbrock };
    let answer = vec![0.75, 0.75];
    let short = ColonyOptions { cycles: 1, ..ColonyOptions::default() };
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    let mut first = None;
    let outcome = search(
        &objective,
        &[answer.clone(), vec![-3.0, 9.0]],
        &short,
        &mut rng,
        &mut |cycle: &Cycle| {
            first.get_or_insert(cycle.best_cost);
            ControlFlow::Continue(())
        },
    );
    assert_eq!(first, Some(0.0));
    assert_eq!((outcome.best, outcome.cost), (answer, 0.0));

    let edge = Function { dimension: 2, cost: |p: &[f64]| -> f64 { p.iter().sum() } };
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    let outcome = search(&edge, &[vec![-1.0, -1.0]], &short, &mut rng, &mut |_: &Cycle| {
        ControlFlow::Continue(())
    });
    assert_eq!(outcome.best, [0.0, 0.0]);
}

#[test]
fn points_without_a_cost_are_never_preferred() {
    let half = |point: &[f64]| if point[0] > 0.5 { f64::NAN } else { sphere(point) };
    let (outcome, _) = run(3, half, &ColonyOptions::default(), 2);
    assert!(outcome.cost < 1e-4 && outcome.best[0] <= 0.5);

    let (outcome, history) = run(3, |_: &[f64]| f64::NAN, &ColonyOptions::default(), 2);
    assert_eq!((outcome.cost, outcome.evaluations), (f64::INFINITY, 1010));
    assert_eq!(history[50].mean_cost, f64::INFINITY);
}

#[test]
fn breaking_ends_the_search_with_the_best_so_far() {
    let objective = Function { dimension: 4, cost: rastrigin };
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    let mut seen = f64::NAN;
    let outcome =
        search(&objective, &[], &ColonyOptions::default(), &mut rng, &mut |cycle: &Cycle| {
            seen = cycle.best_cost;
            if cycle.cycle == 3 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        });
    assert_eq!((outcome.stop, outcome.evaluations), (StopReason::Cancelled, 70));
    assert_eq!(outcome.cost, seen);
}

#[test]
fn onlookers_prefer_good_ranks_linearly() {
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    let draws = 40_000;
    let mut counts = [0_usize; 4];
    for _ in 0..draws {
        counts[draw_rank(4, &mut rng)] += 1;
    }
    for (rank, count) in counts.into_iter().enumerate() {
        let probability = (4 - rank) as f64 / 10.0;
        // Five binomial standard deviations.
        let margin = 5.0 * (probability * (1.0 - probability) / draws as f64).sqrt();
        assert!((count as f64 / draws as f64 - probability).abs() < margin, "rank {rank}");
    }
}
