//! The perceptron: one hidden layer of sigmoid neurons, a linear output, and back-propagation.
//!
//! ```text
//!   hⱼ = σ(bⱼ + Σᵢ xᵢ Wᵢⱼ)      yₖ = cₖ + Σⱼ hⱼ Vⱼₖ      loss = Σₖ (yₖ − tₖ)²/outputs
//! ```
//!
//! with the algebraic sigmoid σ(x) = x/√(1 + x²) (B. Carlile and others, arXiv:1710.09967), which
//! learns as well as tanh here and takes a square root and a division.
//!
//! All weights lie in one vector: W by input, b, V by output, c. The innermost index of every loop
//! is contiguous, and only V is summed over it. The compiler can therefore vectorise without
//! reordering additions.

use rand::RngExt;
use rand_chacha::ChaCha8Rng;

/// The weights of a network with one hidden layer.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Perceptron {
    hidden: usize,
    outputs: usize,
    weights: Vec<f64>,
}

/// Buffers of one forward and backward pass.
pub(super) struct Workspace {
    hidden: Vec<f64>,
    output: Vec<f64>,
    hidden_slope: Vec<f64>,
    /// Gradient of the summed loss, in the order of the weights.
    pub(super) gradient: Vec<f64>,
}

impl Workspace {
    pub(super) fn for_perceptron(perceptron: &Perceptron) -> Self {
        Self {
            hidden: vec![0.0; perceptron.hidden],
            output: vec![0.0; perceptron.outputs],
            hidden_slope: vec![0.0; perceptron.hidden],
            gradient: vec![0.0; perceptron.weights.len()],
        }
    }
}

impl Perceptron {
    /// Initial weights: uniform within ±√(6/(fan-in + fan-out)), biases 0 (Glorot and Bengio).
    pub(super) fn glorot(
        inputs: usize,
        hidden: usize,
        outputs: usize,
        rng: &mut ChaCha8Rng,
    ) -> Self {
        let mut weights = Vec::with_capacity((inputs + 1) * hidden + (hidden + 1) * outputs);
        for (fan_in, fan_out) in [(inputs, hidden), (hidden, outputs)] {
            let limit = (6.0 / (fan_in + fan_out) as f64).sqrt();
            weights.extend((0..fan_in * fan_out).map(|_| rng.random_range(-limit..=limit)));
            weights.extend(std::iter::repeat_n(0.0, fan_out));
        }
        Self { hidden, outputs, weights }
    }

    pub(super) fn weights(&self) -> &[f64] {
        &self.weights
    }

    pub(super) fn weights_mut(&mut self) -> &mut [f64] {
        &mut self.weights
    }

    /// Index at which V begins, after W and b.
    fn output_start(&self) -> usize {
        self.weights.len() - (self.hidden + 1) * self.outputs
    }

