//! Standardised residuals of a fit, and the subspace that its parameters can absorb.

use nalgebra::{DMatrix, DVector};

use crate::answers::NoiseSource;
use crate::identify::{ModelFit, NoiseLaw};

use super::layout::{Cell, Layout};
use super::subspace::Subspace;

/// Deviation from the mean, as a share of it, up to which a quantity is constant.
const CONSTANT_SPREAD: f64 = 1e-6;

/// Standardised residuals of a fit.
///
/// With noise e they are (I − H)·e to first order, H the projection on the columns of the Jacobian.
/// So row i has the variance 1 − hᵢᵢ, and rows are correlated.
pub(crate) struct Residuals {
    /// Where each residual lies.
    pub layout: Layout,
    /// Standardised residuals; where the noise is unknown, scaled to a mean square of one per
    /// degree of freedom.
    pub values: DVector<f64>,
    /// 1 − hᵢᵢ.
    pub freedom: Vec<f64>,
    /// What the fit can absorb: the column space of the Jacobian, and what was eliminated.
    pub fitted: Subspace,
    /// Derivatives by the parameters, one column each.
    pub jacobian: DMatrix<f64>,
    /// Directions that were eliminated, one column each.
    eliminated: DMatrix<f64>,
    /// The distribution of e.
    pub law: NoiseLaw,
    /// Whether the size of the noise is known.
    pub scale_known: bool,
}

impl Residuals {
    /// The residuals of a fitted model.
    pub fn of(fit: &ModelFit) -> Self {
        let known = fit.identification.noise != NoiseSource::Estimated;
        Self::new(
            Layout::of(fit),
            fit.residuals.clone(),
            [fit.jacobian.clone(), fit.eliminated.clone()],
            fit.noise.clone(),
            known,
        )
    }

    /// The same from their parts.
    pub fn new(
        layout: Layout,
        values: DVector<f64>,
        [jacobian, eliminated]: [DMatrix<f64>; 2],
        law: NoiseLaw,
        scale_known: bool,
    ) -> Self {
        let (own, more) = (jacobian.ncols(), eliminated.ncols());
        let mut all = jacobian.clone().insert_columns(own, more, 0.0);
        all.columns_mut(own, more).copy_from(&eliminated);
        let fitted = Subspace::of(&all);
        let freedom = fitted.leverages().iter().map(|h| (1.0 - h).max(0.0)).collect();
        let mut residuals =
            Self { layout, values, freedom, fitted, jacobian, eliminated, law, scale_known };
        residuals.values = residuals.in_scale(&residuals.values);
        residuals
    }

    /// The same residuals, whatever the size of the noise.
    pub fn of_any_size(self) -> Self {
        let Self { layout, values, jacobian, eliminated, law, .. } = self;
        Self::new(layout, values, [jacobian, eliminated], law, false)
    }

    /// Degrees of freedom: number of residuals less the rank of the Jacobian.
    pub fn dof(&self) -> f64 {
        (self.values.len() - self.fitted.dimension()) as f64
    }

    /// The residuals that a fit to this noise would leave.
    pub fn left_of(&self, noise: &DVector<f64>) -> DVector<f64> {
        self.in_scale(&self.fitted.complement(noise))
    }

    /// Directions in which residuals move if the parameters vary in proportion to quantities of the
    /// cells, orthogonal to those of constant parameters. A constant quantity adds none.
    pub fn varying(&self, quantities: &[&dyn Fn(&Cell) -> f64]) -> Subspace {
        let mut columns = Vec::new();
        for quantity in quantities {
            let values: Vec<f64> = self.layout.cells.iter().map(quantity).collect();
            let mean = values.iter().sum::<f64>() / values.len().max(1) as f64;
            let spread = values.iter().map(|value| (value - mean).abs()).fold(0.0, f64::max);
            if spread <= CONSTANT_SPREAD * mean.abs() {
                // The differences are rounding errors.
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
