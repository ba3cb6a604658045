//! Adam steps with decoupled weight decay.

/// Step length at the first epoch, standardised units.
const LEARNING_RATE: f64 = 0.01;
/// Forgetting of the gradient's mean and mean square: the paper's defaults.
const FIRST_MOMENT: f64 = 0.9;
const SECOND_MOMENT: f64 = 0.999;
/// Keeps the step finite where a gradient has always been 0.
const TINY: f64 = 1e-8;
/// Share of the learning rate by which weights shrink a step. Light: a few hundred
/// samples and a thousand weights would otherwise overfit.
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

    /// One step down `gradient`, a sum over `samples` samples, with the learning rate
    /// times `rate_factor`.
    pub(super) fn step(
        &mut self,
        weights: &mut [f64],
        gradient: &[f64],
        rate_factor: f64,
        samples: f64,
    ) {
        self.steps = self.steps.saturating_add(1);
        let rate = LEARNING_RATE * rate_factor;
        let mean_correction = 1.0 / (1.0 - FIRST_MOMENT.powi(self.steps));
        let square_correction = 1.0 / (1.0 - SECOND_MOMENT.powi(self.steps));
        let moments = self.mean.iter_mut().zip(&mut self.mean_square);
        for ((weight, slope), (mean, square)) in weights.iter_mut().zip(gradient).zip(moments) {
            let slope = slope / samples;
            *mean = FIRST_MOMENT * *mean + (1.0 - FIRST_MOMENT) * slope;
            *square = SECOND_MOMENT * *square + (1.0 - SECOND_MOMENT) * slope * slope;
            let step = *mean * mean_correction / ((*square * square_correction).sqrt() + TINY);
            *weight -= rate * (step + WEIGHT_DECAY * *weight);
        }
    }
}