    pub(super) fn forward<'w>(&self, input: &[f64], workspace: &'w mut Workspace) -> &'w [f64] {
        let (first, second) = self.weights.split_at(self.output_start());
        let (rows, biases) = first.split_at(input.len() * self.hidden);
        workspace.hidden.copy_from_slice(biases);
        for (x, row) in input.iter().zip(rows.chunks_exact(self.hidden)) {
            for (h, w) in workspace.hidden.iter_mut().zip(row) {
                *h += x * w;
            }
        }
        for h in &mut workspace.hidden {
            *h /= (1.0 + *h * *h).sqrt();
        }
        let (rows, biases) = second.split_at(self.hidden * self.outputs);
        for ((y, row), bias) in
            workspace.output.iter_mut().zip(rows.chunks_exact(self.hidden)).zip(biases)
        {
            *y = bias + row.iter().zip(&workspace.hidden).map(|(w, h)| w * h).sum::<f64>();
        }
        &workspace.output
    }

    pub(super) fn loss(&self, (input, target): (&[f64], &[f64]), workspace: &mut Workspace) -> f64 {
        let output = self.forward(input, workspace);
        let squares = output.iter().zip(target).map(|(y, t)| (y - t).powi(2));
        squares.sum::<f64>() / self.outputs as f64
    }

    /// Sum of the losses of the samples. Their gradient is stored in the workspace.
    pub(super) fn loss_and_gradient<'s>(
        &self,
        samples: impl Iterator<Item = (&'s [f64], &'s [f64])>,
        workspace: &mut Workspace,
    ) -> f64 {
        workspace.gradient.fill(0.0);
        let output_weights = &self.weights[self.output_start()..];
        let mut loss = 0.0;
        for (input, target) in samples {
            loss += self.loss((input, target), workspace);
            let Workspace { hidden, output, hidden_slope, gradient } = workspace;
            let (first, second) = gradient.split_at_mut(self.output_start());
            let (rows, biases) = second.split_at_mut(self.hidden * self.outputs);
            hidden_slope.fill(0.0);
            let layer =
                rows.chunks_exact_mut(self.hidden).zip(output_weights.chunks_exact(self.hidden));
            for (k, (slopes, weights)) in layer.enumerate() {
                let error = 2.0 * (output[k] - target[k]) / self.outputs as f64;
                biases[k] += error;
                for (j, (slope, weight)) in slopes.iter_mut().zip(weights).enumerate() {
                    *slope += error * hidden[j];
                    hidden_slope[j] += error * weight;
                }
            }
            for (slope, h) in hidden_slope.iter_mut().zip(hidden.iter()) {
                let rest = 1.0 - h * h; // 1/(1 + x²)
                *slope *= rest * rest.sqrt();
            }
            let (rows, biases) = first.split_at_mut(input.len() * self.hidden);
            for (bias, slope) in biases.iter_mut().zip(hidden_slope.iter()) {
                *bias += slope;
            }
            for (x, row) in input.iter().zip(rows.chunks_exact_mut(self.hidden)) {
                for (w, slope) in row.iter_mut().zip(hidden_slope.iter()) {
                    *w += x * slope;
                }
            }
        }
        loss
    }

    /// Root mean square error of each output over samples.
    pub(super) fn rms_errors<'s>(
        &self,
        samples: impl Iterator<Item = (&'s [f64], &'s [f64])>,
        workspace: &mut Workspace,
    ) -> Vec<f64> {
        let mut squares = vec![0.0; self.outputs];
        let mut count = 0_usize;
        for (input, target) in samples {
            let output = self.forward(input, workspace);
            for ((sum, y), t) in squares.iter_mut().zip(output).zip(target) {
                *sum += (y - t).powi(2);
            }
            count += 1;
        }
        squares.into_iter().map(|sum| (sum / count.max(1) as f64).sqrt()).collect()
    }
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;

    use super::*;

    #[test]
    fn the_gradient_agrees_with_central_differences() {
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        let mut network = Perceptron::glorot(4, 3, 2, &mut rng);
        for weight in network.weights_mut() {
            *weight += rng.random_range(-0.3..0.3);
        }
        let mut draw = |count| (0..count).map(|_| rng.random_range(-1.5..1.5)).collect();
        let samples: Vec<(Vec<f64>, Vec<f64>)> = (0..5).map(|_| (draw(4), draw(2))).collect();
        let mut workspace = Workspace::for_perceptron(&network);
        let mut loss = |network: &Perceptron| {
            let samples = samples.iter().map(|(x, t)| (x.as_slice(), t.as_slice()));
            let loss = network.loss_and_gradient(samples, &mut workspace);
            (loss, workspace.gradient.clone())
        };

        let (_, gradient) = loss(&network);
        assert_eq!(gradient.len(), (4 + 1) * 3 + (3 + 1) * 2);
        let step = 1e-5;
        for (index, slope) in gradient.iter().enumerate() {
            let at = |shift: f64| {
                let mut moved = network.clone();
                moved.weights_mut()[index] += shift;
                moved
            };
            let difference = (loss(&at(step)).0 - loss(&at(-step)).0) / (2.0 * step);
            // Central differences err by step² and by rounding/step, both about 1e-10.
            assert!((slope - difference).abs() < 1e-8, "weight {index}: {slope} {difference}");
        }
    }

    #[test]
    fn initial_weights_are_within_glorots_limit_and_biases_zero() {
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        let network = Perceptron::glorot(10, 6, 2, &mut rng);
        let (first, second) = network.weights().split_at(network.output_start());
        let largest = |weights: &[f64]| weights.iter().fold(0.0_f64, |m, w| m.max(w.abs()));
        assert!((0.5..1.0).contains(&(largest(&first[..60]) / (6.0_f64 / 16.0).sqrt())));
        assert!((0.5..1.0).contains(&(largest(&second[..12]) / (6.0_f64 / 8.0).sqrt())));
        assert!(first[60..].iter().chain(&second[12..]).all(|bias| *bias == 0.0));
    }
}
