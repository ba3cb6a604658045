//! A feed-forward neural network that maps measured features to parameters.
//!
//! One hidden layer of sigmoid neurons and a linear output, trained by back-propagation (D. Rumelhart,
//! G. Hinton, R. Williams, Nature 323 (1986) 533, doi:10.1038/323533a0) in mini-batches with Adam
//! steps (D. Kingma and J. Ba, arXiv:1412.6980), decoupled weight decay (I. Loshchilov and F.
//! Hutter, arXiv:1711.05101) and cosine decay of the learning rate. Initial weights: X. Glorot and
//! Y. Bengio, AISTATS 2010.
//!
//! Features and targets are standardised internally, and the features projected on their principal
//! components. A sixth of the samples is held out: the weights that predict these best are kept, and
//! the errors on them are the network's [spread](Network::spread).

mod adam;
mod components;
mod perceptron;
mod scaling;

use std::ops::ControlFlow;

use rand::seq::SliceRandom;
use rand_chacha::ChaCha8Rng;

use crate::answers::NetworkOptions;
use adam::Adam;
use components::Components;
use perceptron::{Perceptron, Workspace};
use scaling::Scaling;

/// Samples per step (tuned): with small batches, 400 samples still make several hundred steps.
const BATCH_SIZE: usize = 16;
/// One of every so many samples is held out.
const SAMPLES_PER_HELD_OUT: usize = 6;
/// Standardised features are clipped to ± this many standard deviations (tuned), because the
/// network extrapolates arbitrarily where it was never trained.
const FEATURE_RANGE: f64 = 4.0;

/// A trained network.
#[derive(Debug, Clone, PartialEq)]
pub struct Network {
    features: Scaling,
    components: Components,
    targets: Scaling,
    perceptron: Perceptron,
    spread: Vec<f64>,
}

impl Network {
    /// Trains a network on samples: `features[i]` belongs to `targets[i]`.
    ///
    /// `on_epoch` receives the epoch (from 1), the training loss and the held-out loss (mean
    /// squares of standardised errors), and ends the training by breaking. A feature that does not
    /// vary, and a value that is not finite, are replaced by the mean.
    ///
    /// # Panics
    /// If there are fewer than 2 samples, different numbers of samples in features and targets, no
    /// feature or target, or samples of different lengths.
    pub fn train(
        features: &[Vec<f64>],
        targets: &[Vec<f64>],
        options: &NetworkOptions,
        rng: &mut ChaCha8Rng,
        on_epoch: &mut dyn FnMut(usize, f64, f64) -> ControlFlow<()>,
    ) -> Network {
        assert_eq!(features.len(), targets.len(), "samples");
        assert!(features.len() >= 2, "{} samples", features.len());

        let mut order: Vec<usize> = (0..features.len()).collect();
        order.shuffle(rng);
        let (held_out, mut trained) = {
            let (held_out, trained) =
                order.split_at((features.len() / SAMPLES_PER_HELD_OUT).max(1));
            (held_out.to_vec(), trained.to_vec())
        };
        // The scaling, too, is computed from the training samples alone.
        let feature_scaling = Scaling::of(trained.iter().map(|&i| features[i].as_slice()));
        let target_scaling = Scaling::of(trained.iter().map(|&i| targets[i].as_slice()));
        let inputs = scaled(&feature_scaling, features, FEATURE_RANGE);
        let rows: Vec<&[f64]> = trained.iter().map(|&i| inputs[i].as_slice()).collect();
        let components = Components::of(&rows);
        let inputs: Vec<Vec<f64>> = inputs.iter().map(|row| components.project(row)).collect();
        let wanted = scaled(&target_scaling, targets, f64::INFINITY);
        let sample = |index: usize| (inputs[index].as_slice(), wanted[index].as_slice());

        let mut perceptron =
            Perceptron::glorot(inputs[0].len(), options.hidden_neurons, target_scaling.len(), rng);
        let mut workspace = Workspace::for_perceptron(&perceptron);
        let mut adam = Adam::new(perceptron.weights().len());
        let mut best = (f64::INFINITY, perceptron.clone());
        for epoch in 1..=options.epochs {
            trained.shuffle(rng);
            let rate_factor = cosine_decay(epoch, options.epochs);
            let mut training_loss = 0.0;
            for batch in trained.chunks(BATCH_SIZE) {
                let samples = batch.iter().map(|&index| sample(index));
                training_loss += perceptron.loss_and_gradient(samples, &mut workspace);
                adam.step(
                    perceptron.weights_mut(),
                    &workspace.gradient,
                    rate_factor,
                    batch.len() as f64,
                );
            }
            training_loss /= trained.len() as f64;
            let validation_loss = held_out
                .iter()
                .map(|&index| perceptron.loss(sample(index), &mut workspace))
                .sum::<f64>()
                / held_out.len() as f64;
            if validation_loss < best.0 {
                best = (validation_loss, perceptron.clone());
            }
            if on_epoch(epoch, training_loss, validation_loss).is_break() {
                break;
            }
        }

        let perceptron = best.1;
        let spread = perceptron
            .rms_errors(held_out.iter().map(|&index| sample(index)), &mut workspace)
            .iter()
            .enumerate()
            .map(|(output, error)| error * target_scaling.deviation(output))
            .collect();
        Network {
            features: feature_scaling,
            components,
            targets: target_scaling,
            perceptron,
            spread,
        }
    }

