//! Tests that hold for every method, those of `servoscope-core` included.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicUsize, Ordering};

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use super::*;
use servoscope_core::answers::IdentifyOptions;
use servoscope_core::identify::bee_colony::{Objective, uniform};
use servoscope_core::identify::optimiser::{Descent, Generation, Search, Smooth, Stop};

/// The minimum of the valley.
const LOWEST: [f64; 4] = [0.3, 0.62, 0.45, 0.7];

/// A quadratic valley, 100 times as steep across as along, not aligned with the coordinates.
#[derive(Default)]
struct Valley {
    evaluated: AtomicUsize,
}

impl Objective for Valley {
    fn dimension(&self) -> usize {
        LOWEST.len()
    }

    fn cost(&self, point: &[f64]) -> f64 {
        assert!(point.iter().all(|x| (0.0..=1.0).contains(x)), "{point:?} is outside the cube");
        self.evaluated.fetch_add(1, Ordering::Relaxed);
        let off: Vec<f64> = point.iter().zip(LOWEST).map(|(x, lowest)| x - lowest).collect();
        let along: f64 = off.iter().sum();
        let across: f64 = off.iter().map(|x| x * x).sum::<f64>() - along * along / 4.0;
        1.0 + along * along / 4.0 + 100.0 * across
    }
}

impl Smooth for Valley {
    /// Halves the distance to the minimum with every two evaluations.
    fn descend(&self, from: &[f64], most: usize, on_step: &mut dyn FnMut(usize, f64)) -> Descent {
        let mut point = from.to_vec();
        let mut evaluations = 0;
        while evaluations + 2 <= most.min(30) {
            point.iter_mut().zip(LOWEST).for_each(|(x, lowest)| *x = 0.5 * (*x + lowest));
            evaluations += 2;
            on_step(evaluations, self.cost(&point));
        }
        self.evaluated.fetch_add(evaluations / 2, Ordering::Relaxed);
        Descent { cost: self.cost(&point), point, evaluations: evaluations.max(1) }
    }
}

struct Searched {
    generations: Vec<Generation>,
    best: Option<(Vec<f64>, f64)>,
    used: usize,
    stop: Stop,
}

fn searched(method: Method, budget: usize, seed: u64, most_generations: usize) -> Searched {
    let valley = Valley::default();
    let options = IdentifyOptions { evaluation_budget: Some(budget), ..Default::default() };
    let optimiser = METHODS.steps(method).unwrap().search.expect("a method that searches");
    let mut generations = Vec::new();
    let mut watch = |generation: &Generation| {
        generations.push(*generation);
        match generations.len() < most_generations {
            true => ControlFlow::Continue(()),
            false => ControlFlow::Break(()),
        }
    };
    let allowed = optimiser.budget(&options);
    let mut search = Search::new(&valley, &[], &options, allowed, &mut watch);
    let Err(stop) = optimiser.search(&mut search, &mut ChaCha8Rng::seed_from_u64(seed));
    let best = search.best().map(|(point, cost)| (point.to_vec(), cost));
    let used = search.used();
    Searched { generations, best, used, stop }
}

fn searching() -> impl Iterator<Item = Method> {
    Method::all().filter(|method| METHODS.steps(*method).unwrap().search.is_some())
}

#[test]
fn every_method_has_its_stages_and_all_but_the_closed_form_a_search_of_its_own_name() {
    let stages: Vec<&str> =
        searching().map(|method| METHODS.steps(method).unwrap().search.unwrap().stage()).collect();
    assert_eq!(stages.len(), Method::all().count() - 1);
    assert!((1..stages.len()).all(|i| !stages[..i].contains(&stages[i])), "{stages:?}");
    assert!(METHODS.steps(Method::TwoMagnitude).unwrap().search.is_none());
}

#[test]
fn every_search_stops_at_its_budget_and_counts_what_it_spends() {
    for method in searching() {
        for budget in [10, 27, 1010] {
            let name = method.name();
            let Searched { generations, used, stop, best, .. } =
                searched(method, budget, 1, usize::MAX);
            assert!(used <= budget, "{name}: {used} of {budget}");
            assert!(best.is_some(), "{name}");
            let known = [Stop::BudgetSpent, Stop::EveryCycleEnded, Stop::EveryStartDescended];
            assert!(known.contains(&stop), "{name}: {stop:?}");
            let counts: Vec<usize> = generations.iter().map(|g| g.evaluations).collect();
            assert!(counts.windows(2).all(|pair| pair[0] <= pair[1]), "{name}: {counts:?}");
            assert!(counts.iter().all(|count| *count <= used), "{name}: {counts:?} of {used}");
            let falls = generations.windows(2).all(|pair| pair[1].best <= pair[0].best);
            assert!(falls || method == Method::LeastSquares, "{name}");
        }
    }
}

// Each search has as many evaluations as the paper's colony, and no proposal. The median of ten
// seeds must beat the median of twenty batches of as many random points. All but `aga-ann`, whose
// rates disrupt solutions below the mean, also beat the best of the twenty.
#[test]
fn every_search_comes_down_a_narrow_valley_further_than_drawing_points_does() {
    let drawn = (1..=20).map(|seed| {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let points = (0..1010).map(|_| uniform(LOWEST.len(), &mut rng));
        points.map(|point| Valley::default().cost(&point)).fold(f64::INFINITY, f64::min)
    });
    let mut drawn: Vec<f64> = drawn.collect();
    drawn.sort_by(f64::total_cmp);
    for method in searching() {
        let cost = |seed| searched(method, 1010, seed, usize::MAX).best.unwrap().1;
        let mut costs: Vec<f64> = (1..=10).map(cost).collect();
        costs.sort_by(f64::total_cmp);
        assert!(costs[5] < drawn[10], "{}: {costs:?}, drawing {drawn:?}", method.name());
        assert!(costs[5] < drawn[0] || method == Method::AgaAnn, "{}: {costs:?}", method.name());
    }
}

#[test]
fn the_same_seed_gives_the_same_bits_and_another_one_does_not() {
    for method in searching() {
        let best = |seed| searched(method, 300, seed, usize::MAX).best;
        assert_eq!(best(3), best(3), "{}", method.name());
        assert_ne!(best(3), best(4), "{}", method.name());
    }
}

#[test]
fn every_search_ends_where_its_watcher_asks_for_it() {
    for method in searching() {
        let Searched { generations, stop, .. } = searched(method, 1010, 1, 3);
        assert_eq!((generations.len(), stop), (3, Stop::Cancelled), "{}", method.name());
    }
}
