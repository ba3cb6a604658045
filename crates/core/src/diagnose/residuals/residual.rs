//! Standardised residuals of a fit, and the subspace that its parameters can take up.

use nalgebra::{DMatrix, DVector};

use crate::answers::NoiseSource;
use crate::identify::{ModelFit, NoiseLaw};

use super::layout::{Cell, Layout};
use super::subspace::Subspace;

/// Spread, as a share of the mean, below which a quantity is constant.
const CONSTANT: f64 = 1e-6;

/// Residuals of a fit with p parameters to n data: with noise e they are
/// (I − H)·e to first order, H the projection on the columns of the Jacobian, so
/// that row i has the variance 1 − hᵢᵢ and rows are correlated.
pub(crate) struct Residuals {
    /// Where each lies.
    pub layout: Layout,
    /// Standardised residuals; where the noise is unknown their mean square is
    /// one a degree of freedom.
    pub values: DVector<f64>,
    /// 1 − hᵢᵢ.
    pub freedom: Vec<f64>,
    /// What the fit can take up.
    pub fitted: Subspace,
    /// Derivatives by the parameters.
    pub jacobian: DMatrix<f64>,
    /// The law of e.
    pub law: NoiseLaw,
    /// Whether the size of the noise is known.
    pub scale_known: bool,
}

impl Residuals {
    /// Of a fitted base model.
    pub fn of(fit: &ModelFit) -> Self {
        let known = fit.identification.noise != NoiseSource::Estimated;
        Self::new(
            Layout::of(fit),
            fit.residuals.clone(),
            fit.jacobian.clone(),
            fit.noise.clone(),
            known,
        )
    }

    /// Of their parts.
    pub fn new(
        layout: Layout,
        values: DVector<f64>,
        jacobian: DMatrix<f64>,
        law: NoiseLaw,
        scale_known: bool,
    ) -> Self {
        let fitted = Subspace::of(&jacobian);
        let freedom = fitted.leverages().iter().map(|h| (1.0 - h).max(0.0)).collect();
        let mut residuals = Self { layout, values, freedom, fitted, jacobian, law, scale_known };
        residuals.values = residuals.in_scale(&residuals.values);
        residuals
    }

    /// Degrees of freedom.
    pub fn dof(&self) -> f64 {
        (self.values.len() - self.fitted.dimension()) as f64
    }

    /// Residuals that this noise would leave.
    pub fn left_of(&self, noise: &DVector<f64>) -> DVector<f64> {
        self.in_scale(&self.fitted.complement(noise))
    }

    /// Directions in which the parameters would change in proportion to
    /// quantities of the cells, beyond what constant parameters do. Empty where
    /// a quantity does not vary.
    pub fn varying(&self, quantities: &[&dyn Fn(&Cell) -> f64]) -> Subspace {
        let mut columns = Vec::new();
        for quantity in quantities {
            let values: Vec<f64> = self.layout.cells.iter().map(quantity).collect();
            let mean = values.iter().sum::<f64>() / values.len().max(1) as f64;
            let spread = values.iter().map(|value| (value - mean).abs()).fold(0.0, f64::max);
            if spread <= CONSTANT * mean.abs() {
                // Rounding would be taken for a direction.
                continue;
            }
            let mut scaled = DVector::zeros(self.values.len());
            for (cell, value) in self.layout.cells.iter().zip(&values) {
                cell.each_row().for_each(|row| scaled[row] = value - mean);
            }
            columns.extend(self.jacobian.column_iter().map(|column| column.component_mul(&scaled)));
        }
        let none = DMatrix::zeros(self.values.len(), 0);
        let columns = if columns.is_empty() { none } else { DMatrix::from_columns(&columns) };
        Subspace::beyond(&columns, &self.fitted)
    }

    fn in_scale(&self, values: &DVector<f64>) -> DVector<f64> {
        let size = values.norm();
        if self.scale_known || size <= 0.0 {
            return values.clone();
        }
        values * (self.dof().max(1.0).sqrt() / size)
    }
}
