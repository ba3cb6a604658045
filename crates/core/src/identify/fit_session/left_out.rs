//! What a model would predict of data left out of its fit, to first order and without fitting it
//! again.

use nalgebra::{DMatrix, DVector};

use super::{FitSession, Linear, Model};

impl FitSession<'_> {
    /// NRMSE of what a fitted model would predict of each part of the data, had the part been
    /// left out of its fit; over all parts together, to first order. `part` says for an
    /// experiment and a harmonic in which part it is left out, if in any. `None` where the
    /// model has no response, or nothing is left out.
    ///
    /// With the residuals r and the Jacobian J of the fit and J_h those of the part left out,
    /// the optimum of the rest is moved by δ = −(JᵀJ − J_hᵀJ_h + P)⁻¹·J_hᵀr_h, and r_h − J_hδ
    /// is left (Cook and Weisberg 1982, Residuals and Influence in Regression, section 2.2,
    /// for P = 0). P is what was known of the parameters before: what only the part
    /// determines stays finite.
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
            let foretold = residuals + jacobian * moved;
            let errors =
                foretold.iter().zip(&part).map(|(left, (_, sigma))| (left * sigma).powi(2));
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

    // A pole at which friction is the same in both directions cannot follow data of an axis with
    // two levels: what remains is far above rounding, and the base model's fit is near linear.
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
            let foretold = squares(&whole.adopt(&own, own.base()));
            error += foretold[0];
            size += foretold[1];
            fitted += squares(whole.base())[0];
        }
        let expected = (error / size).sqrt();
        let found = whole.error_left_out(whole.base(), |e, _| part_of(e)).unwrap();
        // What the model is not linear in is of second order in a change of some per cent.
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
