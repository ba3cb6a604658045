//! A real-coded genetic algorithm whose crossover and mutation rates are set by the method.
//!
//! In every generation, parents are chosen by tournaments of two. A pair is crossed with
//! probability p_c by simulated binary crossover,
//!
//! ```text
//!   c₁, c₂ = ½ (x₁ + x₂) ∓ ½ β (x₁ − x₂),   β = (2u)^(1/(η+1)) or (1/(2 − 2u))^(1/(η+1)) for u > ½
//! ```
//!
//! for each gene with probability ½ (K. Deb and R. Agrawal, Complex Systems 9 (1995) 115). Every
//! gene of a child is mutated with probability p_m by a polynomial distribution of index 20 (K. Deb
//! and M. Goyal, Comput. Sci. Inform. 26 (1996) 30). The best individual so far replaces the worst
//! child if no child is better.
//!
//! Fitness is −ln(cost). Costs span many decades, and rates that compare with the mean cost would
//! otherwise depend on the worst individual alone. Scaling the cost shifts the fitness and changes
//! nothing.

use std::convert::Infallible;

use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use super::super::optimiser::{Optimiser, Search, Stop};

/// Number of individuals: 1010 evaluations make fifty generations.
const POPULATION: usize = 20;

/// Distribution index η of the crossover (tuned): children lie near their parents, but not next to
/// them. Deb and Agrawal use 2 to 5 for small populations.
const CROSSOVER_INDEX: f64 = 5.0;

/// Distribution index of the mutation: a gene moves by about 1/20 of its range.
const MUTATION_INDEX: f64 = 20.0;

/// The fitness of a generation.
#[derive(Debug, Clone, Copy)]
pub(super) struct Fitness {
    /// Fitness of the best individual.
    pub best: f64,
    /// Mean fitness of the individuals with a finite cost.
    pub mean: f64,
}

/// How often parents are crossed and genes mutated.
pub(super) trait Rates: Sync {
    /// p_c of a pair; `fitter` is the fitness of the fitter parent.
    fn crossover(&self, fitness: &Fitness, fitter: f64) -> f64;

    /// p_m of each of the `genes` of a child; `of` is the fitness of its parent.
    fn mutation(&self, fitness: &Fitness, of: f64, genes: usize) -> f64;
}

/// The genetic algorithm with its rates.
pub(super) struct Genetic {
    pub stage: &'static str,
    pub rates: &'static dyn Rates,
}

struct Individual {
    genes: Vec<f64>,
    cost: f64,
}

impl Individual {
    fn fitness(&self) -> f64 {
        -self.cost.max(f64::MIN_POSITIVE).ln()
    }
}

impl Optimiser for Genetic {
    fn stage(&self) -> &'static str {
        self.stage
    }

    fn search(&self, search: &mut Search<'_>, rng: &mut ChaCha8Rng) -> Result<Infallible, Stop> {
        let mut genomes = search.population(POPULATION, rng);
        let mut best: Option<Individual> = None;
        loop {
            let costs = search.evaluate(&genomes)?;
            search.report(Some(&costs))?;
            let born = genomes.into_iter().zip(costs);
            let mut people: Vec<Individual> =
                born.map(|(genes, cost)| Individual { genes, cost }).collect();
            people.sort_by(|a, b| a.cost.total_cmp(&b.cost));
            if let Some(elder) = best.filter(|elder| elder.cost < people[0].cost) {
                people.pop();
                people.insert(0, elder);
            }
            genomes = self.children(&people, rng);
            best = Some(people.swap_remove(0));
        }
    }
}

impl Genetic {
    fn children(&self, people: &[Individual], rng: &mut ChaCha8Rng) -> Vec<Vec<f64>> {
        let finite: Vec<f64> =
            people.iter().map(Individual::fitness).filter(|f| f.is_finite()).collect();
        let mean = finite.iter().sum::<f64>() / finite.len().max(1) as f64;
        let fitness = Fitness { best: people[0].fitness(), mean };
        let mut children = Vec::with_capacity(people.len());
        while children.len() < people.len() {
            let parents = [winner(people, rng), winner(people, rng)];
            let fitter = parents[0].fitness().max(parents[1].fitness());
            let mut pair = parents.map(|parent| parent.genes.clone());
            if rng.random_bool(self.rates.crossover(&fitness, fitter).clamp(0.0, 1.0)) {
                cross(&mut pair, rng);
            }
            for (mut child, parent) in pair.into_iter().zip(parents) {
                let rate = self.rates.mutation(&fitness, parent.fitness(), child.len());
                mutate(&mut child, rate.clamp(0.0, 1.0), rng);
                children.push(child);
            }
        }
        children.truncate(people.len());
        children
    }
}

/// The winner of a tournament of two; `people` are sorted by cost.
fn winner<'p>(people: &'p [Individual], rng: &mut ChaCha8Rng) -> &'p Individual {
    let drawn = [rng.random_range(0..people.len()), rng.random_range(0..people.len())];
    &people[drawn[0].min(drawn[1])]
}

fn cross([first, second]: &mut [Vec<f64>; 2], rng: &mut ChaCha8Rng) {
    for (a, b) in first.iter_mut().zip(second) {
        if rng.random_bool(0.5) {
            let spread = crossover_spread(rng.random_range(0.0..1.0));
            let (middle, half) = (0.5 * (*a + *b), 0.5 * spread * (*a - *b));
            *a = (middle + half).clamp(0.0, 1.0);
            *b = (middle - half).clamp(0.0, 1.0);
        }
    }
}

/// β for a uniformly distributed u.
fn crossover_spread(u: f64) -> f64 {
    let odds: f64 = if u <= 0.5 { 2.0 * u } else { 1.0 / (2.0 - 2.0 * u) };
    odds.powf(1.0 / (CROSSOVER_INDEX + 1.0))
}

fn mutate(genes: &mut [f64], rate: f64, rng: &mut ChaCha8Rng) {
    for gene in genes {
        if rng.random_bool(rate) {
            let u: f64 = rng.random_range(0.0..1.0);
            let power = 1.0 / (MUTATION_INDEX + 1.0);
            let step = if u < 0.5 {
                (2.0 * u).powf(power) - 1.0
            } else {
                1.0 - (2.0 - 2.0 * u).powf(power)
            };
            *gene = (*gene + step).clamp(0.0, 1.0);
        }
    }
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;

    use super::*;

    #[test]
    fn a_crossed_pair_keeps_its_mean_and_spreads_as_often_as_it_contracts() {
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        let mut wider = 0;
        for _ in 0..10_000 {
            let mut pair = [vec![0.49], vec![0.51]];
            cross(&mut pair, &mut rng);
            assert!((pair[0][0] + pair[1][0] - 1.0).abs() < 1e-12);
            wider += usize::from((pair[0][0] - pair[1][0]).abs() > 0.02 + 1e-12);
        }
        // Half are crossed, and half of these spread: 2500 ± 4 √(10 000·0.25·0.75).
        assert!((2330..2670).contains(&wider), "{wider}");
    }

    #[test]
    fn fitness_falls_with_the_cost_and_its_differences_do_not_depend_on_scale() {
        let fitness = |cost| Individual { genes: Vec::new(), cost }.fitness();
        let ratio = |scale: f64| fitness(scale) - fitness(10.0 * scale);
        assert!((ratio(1.0) - ratio(1e6)).abs() < 1e-12 && ratio(1.0) > 0.0);
        assert!(fitness(0.0).is_finite() && fitness(f64::INFINITY) == f64::NEG_INFINITY);
    }
}
