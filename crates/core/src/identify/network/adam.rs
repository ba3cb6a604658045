//! Adam optimiser steps with decoupled weight decay (D. Kingma and J. Ba, arXiv:1412.6980; I.
//! Loshchilov and F. Hutter, arXiv:1711.05101).

/// Learning rate at the first epoch, in standardised units (tuned).
const LEARNING_RATE: f64 = 0.01;
/// β₁, decay rate of the running mean of the gradient: the default of Kingma and Ba.
const FIRST_MOMENT_DECAY: f64 = 0.9;
/// β₂, decay rate of the running mean square of the gradient: the default of Kingma and Ba.
const SECOND_MOMENT_DECAY: f64 = 0.999;
/// ε: keeps the step finite where a gradient has always been 0.
const STEP_EPSILON: f64 = 1e-8;
/// Weights shrink by this times the learning rate in every step (tuned). Without decay, a few
/// hundred samples would be overfitted by a thousand weights.
const WEIGHT_DECAY: f64 = 0.01;

/// Running moments of the gradient.
pub(super) struct Adam {
    mean: Vec<f64>,
    mean_square: Vec<f64>,
    steps: i32,
}

impl Adam {
    pub(super) fn new(weights: usize) -> Self {
        Self { mean: vec![0.0; weights], mean_square: vec![0.0; weights], steps: 0 }
    }

    /// One step against `gradient`, a sum over `samples` samples; the learning rate is multiplied
    /// by `rate_factor`.
    pub(super) fn step(
        &mut self,
        weights: &mut [f64],
        gradient: &[f64],
        rate_factor: f64,
        samples: f64,
    ) {
        self.steps = self.steps.saturating_add(1);
        let rate = LEARNING_RATE * rate_factor;
        let mean_correction = 1.0 / (1.0 - FIRST_MOMENT_DECAY.powi(self.steps));
        let square_correction = 1.0 / (1.0 - SECOND_MOMENT_DECAY.powi(self.steps));
        let moments = self.mean.iter_mut().zip(&mut self.mean_square);
        for ((weight, slope), (mean, square)) in weights.iter_mut().zip(gradient).zip(moments) {
            let slope = slope / samples;
            *mean = FIRST_MOMENT_DECAY * *mean + (1.0 - FIRST_MOMENT_DECAY) * slope;
            *square = SECOND_MOMENT_DECAY * *square + (1.0 - SECOND_MOMENT_DECAY) * slope * slope;
            let step =
                *mean * mean_correction / ((*square * square_correction).sqrt() + STEP_EPSILON);
            *weight -= rate * (step + WEIGHT_DECAY * *weight);
        }
    }
}