    /// Predicts the targets from measured features.
    ///
    /// Features are first clipped to four standard deviations about the mean of the training
    /// samples, so that the network does not extrapolate far.
    ///
    /// # Panics
    /// If the number of features differs from that in training.
    pub fn predict(&self, features: &[f64]) -> Vec<f64> {
        let mut input = vec![0.0; self.features.len()];
        self.features.apply(features, FEATURE_RANGE, &mut input);
        let input = self.components.project(&input);
        let mut workspace = Workspace::for_perceptron(&self.perceptron);
        self.targets.invert(self.perceptron.forward(&input, &mut workspace))
    }

    /// Root mean square error of each output on the held-out samples, in units of the target.
    pub fn spread(&self) -> &[f64] {
        &self.spread
    }
}

/// Standardises every sample, clipped to ±`range`.
fn scaled(scaling: &Scaling, samples: &[Vec<f64>], range: f64) -> Vec<Vec<f64>> {
    samples
        .iter()
        .map(|sample| {
            let mut out = vec![0.0; scaling.len()];
            scaling.apply(sample, range, &mut out);
            out
        })
        .collect()
}

/// Half a cosine: 1 at the first epoch, close to 0 at the last.
fn cosine_decay(epoch: usize, epochs: usize) -> f64 {
    0.5 * (1.0 + (std::f64::consts::PI * (epoch - 1) as f64 / epochs as f64).cos())
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};

    use super::*;

    fn options(epochs: usize) -> NetworkOptions {
        NetworkOptions { epochs, ..NetworkOptions::default() }
    }

    /// A smooth map of 4 features to 2 targets of very different size; the last
    /// feature is constant.
    fn samples(count: usize, seed: u64) -> (Vec<Vec<f64>>, Vec<Vec<f64>>) {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let features: Vec<Vec<f64>> = (0..count)
            .map(|_| {
                let mut draw = || rng.random_range(-1.0..1.0);
                vec![draw(), 100.0 * draw(), draw(), 3.0]
            })
            .collect();
        let targets = features
            .iter()
            .map(|x| {
                let [p, q, r] = [x[0], x[1] / 100.0, x[2]];
                vec![1e3 * (p * q + 0.5 * r), 1e-3 * ((2.0 * p).sin() - r * r)]
            })
            .collect();
        (features, targets)
    }

    fn train(count: usize, epochs: usize) -> (Network, Vec<(f64, f64)>) {
        let (features, targets) = samples(count, 1);
        let mut losses = Vec::new();
        let mut rng = ChaCha8Rng::seed_from_u64(2);
        let network = Network::train(
            &features,
            &targets,
            &options(epochs),
            &mut rng,
            &mut |_, training, validation| {
                losses.push((training, validation));
                ControlFlow::Continue(())
            },
        );
        (network, losses)
    }

    // A linear map would leave more than 60 % of the standard deviation.
    #[test]
    fn learns_a_smooth_map_to_a_tenth_of_its_deviation() {
        let (network, losses) = train(400, 150);
        assert_eq!(losses.len(), 150);
        let (features, targets) = samples(500, 99);
        for output in 0..2 {
            // Standard deviations of pq + r/2 and of sin 2p − r² over the cube, in the target's
            // unit.
            let unit = [1e3 * 0.4410, 1e-3 * 0.8267][output];
            let mean_square = features
                .iter()
                .zip(&targets)
                .map(|(x, y)| ((network.predict(x)[output] - y[output]) / unit).powi(2))
                .sum::<f64>()
                / 500.0;
            let error = mean_square.sqrt();
            assert!(error < 0.1, "output {output}: {error}");
            // The rms of 66 held-out samples is itself uncertain by about 9 %; doubled for unlucky
            // draws.
            let claimed = network.spread()[output] / unit;
            assert!((0.5..2.0).contains(&(claimed / error)), "{claimed} for {error}");
        }
    }

    #[test]
    fn the_same_seed_gives_the_same_weights() {
        assert_eq!(train(60, 5).0, train(60, 5).0);
    }

    #[test]
    fn the_weights_of_the_best_validation_are_kept() {
        // The targets are independent of the features: the network can only overfit.
        let (features, _) = samples(40, 1);
        let (_, targets) = samples(40, 2);
        let mut losses = Vec::new();
        let mut rng = ChaCha8Rng::seed_from_u64(2);
        let network =
            Network::train(&features, &targets, &options(200), &mut rng, &mut |_, t, v| {
                losses.push((t, v));
                ControlFlow::Continue(())
            });
        let best = losses.iter().map(|loss| loss.1).fold(f64::INFINITY, f64::min);
        assert!(best < 0.9 * losses[199].1, "the last epoch is not the best one");
        // The loss is the mean over both outputs of the squared standardised error.
        let kept: f64 = (0..2)
            .map(|k| (network.spread()[k] / network.targets.deviation(k)).powi(2) / 2.0)
            .sum();
        // Only the order of summation differs.
        assert!((kept - best).abs() < 1e-12, "{kept} {best}");
    }

    #[test]
    fn breaking_ends_the_training() {
        let (features, targets) = samples(40, 1);
        let mut epochs = 0;
        let mut rng = ChaCha8Rng::seed_from_u64(2);
        Network::train(&features, &targets, &options(50), &mut rng, &mut |epoch, _, _| {
            epochs = epoch;
            if epoch == 3 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        });
        assert_eq!(epochs, 3);
    }

    #[test]
    fn constant_far_and_missing_features_give_tame_predictions() {
        let (network, _) = train(60, 20);
        let here = network.predict(&[0.1, 5.0, 0.2, 3.0]);
        assert_eq!(here, network.predict(&[0.1, 5.0, 0.2, 1e9]), "a constant says nothing");
        assert_eq!(
            network.predict(&[1e3, 5.0, 0.2, 3.0]),
            network.predict(&[1e9, 5.0, 0.2, 3.0]),
            "far away is clipped"
        );
        for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            assert!(network.predict(&[value, 5.0, 0.2, 3.0]).iter().all(|y| y.is_finite()));
        }
    }

    #[test]
    fn two_samples_and_constant_targets_do_not_break_it() {
        let mut rng = ChaCha8Rng::seed_from_u64(2);
        let features = [vec![1.0], vec![2.0]];
        let targets = [vec![5.0], vec![5.0]];
        let network = Network::train(&features, &targets, &options(3), &mut rng, &mut |_, _, _| {
            ControlFlow::Continue(())
        });
        assert_eq!(network.predict(&[1.5]), [5.0]);
        assert_eq!(network.spread(), [0.0]);
    }
}
