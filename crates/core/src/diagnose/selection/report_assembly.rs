//! Assembles the answer: verdict, causes, gain on held-out data, limitations.
//!
//! Effects of the chosen model that do not help to predict held-out data are dropped. If all of
//! them together do not help, all are withdrawn.

use crate::answers::{Diagnosis, Discrepancy, Gain, NextExperiment, Verdict};
use crate::identify::{FitAccuracy, FitSession, IdentifyError, Intervals, Model, ModelFit};
use crate::measurement::Measurement;
use crate::observer::Observer as _;

use super::models::{Key, Models};
use super::{causes, next_experiment};
use crate::diagnose::error::DiagnoseError;
use crate::diagnose::holdout::cross_validation::{CrossValidation, Dropped};
use crate::diagnose::holdout::cv_splits::CvSplits;
use crate::diagnose::linearity;
use crate::diagnose::progress::Part;
use crate::diagnose::residuals::{discrepancy, valid_band};

/// Shares of the progress: cross-validation; the final fit, its intervals, and the next experiment.
const HOLDOUT_SPAN: [f64; 2] = [0.0, 0.9];
const FINAL_SPAN: [f64; 2] = [0.9, 1.0];

/// The results of the study of one actuator order, from which the answer is assembled.
pub(crate) struct ReportAssembly<'a> {
    /// The session in which everything was fitted.
    pub session: &'a FitSession<'a>,
    /// The fit of the base model.
    pub fit: ModelFit,
    /// Where the base model is wrong.
    pub discrepancy: Discrepancy,
    /// Every fitted model.
    pub models: Models,
    /// Effects of the chosen model.
    pub chosen: Key,
    /// Whether the chosen model leaves only noise.
    pub fits: bool,
    /// Whether it also is convincing: [`causes::convincing`].
    pub explained: bool,
}

