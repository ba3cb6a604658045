//! Models that have no periodic response in some experiments.
//!
//! A search passes through parameters at which the motion from rest does not settle to the period
//! of the input. So that it does not stop there, it uses an unstable motion of that period or, if
//! there is none, the response of the base model. When models are compared, only motions reached
//! from rest count, and the response of the base model where there is none: an effect gains nothing
//! by having no response. The final model is fitted to the experiments in which it has a response,
//! and judged by them.

use crate::simulate::Counts;

use super::{FitAccuracy, FitSession, Model};
use crate::identify::objective::Misfit;
use crate::identify::refine;

/// Motions from rest are those of a fit if their cost is larger by no more than this share: the
/// integration of the motions errs by less (tuned).
const SAME_COST: f64 = 1e-3;

impl FitSession<'_> {
    /// A fitted model as it counts in comparisons: with only the motions from rest as responses. If
    /// these have the cost of the motions of the fit, it is unchanged; else it is fitted again.
    /// Its cost is infinite if too many experiments have none.
    pub fn from_rest(&self, model: Model) -> Model {
        self.from_rest_watched(model, &|| ())
    }

    /// The same; `on_step` is called after every step of a fit.
    pub fn from_rest_watched(&self, model: Model, on_step: &dyn Fn()) -> Model {
        if !model.cost.is_finite() || model.effects().is_empty() {
            return model;
        }
        let misfit = Misfit { counts: Counts::FromRest, ..self.search_misfit(&model) };
        let same = model.cost * (1.0 + SAME_COST) + self.rounding();
        if misfit.cost(&model.point) <= same {
            return model;
        }
        self.descend_by(&misfit, &model, self.patience(FitAccuracy::Settle), on_step)
    }

    /// Indices of the experiments in which a model has no response from rest.
    fn unanswered(&self, model: &Model) -> Vec<usize> {
        if model.effects().is_empty() {
            return Vec::new();
        }
        let misfit = Misfit { counts: Counts::FromRest, ..self.misfit(model) };
        misfit.unanswered(&model.point)
    }

    /// Fits a model to the experiments in which it has a response from rest; returns it with a
    /// session of these alone. `None` if it has one in all.
    pub(super) fn where_answered(&self, model: &Model) -> Option<(Self, Model)> {
        let mut left_out = self.unanswered(model);
        if left_out.is_empty() {
            return None;
        }
        let mut model = model.clone();
        loop {
            let rest = self.only(|e, _| !left_out.contains(&e));
            let weights = &rest.fitted.weights;
            let misfit = Misfit::new(&rest.problem, &model.coordinates, weights, self.observer);
            model = rest.descend_by(&misfit, &model, refine::THOROUGH, &|| ());
            // At the new parameters more experiments may have a response; those in the fit still
            // have one, as the misfit requires it. Fit again while the number grows.
            let still = self.unanswered(&model);
            if still.len() >= left_out.len() || self.observer.cancelled() {
                return Some((rest, model));
            }
            left_out = still;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::answers::{IdentifyOptions, PlantRequest};
    use crate::effects::find;
    use crate::identify::fixtures::joined;
    use crate::identify::problem::Scales;
    use crate::identify::request::{IdentifyRequest, no_response};
    use crate::identify::summary::Intervals;
    use crate::machines::simulator;
    use crate::machines::simulator::{Machine, Settings};
    use crate::measurement::{Complex, Experiment, Harmonic, Measurement};
    use crate::observer::Silent;
    use crate::plant::{Actuator, Friction, Plant};

    const STD: f64 = 1e-3;
    const JOINT: [f64; 4] = [0.182259, 59.97234, 0.1, 0.004244359];

    /// Magnitudes and frequencies (rad/s) at which the axis with backlash has no periodic response:
    /// its impacts never repeat. They lie in the middle of a band of frequencies, 3.27 to 3.47, where
    /// parameters that differ by some 1e-4 have no response either.
    const NON_PERIODIC: [(f64, f64); 2] = [(1.7315, 3.35), (1.7315, 3.39)];

    fn axis() -> Plant {
        Plant {
            constant: 1.660596,
            viscous_rate_rad_s: 3.042747,
            actuator: Actuator::SecondOrder {
                natural_frequency_rad_s: 6.245474,
                damping_ratio: 0.5944140,
            },
            friction: Friction::coulomb(0.2888457, 0.3872526),
        }
    }

    /// Twenty experiments in which the axis with backlash has a response, then two in which it has
    /// none: their data are those of the axis without backlash.
    fn measurement() -> Measurement {
        let [load_inertia_fraction, stiffness, damping, gap] = JOINT;
        let play = [simulator::Effect::new(
            "backlash",
            [
                ("load_inertia_fraction", load_inertia_fraction),
                ("stiffness", stiffness),
                ("damping", damping),
                ("gap", gap),
            ],
        )];
        let experiment = |effects: &[simulator::Effect], (magnitude, omega_rad_s)| {
            let machine = Machine { plant: axis(), effects };
            let input = vec![Complex::ZERO, Complex::new(magnitude, 0.0)];
            let velocity =
                simulator::respond(&machine, 0.0, omega_rad_s, &input, 5, &Settings::default());
            let harmonic = |(order, value)| Harmonic { order, value, std: Some(STD) };
            Some(Experiment {
                magnitude,
                omega_rad_s,
                input,
                input_mean_measured: false,
                mean_velocity: 0.0,
                rounding_std: 0.0,
                open_samples: None,
                bad_samples: None,
                clipping: None,
                range: None,
                unknown_input: Vec::new(),
                response: velocity.ok()?.into_iter().enumerate().map(harmonic).collect(),
                run: None,
                repeats: Vec::new(),
                from_record: false,
            })
        };
        let frequencies = (0..24).map(|i| 4.5 * 1.1_f64.powi(i));
        let places = frequencies.flat_map(|omega| [(0.8657, omega), (1.7315, omega)]);
        let periodic = places.filter_map(|place| experiment(&play, place)).take(20);
        let non_periodic = NON_PERIODIC.into_iter().filter_map(|place| experiment(&[], place));
        joined(periodic.chain(non_periodic).collect())
    }

    fn request() -> IdentifyRequest {
        let mut options = IdentifyOptions::default();
        options.network.enabled = false;
        options.colony.enabled = false;
        let plant = Some(PlantRequest { actuator_order: 2 });
        IdentifyRequest { plant, options, ..IdentifyRequest::default() }
    }

    /// The axis with its backlash.
    fn truth(session: &FitSession<'_>) -> Model {
        let play = find("backlash").unwrap();
        let mut model = session.extend(session.base(), play);
        let base = model.coordinates.point(&session.problem.in_scale(&axis()));
        model.point[..base.len()].copy_from_slice(&base);
        let Scales { omega, input, velocity } = session.problem.scales;
        for ((i, parameter), value) in model.parameters_of(0).zip(play.parameters()).zip(JOINT) {
            model.set(i, value / parameter.dimension.factor(input, velocity, 1.0 / omega));
        }
        model.cost = session.misfit(&model).cost(&model.point);
        model
    }

    #[test]
    fn a_model_that_answers_no_experiment_is_not_judged() {
        let experiments = measurement().experiments().to_vec();
        let measurement = joined(experiments.into_iter().rev().take(1).collect());
        let request = request();
        let session = FitSession::new(&measurement, &request, &Silent).unwrap();
        assert_eq!(
            session.judge(&truth(&session), Intervals::Curvature).err(),
            Some(no_response())
        );
    }

    // The data has no noise. With the stated deviation noise would give a χ² of 210; where the axis
    // has a response, hardly any of it is left.
    #[test]
    fn an_answer_is_fitted_to_the_experiments_that_its_model_answers_and_lists_the_others() {
        let measurement = measurement();
        let request = request();
        let session = FitSession::new(&measurement, &request, &Silent).unwrap();
        let model = truth(&session);
        assert!(model.cost.is_finite());

        let fit = session.judge(&model, Intervals::Curvature).unwrap();
        let answer = &fit.identification.fit;
        let places = answer.unanswered.iter();
        let places: Vec<_> =
            places.map(|lost| (lost.magnitude.unwrap(), lost.omega_rad_s.unwrap())).collect();
        assert_eq!(places, NON_PERIODIC);
        // Eleven real numbers in each of twenty experiments; six base parameters and four of the
        // backlash.
        assert_eq!(answer.dof, 20 * 11 - 10);
        assert_eq!(fit.residuals.len(), 20 * 11);
        assert_eq!(fit.components.len(), 20 * 11);
        assert!(answer.chi2.unwrap() < 21.0, "{:?}", answer.chi2);

        // In comparisons, an experiment without a response contributes the misfit of the base
        // model.
        let stood_in = session.from_rest(model.clone());
        let of_base = session.misfit(session.base()).residuals(&session.base().point).unwrap();
        let of_base = of_base.rows(20 * 11, 2 * 11).norm_squared();
        let least = answer.chi2.unwrap() + of_base;
        assert!(stood_in.cost > 0.99 * least, "{} {least}", stood_in.cost);
    }
}
