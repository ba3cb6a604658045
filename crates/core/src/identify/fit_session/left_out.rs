//! Cross-validation to first order: predicts data left out of a fit without fitting again.

use nalgebra::{DMatrix, DVector};

use super::{FitSession, Linear, Model};

impl FitSession<'_> {
    /// NRMSE, over all parts together, of predicting each part of the data from a fit without it,
    /// to first order. `part` maps an experiment and a harmonic to the part it is left out in, if
    /// any. `None` where the model has no response, or nothing is left out.
    ///
    /// Let r and J be the residuals and the Jacobian of the fit, and r_h and J_h their rows of the
    /// part left out. Without these rows the optimum moves by δ = −(JᵀJ − J_hᵀJ_h + P)⁻¹·J_hᵀr_h,
    /// and r_h − J_hδ is the error of the prediction (Cook and Weisberg 1982, Residuals and
    /// Influence in Regression, section 2.2, for P = 0). P is the information of the prior: it
    /// keeps parameters finite that only the part left out determines.
    pub fn error_left_out(
        &self,
        model: &Model,
        part: impl Fn(usize, usize) -> Option<usize>,
    ) -> Option<f64> {
        let Linear { residuals, jacobian, held } = self.linearise(model)?;
        let free: Vec<usize> = (0..held.len()).filter(|i| !held[*i]).collect();
        let jacobian = jacobian.select_columns(&free);
        let variance =
            if self.noise_known() { 1.0 } else { model.cost / self.data().max(1) as f64 };
        let known = free.iter().map(|i| variance / model.prior_std(*i).powi(2));
        let information = jacobian.tr_mul(&jacobian)
            + DMatrix::from_diagonal(&DVector::from_iterator(free.len(), known));
        let mut rows: Vec<Vec<(usize, f64)>> = Vec::new();
        let (mut row, mut size) = (0, 0.0);
        for (e, (experiment, sigma)) in
            self.problem.experiments.iter().zip(&self.fitted.weights.sigma).enumerate()
        {
            for (target, sigma) in experiment.targets.iter().zip(sigma) {
                let end = row + if target.real { 1 } else { 2 };
                if let Some(part) = part(e, target.order).filter(|_| !target.constraint) {
                    rows.resize(rows.len().max(part + 1), Vec::new());
                    rows[part].extend((row..end).map(|row| (row, *sigma)));
                    size += target.value.norm_sqr();
                }
                row = end;
            }
        }
        let mut left = 0.0;
        for part in rows {
            let own: Vec<usize> = part.iter().map(|(row, _)| *row).collect();
            let (jacobian, residuals) = (jacobian.select_rows(&own), residuals.select_rows(&own));
            let rest = &information - jacobian.tr_mul(&jacobian);
            let moved = rest.cholesky()?.solve(&jacobian.tr_mul(&residuals));
            let predicted = residuals + jacobian * moved;
            let errors =
                predicted.iter().zip(&part).map(|(left, (_, sigma))| (left * sigma).powi(2));
            left += errors.sum::<f64>();
        }
        Some((left / size).sqrt()).filter(|error| error.is_finite())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::answers::{IdentifyOptions, PlantRequest};
    use crate::identify::fixtures::{axis, joined, stepped_sine};
    use crate::identify::request::IdentifyRequest;
    use crate::observer::Silent;
    use crate::plant::Actuator;

    // The axis has an actuator and the model has none, so the residuals are far above rounding. The
    // fit of the base model is nearly linear.
    #[test]
    fn the_error_is_that_of_fits_without_the_part() {
        let measurement = stepped_sine(&axis(Actuator::FirstOrder { corner_rad_s: 200.0 }), 3);
        let mut options = IdentifyOptions::default();
        options.network.enabled = false;
        options.colony.enabled = false;
        let plant = Some(PlantRequest { actuator_order: 0 });
        let request = IdentifyRequest { plant, options, ..IdentifyRequest::default() };
        let whole = FitSession::new(&measurement, &request, &Silent).unwrap();
        let experiments = measurement.experiments();
        let part_of = |experiment: usize| [3, 5].iter().position(|level| experiment % 8 == *level);
        let (mut error, mut size, mut fitted) = (0.0, 0.0, 0.0);
        for part in 0..2 {
            let kept = |e: &usize| part_of(*e) != Some(part);
            let rest = (0..experiments.len()).filter(kept).map(|e| experiments[e].clone());
            let rest = joined(rest.collect());
            let own = FitSession::continued(&rest, &request, &Silent, &whole).unwrap();
            let held = |e: usize| part_of(e) == Some(part);
            let squares = |model: &Model| {
                let comparison = whole.compare(model, held);
                let all = comparison.experiments.iter().flat_map(|e| &e.harmonics);
                all.fold([0.0, 0.0], |[left, size], h| {
                    let [re, im] = [0, 1].map(|i| h.measured[i] - h.simulated[i]);
                    let [a, b] = h.measured;
                    [left + re * re + im * im, size + a * a + b * b]
                })
            };
            let predicted = squares(&whole.adopt(&own, own.base()));
            error += predicted[0];
            size += predicted[1];
            fitted += squares(whole.base())[0];
        }
        let expected = (error / size).sqrt();
        let found = whole.error_left_out(whole.base(), |e, _| part_of(e)).unwrap();
        // The nonlinearity of the model is of second order in a change of some per cent.
        assert!((found / expected - 1.0).abs() < 0.02, "{found} instead of {expected}");
        assert!(found > 1.02 * (fitted / size).sqrt(), "more than what the fit leaves of it");
    }

    #[test]
    fn where_nothing_is_left_out_there_is_no_error() {
        let measurement = stepped_sine(&axis(Actuator::Direct), 1);
        let request = IdentifyRequest::default();
        let whole = FitSession::new(&measurement, &request, &Silent).unwrap();
        assert_eq!(whole.error_left_out(whole.base(), |_, _| None), None);
    }
}