impl ReportAssembly<'_> {
    /// Assembles the answer.
    ///
    /// # Errors
    /// When cancelled, or if the extended model has no response.
    pub fn diagnosis(
        mut self,
        measurement: &Measurement,
        part: Part<'_>,
    ) -> Result<Diagnosis, DiagnoseError> {
        if part.last {
            part.rest_is_certain();
        }
        let mut limitations = discrepancy::limitations(&self.fit, &self.discrepancy);
        limitations.extend(crate::diagnose::limitations::undecided(self.session));
        limitations.extend(crate::diagnose::limitations::incomparable(&self.models));
        let cross_validation = match self.cross_validation(measurement, part.part(HOLDOUT_SPAN)) {
            Ok(cross_validation) => Some(cross_validation),
            Err(NoCrossValidation::Cancelled) => return Err(IdentifyError::Cancelled.into()),
            Err(NoCrossValidation::NoCauses) => None,
            Err(NoCrossValidation::Because(reason)) => {
                limitations
                    .push(format!("the improvement on held-out data is not known: {reason}"));
                None
            }
        };
        // If the model leaves only noise, every cause is significant, and none is dropped.
        let first_choice = self.chosen.clone();
        let prune = |cross_validation: &CrossValidation| {
            let dropped = cross_validation.prune(&self.models, &mut self.chosen);
            cross_validation.simplify(&self.models, &mut self.chosen);
            self.models.predict_alike = cross_validation.alike(&self.models, &self.chosen);
            dropped
        };
        let dropped =
            cross_validation.as_ref().filter(|_| !self.fits).map(prune).unwrap_or_default();
        let mut gain = cross_validation.as_ref().and_then(|cross_validation| {
            match self.chosen == first_choice {
                true => cross_validation.gain(&self.chosen),
                false => cross_validation.gain_of(&self.chosen),
            }
        });
        limitations.extend(dropped.iter().map(dropped_sentence));
        let mut withdrawn = Key::new();
        if let Some(failed) = gain.take_if(|gain| self.fails_held_out(gain)) {
            limitations.push(withdrawn_sentence(&self.chosen, &failed));
            withdrawn = std::mem::take(&mut self.chosen);
            // Then the base model stands, which may leave only noise.
            let is_noise = self.discrepancy.noise_like;
            (self.fits, self.explained) = (is_noise, is_noise);
        }
        if self.fits && !self.explained {
            limitations.push(format!(
                "with {} together the residual is noise, but such a combination may imitate a \
                 single effect that the library lacks: confirm each by an experiment of its own",
                self.chosen.join(" and ")
            ));
        }
        let stage = part.part(FINAL_SPAN).stage("final fit and intervals", 2);
        let extended = self.extended()?;
        let valid_band = valid_band::of(extended.as_ref().unwrap_or(&self.fit));
        let extended = extended.map(|fit| fit.identification);
        stage.step();
        let unit = &measurement.metadata().input.unit;
        let unanswered = |answer| crate::diagnose::limitations::unanswered(answer, unit);
        limitations.extend(extended.as_ref().and_then(unanswered));
        let Self { models, chosen, .. } = &self;
        let named =
            |extended| causes::named(models, chosen, extended, self.fits, measurement.metadata());
        let mut causes = extended.as_ref().map(named).unwrap_or_default();
        limitations.extend(crate::diagnose::limitations::held_input(measurement, &causes));
        if !self.explained {
            limitations.extend(crate::diagnose::limitations::cut_off_input(measurement));
        }
        for cause in &mut causes {
            cause.gain = match chosen.len() {
                1 => gain.clone(),
                _ => cross_validation.as_ref().and_then(|cross_validation| {
                    let own = chosen.iter().copied().filter(|id| *id == cause.effect);
                    cross_validation.gain_of(&own.collect())
                }),
            };
        }
        let mut candidates = causes::candidates(models, chosen, &withdrawn);
        for candidate in &mut candidates {
            let error = |cross_validation: &CrossValidation| {
                cross_validation.error_alone(&candidate.effect)
            };
            candidate.heldout_error = cross_validation.as_ref().and_then(error);
        }
        let next_experiment = self.next_experiment(causes.iter().map(|c| c.effect.as_str()));
        stage.step();
        Ok(Diagnosis {
            verdict: match (chosen.is_empty(), self.explained) {
                (true, true) => Verdict::Adequate,
                (true, false) => Verdict::Unexplained,
                (false, true) => Verdict::Explained,
                (false, false) => Verdict::Improved,
            },
            limitations,
            linearity: linearity(measurement),
            measurement: Vec::new(),
            as_measured: None,
            rival_faults: Vec::new(),
            valid_band,
            next_experiment,
            causes,
            candidates,
            gain,
            discrepancy: self.discrepancy,
            provenance: self.fit.identification.provenance.clone(),
            base: self.fit.identification,
            extended,
            validation: None,
        })
    }

    fn cross_validation(
        &self,
        measurement: &Measurement,
        part: Part<'_>,
    ) -> Result<CrossValidation, NoCrossValidation> {
        if self.chosen.is_empty() {
            return Err(NoCrossValidation::NoCauses);
        }
        let splits = CvSplits::of(measurement)
            .ok_or_else(|| NoCrossValidation::Because(TOO_SMALL.to_owned()))?;
        let models = (&self.models, &self.chosen);
        let cross_validation = CrossValidation::of(self.session, models, &splits, part);
        cross_validation.map_err(|error| match error {
            IdentifyError::Cancelled => NoCrossValidation::Cancelled,
            error => NoCrossValidation::Because(format!("when a part was held out, {error}")),
        })
    }

    /// Whether the gain on held-out data speaks against the causes. If they leave only noise, they
    /// fail only if they certainly predict worse. If they leave more, significance proves nothing,
    /// and they fail unless they certainly predict better.
    fn fails_held_out(&self, gain: &Gain) -> bool {
        let [low, high] = gain.interval95;
        if self.fits { high < 1.0 } else { low <= 1.0 }
    }

    /// The model with the causes, refined to full accuracy unless that leads to where it has no response
    /// from rest; `None` if no cause is named.
    fn extended(&self) -> Result<Option<ModelFit>, DiagnoseError> {
        let Self { session, models, chosen, .. } = self;
        let model = models.get(chosen).filter(|_| !chosen.is_empty());
        let judge = |model: &Model| {
            let refined = session.refine(model, FitAccuracy::Thorough);
            let judged = session.judge(&refined, Intervals::Profile);
            judged.or_else(|_| session.judge(model, Intervals::Profile))
        };
        Ok(model.map(judge).transpose()?)
    }

    /// The experiment that best separates a cause from its closest rival, for the first cause that
    /// has one.
    fn next_experiment<'c>(
        &self,
        mut causes: impl Iterator<Item = &'c str>,
    ) -> Option<NextExperiment> {
        let Self { session, models, chosen, .. } = self;
        causes.find_map(|cause| {
            let (rival, model) = causes::rivals(models, chosen, cause).into_iter().next()?;
            let named = (models.get(chosen)?, cause);
            next_experiment::between(session, named, (model, rival))
        })
    }
}

