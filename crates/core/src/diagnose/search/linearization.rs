//! A fitted model, linearized: its residuals, and the subspace of what its parameters can take up.

use nalgebra::{DMatrix, DVector};

use crate::identify::{FitSession, Linear, Model};

use crate::diagnose::residuals::subspace::Subspace;

/// A fitted model, its prediction, and what its parameters can take up.
pub(crate) struct Linearization {
    /// The model.
    pub model: Model,
    /// Ŷ/σ.
    pub prediction: DVector<f64>,
    /// (Y − Ŷ)/σ.
    pub residuals: DVector<f64>,
    /// ∂Ŷ/∂p/σ by every parameter that no bound holds.
    pub jacobian: DMatrix<f64>,
    /// Its span.
    pub fitted: Subspace,
    /// Which parameters the columns are of.
    free: Vec<usize>,
}

impl Linearization {
    /// Of a fitted model; `None` where it has no response.
    pub fn new(session: &FitSession<'_>, model: &Model) -> Option<Self> {
        let prediction = session.predict(model)?;
        let Linear { residuals, jacobian, held } = session.linearise(model)?;
        let free: Vec<usize> = (0..held.len()).filter(|i| !held[*i]).collect();
        let jacobian = jacobian.select_columns(&free);
        let fitted = Subspace::of(&jacobian);
        Some(Self { model: model.clone(), prediction, residuals, jacobian, fitted, free })
    }

    /// Steps of the parameters that take up this, to first order.
    pub fn steps(&self, left: &DVector<f64>) -> Vec<(usize, f64)> {
        let normal = self.jacobian.tr_mul(&self.jacobian);
        let Some(factor) = normal.cholesky() else { return Vec::new() };
        let steps = factor.solve(&self.jacobian.tr_mul(left));
        self.free.iter().copied().zip(steps.iter().copied()).collect()
    }

    /// Residuals less free parameters.
    pub fn dof(&self) -> f64 {
        (self.residuals.len() - self.fitted.dimension()).max(1) as f64
    }
}
