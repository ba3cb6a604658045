//! A motion whose input does not repeat.

use super::size;

/// Course of the input between two samples.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Intersample {
    /// Linear interpolation.
    #[default]
    Linear,
    /// Zero-order hold of the earlier sample, as after a digital-to-analogue converter.
    Hold,
}

/// Initial state of a motion, as far as the upload states it.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Beginning {
    /// Velocity at the first sample, if given. All other states are then those of a steady motion
    /// at this velocity under a constant input equal to the first sample.
    pub velocity: Option<f64>,
    /// Position at the first sample, if given, relative to the zero of position-dependent effects
    /// (a spring's rest position).
    pub position: Option<f64>,
    /// Length of the beginning that is not compared, s, if given.
    pub settle_s: Option<f64>,
}

/// Input and response of one axis, sampled together, without a period.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Transient {
    /// Sampling interval, s.
    pub step_s: f64,
    /// Input, input units.
    pub input: Vec<f64>,
    /// Response, response units; as many samples as the input.
    pub output: Vec<f64>,
    /// Course of the input between samples.
    pub intersample: Intersample,
    /// Initial state.
    pub beginning: Beginning,
    /// Position in the order of acquisition, if known.
    pub run: Option<f64>,
}

/// Fewest samples of a motion that can be compared with a model.
pub(super) const FEWEST: usize = 16;

impl Transient {
    /// Time from the first sample to the last, s.
    pub fn duration_s(&self) -> f64 {
        self.step_s * self.input.len().saturating_sub(1) as f64
    }

    /// Half the peak-to-peak value of the input, input units.
    pub fn magnitude(&self) -> f64 {
        let most = self.input.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let least = self.input.iter().copied().fold(f64::INFINITY, f64::min);
        0.5 * (most - least)
    }

    pub(super) fn check(&self) -> Result<(), String> {
        let count = self.input.len();
        if self.output.len() != count {
            return Err(format!(
                "{count} samples of the input and {} of the response",
                self.output.len()
            ));
        }
        if count < FEWEST {
            return Err(format!(
                "the motion has {count} samples, and at least {FEWEST} are needed"
            ));
        }
        if !(self.step_s.is_finite() && self.step_s > 0.0) {
            return Err(format!("the sampling interval {} s is not positive", self.step_s));
        }
        if !self.input.iter().chain(&self.output).all(|value| value.is_finite()) {
            return Err("a sample is not finite".into());
        }
        if let Some(reason) = size::frequency_fault("the sampling interval (s)", self.step_s) {
            return Err(reason);
        }
        for (what, samples) in [("the input", &self.input), ("the response", &self.output)] {
            let largest = samples.iter().map(|value| value.abs()).fold(0.0, f64::max);
            if let Some(reason) = size::fault(&format!("{what}: a largest sample"), largest) {
                return Err(reason);
            }
        }
        match self.beginning.settle_s {
            Some(settle_s) if settle_s >= self.duration_s() => Err(format!(
                "settle_s of {settle_s} s leaves nothing of a motion of {:.6} s",
                self.duration_s()
            )),
            _ => Ok(()),
        }
    }
}
