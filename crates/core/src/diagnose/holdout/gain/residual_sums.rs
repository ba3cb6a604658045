//! Sums of squares of a model's residuals, and the error (NRMSE) from them.

use crate::answers::ComparedHarmonic;

/// Sums of squares of a model's residuals on some data.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct ResidualSums {
    /// Σ|Y − Ŷ|².
    pub(super) error: f64,
    /// Σ|Y|².
    pub(super) size: f64,
    /// Σ|Y − Ŷ|²/σ².
    pub(super) chi2: f64,
    /// Number of real numbers compared.
    pub(super) data: f64,
}

impl ResidualSums {
    pub(super) fn add(&mut self, harmonic: &ComparedHarmonic) {
        let [re, im] = harmonic.measured;
        let error = (re - harmonic.simulated[0]).powi(2) + (im - harmonic.simulated[1]).powi(2);
        self.error += error;
        self.size += re * re + im * im;
        self.chi2 += error / harmonic.std.powi(2);
        self.data += if harmonic.order == 0 { 1.0 } else { 2.0 };
    }

    /// Adds one real sample of unknown noise.
    pub fn add_sample(&mut self, measured: f64, simulated: f64) {
        self.error += (measured - simulated).powi(2);
        self.size += measured * measured;
        self.data += 1.0;
    }

    /// The total of several sums.
    pub fn sum<'l>(all: impl IntoIterator<Item = &'l Self>) -> Self {
        all.into_iter().fold(Self::default(), Self::plus)
    }

    fn plus(mut self, other: &Self) -> Self {
        self.error += other.error;
        self.size += other.size;
        self.chi2 += other.chi2;
        self.data += other.data;
        self
    }

    pub(super) fn of<'h>(harmonics: impl Iterator<Item = &'h ComparedHarmonic>) -> Self {
        let mut left = Self::default();
        harmonics.for_each(|harmonic| left.add(harmonic));
        left
    }

    pub(super) fn nrmse(&self) -> f64 {
        (self.error / self.size).sqrt()
    }
}
