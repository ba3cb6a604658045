//! The linearization of a fitted model: its residuals, and the subspace that its parameters span.

use nalgebra::{DMatrix, DVector};

use crate::identify::{FitSession, Linear, Model};

use crate::diagnose::residuals::subspace::Subspace;

/// A fitted model with its prediction, residuals and Jacobian.
pub(crate) struct Linearization {
    /// The model.
    pub model: Model,
    /// Ŷ/σ.
    pub prediction: DVector<f64>,
    /// (Y − Ŷ)/σ.
    pub residuals: DVector<f64>,
    /// ∂Ŷ/∂p/σ, one column for each parameter that is not held at a bound.
    pub jacobian: DMatrix<f64>,
    /// The column space of the Jacobian: changes that the parameters can absorb.
    pub fitted: Subspace,
    /// The parameters of the columns.
    free: Vec<usize>,
}

impl Linearization {
    /// Linearizes a fitted model; `None` if it has no response.
    pub fn new(session: &FitSession<'_>, model: &Model) -> Option<Self> {
        let prediction = session.predict(model)?;
        let Linear { residuals, jacobian, held } = session.linearise(model)?;
        let free: Vec<usize> = (0..held.len()).filter(|i| !held[*i]).collect();
        let jacobian = jacobian.select_columns(&free);
        let fitted = Subspace::of(&jacobian);
        Some(Self { model: model.clone(), prediction, residuals, jacobian, fitted, free })
    }

    /// Gauss–Newton steps of the parameters that absorb these residuals, by parameter.
    pub fn steps(&self, left: &DVector<f64>) -> Vec<(usize, f64)> {
        let normal = self.jacobian.tr_mul(&self.jacobian);
        let Some(factor) = normal.cholesky() else { return Vec::new() };
        let steps = factor.solve(&self.jacobian.tr_mul(left));
        self.free.iter().copied().zip(steps.iter().copied()).collect()
    }

    /// Degrees of freedom: residuals less free parameters, at least 1.
    pub fn dof(&self) -> f64 {
        (self.residuals.len() - self.fitted.dimension()).max(1) as f64
    }
}
