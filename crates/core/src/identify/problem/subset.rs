//! A part of the data of a problem.

use crate::identify::noise::Weights;
use crate::measurement::Complex;

use super::{Prepared, Problem, Target};

/// Which targets of a problem are kept, by experiment.
pub(in crate::identify) struct Subset {
    kept: Vec<Vec<bool>>,
}

impl Problem {
    /// The targets that `keep` wants, given the index of their experiment. A constraint is kept
    /// where any datum of its experiment is, and lost where none is.
    pub fn subset(&self, keep: impl Fn(usize, &Target) -> bool) -> Subset {
        let of = |(e, experiment): (usize, &Prepared)| -> Vec<bool> {
            let data = || experiment.targets.iter().filter(|target| !target.constraint);
            let any = data().any(|target| keep(e, target));
            let targets = experiment.targets.iter();
            targets.map(|target| if target.constraint { any } else { keep(e, target) }).collect()
        };
        Subset { kept: self.experiments.iter().enumerate().map(of).collect() }
    }

    /// The same problem with these data alone. Experiments without data remain, and are never
    /// simulated.
    pub fn only(&self, subset: &Subset) -> Self {
        let mut rest = self.clone();
        for (e, experiment) in rest.experiments.iter_mut().enumerate() {
            experiment.targets = subset.of(e, &experiment.targets);
            experiment.highest = experiment.targets.last().map_or(0, |target| target.order);
            let columns = experiment.unknown_input.columns.iter_mut();
            columns.for_each(|column| *column = subset.of(e, column));
        }
        rest
    }
}

impl Subset {
    /// The weights of these data alone, of which `rest` is the problem.
    pub fn weights(&self, weights: &Weights, rest: &Problem) -> Weights {
        let Weights { sigma, scatter, law, .. } = weights;
        let kept: Vec<bool> = self.kept.iter().flatten().copied().collect();
        Weights {
            law: law.as_ref().map(|law| law.only(&kept)),
            sigma: sigma.iter().enumerate().map(|(e, all)| self.of(e, all)).collect(),
            scatter: scatter.iter().enumerate().map(|(e, all)| self.of(e, all)).collect(),
            eliminated: Vec::new(),
            correlations: weights.correlations.clone(),
            noisier: Vec::new(),
            ..*weights
        }
        .eliminating(rest)
    }

    /// Predictions, by experiment and target, of these data alone.
    pub fn predictions(&self, all: &[Vec<Complex>]) -> Vec<Vec<Complex>> {
        all.iter().enumerate().map(|(e, all)| self.of(e, all)).collect()
    }

    /// What is kept of a list with an entry for each target of an experiment.
    fn of<T: Clone>(&self, experiment: usize, all: &[T]) -> Vec<T> {
        let kept = self.kept[experiment].iter().zip(all);
        kept.filter(|(kept, _)| **kept).map(|(_, value)| value.clone()).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::identify::fixtures::{ACTUATORS, axis, multisine, stepped_sine};
    use crate::measurement::{Measurement, Metadata, ResponseKind};

    #[test]
    fn what_is_kept_of_an_experiment_keeps_its_order_and_its_deviations() {
        let problem = Problem::new(&multisine(&axis(ACTUATORS[0]))).unwrap();
        let count = problem.experiments[0].targets.len();
        let weights = Weights {
            sigma: vec![(0..count).map(|t| 1.0 + t as f64).collect()],
            source: crate::answers::NoiseSource::Given,
            scale_dof: f64::INFINITY,
            depend_on_model: false,
            law: None,
            scatter_law: None,
            scatter: Vec::new(),
            eliminated: Vec::new(),
            correlations: Vec::new(),
            noisier: Vec::new(),
        };
        let subset = problem.subset(|_, target| target.order % 3 == 1);
        let rest = problem.only(&subset);
        let orders: Vec<usize> = rest.experiments[0].targets.iter().map(|t| t.order).collect();
        assert_eq!(orders, (1..=28).step_by(3).collect::<Vec<_>>());
        assert_eq!((rest.experiments[0].highest, rest.data()), (28, 20));
        let sigma: Vec<f64> = orders.iter().map(|order| 1.0 + *order as f64).collect();
        assert_eq!(subset.weights(&weights, &rest).sigma, [sigma]);
        // The scales are those of all data, so that parameters mean the same.
        assert_eq!(rest.scales, problem.scales);
    }

    #[test]
    fn an_experiment_without_data_keeps_no_constraint_either() {
        let mut experiments = stepped_sine(&axis(ACTUATORS[0]), 3).experiments().to_vec();
        experiments.iter_mut().for_each(|e| e.input_mean_measured = true);
        let metadata = Metadata { response_kind: ResponseKind::Position, ..Metadata::default() };
        let positions = Measurement::new(metadata, experiments, Vec::new(), String::new());
        let problem = Problem::new(&positions.unwrap()).unwrap();
        let rest = problem.only(&problem.subset(|e, target| e > 0 && target.order == 1));
        let kept = |e: usize| rest.experiments[e].targets.iter().map(|t| (t.order, t.constraint));
        assert_eq!(kept(0).count(), 0);
        assert_eq!(kept(1).collect::<Vec<_>>(), [(0, true), (1, false)]);
    }
}
