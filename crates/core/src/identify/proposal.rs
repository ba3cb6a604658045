//! The proposal of the neural network.
//!
//! The network is trained on simulated plants, measured at the same magnitudes and frequencies as
//! the data. The measured response then gives a proposal for the parameters of the real plant.

use std::ops::ControlFlow;

use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use rayon::prelude::*;

use crate::answers::NetworkOptions;

use super::features::Features;
use super::network::Network;
use super::objective::Misfit;
use super::parameters::{CONSTANT, Coordinates};

/// A proposal, with its spread.
pub(super) struct Proposal {
    /// The proposed point of the unit cube.
    pub cube: Vec<f64>,
    /// The proposed ln K.
    pub constant: f64,
    /// Rms error of each entry of `cube` on the simulated plants that were held out of the
    /// training.
    pub spread: Vec<f64>,
    /// Simulations of the whole measurement used for training.
    pub evaluations: u64,
}

/// Trains a network and asks it for a proposal. `on_epoch` receives the epoch, the training loss
/// and the held-out loss.
///
/// `None` if hardly any plant of the search range responds to this input, if the data has no usable
/// features, or when cancelled.
pub(super) fn propose(
    misfit: &Misfit<'_>,
    options: &NetworkOptions,
    rng: &mut ChaCha8Rng,
    on_epoch: &mut dyn FnMut(usize, f64, f64),
) -> Option<Proposal> {
    let features = Features::of(misfit.problem);
    let dimension = misfit.coordinates.len() - 1;
    let plants: Vec<Vec<f64>> = (0..options.training_plants)
        .map(|_| (0..dimension).map(|_| rng.random::<f64>()).collect())
        .collect();
    let simulated: Vec<Option<(Vec<f64>, f64)>> = plants
        .par_iter()
        .map(|cube| {
            if misfit.observer.cancelled() {
                return None;
            }
            let values = misfit.predict(&misfit.coordinates.within_search(cube)).ok()?;
            let moves = values.iter().flatten().any(|value| value.norm() > 0.0);
            moves.then(|| features.of_simulated(misfit.problem, &values))
        })
        .collect();
    // Every plant is simulated with K = 1. The network also predicts the size of that response: the
    // measured size divided by it is K.
    let (inputs, targets): (Vec<_>, Vec<_>) = simulated
        .into_iter()
        .zip(&plants)
        .filter_map(|(answer, cube)| {
            answer.map(|(features, size)| (features, [cube.as_slice(), &[size]].concat()))
        })
        .unzip();
    if inputs.len() < 10 || inputs[0].is_empty() {
        return None;
    }
    let network = Network::train(&inputs, &targets, options, rng, &mut |epoch, training, held| {
        on_epoch(epoch, training, held);
        if misfit.observer.cancelled() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    });
    let (measured, size) = features.of_measured(misfit.problem);
    let answer = network.predict(&measured);
    let (cube, unit_size) = answer.split_at(dimension);
    Some(Proposal {
        cube: cube.iter().map(|share| share.clamp(0.0, 1.0)).collect(),
        constant: size - unit_size[0],
        spread: network.spread()[..dimension].to_vec(),
        evaluations: options.training_plants as u64,
    })
}

impl Proposal {
    /// The proposal as a point.
    pub fn point(&self, coordinates: &Coordinates) -> Vec<f64> {
        let mut point = coordinates.within_search(&self.cube);
        point[CONSTANT] = self.constant;
        coordinates.clamp(&mut point);
        point
    }

    /// `count` first points for a search: the proposal itself, then normal draws around it.
    pub fn food_sources(&self, count: usize, rng: &mut ChaCha8Rng) -> Vec<Vec<f64>> {
        let mut draw = |share: f64, spread: f64| {
            let deviation: f64 = StandardNormal.sample(rng);
            (share + spread * deviation).clamp(0.0, 1.0)
        };
        let mut sources = vec![self.cube.clone()];
        while sources.len() < count {
            let source =
                self.cube.iter().zip(&self.spread).map(|(share, spread)| draw(*share, *spread));
            sources.push(source.collect());
        }
        sources
    }
}