/// Why there is no cross-validation.
enum NoCrossValidation {
    /// The observer cancelled.
    Cancelled,
    /// No cause is named.
    NoCauses,
    /// It failed, for this reason.
    Because(String),
}

const TOO_SMALL: &str = "to hold data out takes five frequencies, three magnitudes, or a record \
                         with twenty lines";

fn dropped_sentence(Dropped { id, beside, gain }: &Dropped) -> String {
    format!(
        "{id} is not named: added to {} it improves the fit, but not the prediction of held-out \
         data ({})",
        beside.join(" and "),
        error_after(gain),
    )
}

fn withdrawn_sentence(chosen: &Key, gain: &Gain) -> String {
    format!(
        "{} would improve the fit, but not the prediction of held-out data ({}; {}), and is not \
         named",
        chosen.join(" and "),
        error_after(gain),
        gain.heldout
    )
}

/// How large the error on held-out data is beside that of the base model.
fn error_after(gain: &Gain) -> String {
    let [low, high] = gain.interval95;
    let [from, to] = [1.0 / high, 1.0 / low];
    format!("residual × {:.2}, 95 % interval {from:.2} to {to:.2}", 1.0 / gain.ratio)
}

#[cfg(test)]
mod tests {
    use super::super::evidence::NoiseScale;
    use super::super::models::ScoredModel;
    use super::*;
    use crate::diagnose::tests::{exact, key, noisy, request};
    use crate::effects::find;
    use crate::machines::draw::NoiseStatement;
    use crate::observer::Silent;

    #[test]
    fn where_the_causes_are_withdrawn_the_verdict_is_that_of_the_base_model() {
        let (measurement, request) = (noisy(&exact(), NoiseStatement::Std, 1), request());
        let session = &FitSession::new(&measurement, &request, &Silent).unwrap();
        let fit = session.judge(session.base(), Intervals::Curvature).unwrap();
        let discrepancy = discrepancy::of(&fit, 1, &Silent);
        assert!(discrepancy.noise_like, "{:?}", discrepancy.tests);
        let noise_scale = NoiseScale::of(session);
        let mut models = Models::new(session.base().clone(), noise_scale);
        let spring = session.extend(session.base(), find("spring").unwrap());
        let spring = session.refine(&spring, FitAccuracy::Settle);
        models.keep(ScoredModel::new(session, spring, &noise_scale));
        let (chosen, fits, explained) = (key(&["spring"]), false, false);
        let assembly =
            ReportAssembly { session, fit, discrepancy, models, chosen, fits, explained };
        let answer = assembly.diagnosis(&measurement, Part::of(&Silent)).unwrap();
        assert_eq!((answer.verdict, answer.causes.len()), (Verdict::Adequate, 0));
        let said = answer.limitations.iter().any(|said| said.starts_with("spring would improve"));
        assert!(said, "{:?}", answer.limitations);
    }

    #[test]
    fn a_dropped_effect_is_reported_with_the_effects_it_was_beside() {
        let gain = Gain {
            heldout_nrmse_before: 0.2,
            heldout_nrmse_after: 0.25,
            ratio: 0.8,
            interval95: [0.5, 1.3],
            chi2_per_dof_before: None,
            chi2_per_dof_after: None,
            heldout: "lines".into(),
        };
        let said = dropped_sentence(&Dropped { id: "spring", beside: vec!["backlash"], gain });
        assert!(said.starts_with("spring is not named: added to backlash it improves"), "{said}");
        assert!(said.contains("residual × 1.25, 95 % interval 0.77 to 2.00"), "{said}");
    }
}
