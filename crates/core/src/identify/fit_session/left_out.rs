//! What leaving data out of a fit does to it, to first order.
//!
//! Let r and J be the residuals and the Jacobian of the fit, and r_h and J_h their rows of the part
//! left out. Without these rows the optimum moves by δ = −(JᵀJ − J_hᵀJ_h + P)⁻¹·J_hᵀr_h, and
//! r_h − J_hδ is the error of the prediction (Cook and Weisberg 1982, Residuals and Influence in
//! Regression, section 2.2, for P = 0). P is the information of the prior: it keeps parameters
//! finite that only the part left out determines.

use std::iter::repeat_n;

use nalgebra::{DMatrix, DVector};

use super::{FitSession, Linear, Model};
use crate::identify::levenberg_marquardt::Linearisation;

/// A fitted model, linearised once for all parts that are left out.
pub struct LeavingOut {
    pub(super) model: Model,
    linear: Linear,
    /// P, for every parameter.
    prior: DVector<f64>,
    /// The data and constraints, in the order of the residuals.
    data: Vec<Datum>,
}

/// One harmonic that is compared.
struct Datum {
    experiment: usize,
    order: usize,
    constraint: bool,
    /// Its first row, and how many it has.
    rows: [usize; 2],
    sigma: f64,
    /// |Y|², in scale.
    size: f64,
}

impl FitSession<'_> {
    /// Linearises a fitted model; `None` where it has no response.
    pub fn leaving_out(&self, model: &Model) -> Option<LeavingOut> {
        let linear = self.linearise(model)?;
        let variance =
            if self.noise_known() { 1.0 } else { model.cost / self.data().max(1) as f64 };
        let prior =
            DVector::from_fn(model.parameters(), |i, _| variance / model.prior_std(i).powi(2));
        let mut data = Vec::new();
        let mut row = 0;
        let experiments = self.problem.experiments.iter().zip(&self.fitted.weights.sigma);
        for (experiment, (prepared, sigma)) in experiments.enumerate() {
            for (target, sigma) in prepared.targets.iter().zip(sigma) {
                let rows = [row, if target.real { 1 } else { 2 }];
                row += rows[1];
                data.push(Datum {
                    experiment,
                    order: target.order,
                    constraint: target.constraint,
                    rows,
                    sigma: *sigma,
                    size: target.value.norm_sqr(),
                });
            }
        }
        Some(LeavingOut { model: model.clone(), linear, prior, data })
    }
}

impl LeavingOut {
    /// NRMSE, over all parts together, of predicting each part of the data from a fit without it.
    /// `part` maps an experiment and a harmonic to the part it is left out in, if any. `None` if
    /// nothing is left out, or a fit without a part determines nothing.
    pub fn error(&self, part: impl Fn(usize, usize) -> Option<usize>) -> Option<f64> {
        let mut parts: Vec<Vec<&Datum>> = Vec::new();
        for datum in self.data.iter().filter(|datum| !datum.constraint) {
            if let Some(part) = part(datum.experiment, datum.order) {
                parts.resize(parts.len().max(part + 1), Vec::new());
                parts[part].push(datum);
            }
        }
        let Linear { residuals, jacobian, held } = &self.linear;
        let free: Vec<usize> = (0..held.len()).filter(|i| !held[*i]).collect();
        let jacobian = jacobian.select_columns(&free);
        let information =
            jacobian.tr_mul(&jacobian) + DMatrix::from_diagonal(&self.prior.select_rows(&free));
        let size: f64 = parts.iter().flatten().map(|datum| datum.size).sum();
        let mut left = 0.0;
        for part in parts {
            let own = rows(part.iter().copied());
            let (jacobian, residuals) = (jacobian.select_rows(&own), residuals.select_rows(&own));
            let rest = &information - jacobian.tr_mul(&jacobian);
            let moved = rest.cholesky()?.solve(&jacobian.tr_mul(&residuals));
            let predicted = residuals + jacobian * moved;
            let sigmas = part.iter().flat_map(|datum| repeat_n(datum.sigma, datum.rows[1]));
            left += predicted.iter().zip(sigmas).map(|(r, sigma)| (r * sigma).powi(2)).sum::<f64>();
        }
        Some((left / size).sqrt()).filter(|error| error.is_finite())
    }

    /// The linearisation of the data that are kept, given their experiment and harmonic. A
    /// constraint is kept where any datum of its experiment is.
    pub(super) fn only(&self, keep: impl Fn(usize, usize) -> bool) -> Linearisation {
        let is_datum = |datum: &Datum| !datum.constraint && keep(datum.experiment, datum.order);
        let beside = |constraint: &Datum| {
            let experiment = constraint.experiment;
            self.data.iter().any(|datum| datum.experiment == experiment && is_datum(datum))
        };
        let kept = self
            .data
            .iter()
            .filter(|datum| if datum.constraint { beside(datum) } else { is_datum(datum) });
        let kept = rows(kept);
        Linearisation {
            residuals: -self.linear.residuals.select_rows(&kept),
            jacobian: self.linear.jacobian.select_rows(&kept),
        }
    }
}

/// The rows of some data.
fn rows<'d>(data: impl Iterator<Item = &'d Datum>) -> Vec<usize> {
    data.flat_map(|datum| datum.rows[0]..datum.rows[0] + datum.rows[1]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::answers::{IdentifyOptions, PlantRequest, Weighting};
    use crate::identify::FitAccuracy;
    use crate::identify::fixtures::{axis, stepped_sine};
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
        // What the model lacks is not noise, from which weights would follow.
        options.weights = Weighting::Response;
        let plant = Some(PlantRequest { actuator_order: 0 });
        let request = IdentifyRequest { plant, options, ..IdentifyRequest::default() };
        let whole = FitSession::new(&measurement, &request, &Silent).unwrap();
        let part_of = |experiment: usize| [3, 5].iter().position(|level| experiment % 8 == *level);
        let left_out = whole.leaving_out(whole.base()).unwrap();
        let (mut error, mut size, mut fitted) = (0.0, 0.0, 0.0);
        for part in 0..2 {
            let held = |e: usize| part_of(e) == Some(part);
            let rest = whole.only(|e, _| !held(e));
            let squares = |model: &Model| {
                let comparison = whole.compare(model, held);
                let all = comparison.experiments.iter().flat_map(|e| &e.harmonics);
                all.fold([0.0, 0.0], |[left, size], h| {
                    let [re, im] = [0, 1].map(|i| h.measured[i] - h.simulated[i]);
                    let [a, b] = h.measured;
                    [left + re * re + im * im, size + a * a + b * b]
                })
            };
            let predicted = squares(&rest.refine(whole.base(), FitAccuracy::Thorough));
            error += predicted[0];
            size += predicted[1];
            fitted += squares(whole.base())[0];
        }
        let expected = (error / size).sqrt();
        let found = left_out.error(|e, _| part_of(e)).unwrap();
        // The nonlinearity of the model is of second order in a change of some per cent.
        assert!((found / expected - 1.0).abs() < 0.02, "{found} instead of {expected}");
        assert!(found > 1.02 * (fitted / size).sqrt(), "more than what the fit leaves of it");
    }

    #[test]
    fn where_nothing_is_left_out_there_is_no_error() {
        let measurement = stepped_sine(&axis(Actuator::Direct), 1);
        let request = IdentifyRequest::default();
        let whole = FitSession::new(&measurement, &request, &Silent).unwrap();
        assert_eq!(whole.leaving_out(whole.base()).unwrap().error(|_, _| None), None);
    }
}
