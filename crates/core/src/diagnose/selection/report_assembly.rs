//! Puts together the answer: verdict, causes, gain on held-out data, limitations.

use crate::answers::{Diagnosis, Discrepancy, Gain, Identification, NextExperiment, Verdict};
use crate::identify::{
    FitAccuracy, FitSession, IdentifyError, IdentifyRequest, Intervals, ModelFit,
};
use crate::measurement::Measurement;

use super::models::{Key, Models};
use super::{causes, next_experiment};
use crate::diagnose::error::DiagnoseError;
use crate::diagnose::holdout::cross_validation::{CrossValidation, Dropped};
use crate::diagnose::holdout::cv_splits::CvSplits;
use crate::diagnose::progress::Part;
use crate::diagnose::residuals::discrepancy;

/// What one order of the actuator comes to.
pub(crate) struct ReportAssembly<'a> {
    /// Where everything was fitted.
    pub session: &'a FitSession<'a>,
    /// The base model.
    pub fit: ModelFit,
    /// What it gets wrong.
    pub discrepancy: Discrepancy,
    /// Everything that was fitted.
    pub models: Models,
    /// Effects of the model that was chosen.
    pub chosen: Key,
    /// Whether noise is all that it leaves.
    pub fits: bool,
    /// Whether it is no imitation of something else, either.
    pub explained: bool,
}

impl ReportAssembly<'_> {
    /// The answer.
    ///
    /// # Errors
    /// When cancelled, or where the extended model has no response.
    pub fn diagnosis(
        mut self,
        measurement: &Measurement,
        request: &IdentifyRequest,
        part: Part<'_>,
    ) -> Result<Diagnosis, DiagnoseError> {
        let mut limitations = discrepancy::limitations(&self.fit, &self.discrepancy);
        limitations.extend(crate::diagnose::limitations::undecided(self.session));
        limitations.extend(crate::diagnose::limitations::incomparable(&self.models));
        let cross_validation = match self.cross_validation(measurement, request, part) {
            Ok(cross_validation) => Some(cross_validation),
            Err(Silence::Cancelled) => return Err(IdentifyError::Cancelled.into()),
            Err(Silence::Nothing) => None,
            Err(Silence::Because(reason)) => {
                limitations.push(format!(
                    "what the causes gain on data that no fit has seen is not known: {reason}"
                ));
                None
            }
        };
        // Where noise is all that is left, every cause is more than chance, and stays.
        let prune = |cross_validation: &CrossValidation| {
            cross_validation.prune(&self.models, &mut self.chosen)
        };
        let dropped =
            cross_validation.as_ref().filter(|_| !self.fits).map(prune).unwrap_or_default();
        let mut gain =
            cross_validation.as_ref().and_then(|cross_validation| match dropped.is_empty() {
                true => cross_validation.gain(&self.chosen),
                false => cross_validation.gain_of(&self.chosen),
            });
        limitations.extend(dropped.iter().map(useless));
        let mut withdrawn = Key::new();
        if let Some(disappointing) = gain.take_if(|gain| self.disappoints(gain)) {
            limitations.push(disappointed(&self.chosen, &disappointing));
            withdrawn = std::mem::take(&mut self.chosen);
            (self.fits, self.explained) = (false, false);
        }
        if self.fits && !self.explained {
            limitations.push(format!(
                "{} together leave nothing but noise, but such a combination may imitate a single \
                 effect that the library lacks: confirm each by an experiment of its own",
                self.chosen.join(" and ")
            ));
        }
        let extended = self.extended()?;
        limitations.extend(extended.as_ref().and_then(crate::diagnose::limitations::unanswered));
        let Self { models, chosen, .. } = &self;
        let named = |extended| causes::named(models, chosen, extended, self.fits);
        let mut causes = extended.as_ref().map(named).unwrap_or_default();
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
        Ok(Diagnosis {
            verdict: match (chosen.is_empty(), self.explained) {
                (true, true) => Verdict::Adequate,
                (true, false) => Verdict::Unexplained,
                (false, true) => Verdict::Explained,
                (false, false) => Verdict::Improved,
            },
            limitations,
            next_experiment: self.next_experiment(causes.iter().map(|c| c.effect.as_str())),
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

    /// What is predicted of data held out.
    fn cross_validation(
        &self,
        measurement: &Measurement,
        request: &IdentifyRequest,
        part: Part<'_>,
    ) -> Result<CrossValidation, Silence> {
        if self.chosen.is_empty() {
            return Err(Silence::Nothing);
        }
        let splits =
            CvSplits::of(measurement).ok_or_else(|| Silence::Because(TOO_SMALL.to_owned()))?;
        let models = (&self.models, &self.chosen);
        let cross_validation = CrossValidation::of(self.session, request, models, &splits, part);
        cross_validation.map_err(|error| match error {
            IdentifyError::Cancelled => Silence::Cancelled,
            error => Silence::Because(format!("without a part of it, {error}")),
        })
    }

    /// Whether the causes do not predict what they should. Where they leave noise alone, that
    /// they are wrong must be certain; where they do not, significance proves nothing and that
    /// they help must be.
    fn disappoints(&self, gain: &Gain) -> bool {
        let [low, high] = gain.interval95;
        if self.fits { high < 1.0 } else { low <= 1.0 }
    }

    /// The model with the causes, to the last digit; `None` where there are none.
    fn extended(&self) -> Result<Option<Identification>, DiagnoseError> {
        let Self { session, models, chosen, .. } = self;
        let model = models.get(chosen).filter(|_| !chosen.is_empty());
        let thorough = |model| session.refine(model, FitAccuracy::Thorough);
        let judge = |model| session.judge(&thorough(model), Intervals::Profile);
        Ok(model.map(judge).transpose()?.map(|fit| fit.identification))
    }

    /// What separates the first cause that has a rival from it.
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

/// Why nothing is said of a gain.
enum Silence {
    /// Somebody cancelled.
    Cancelled,
    /// There is nothing that could gain.
    Nothing,
    /// For this reason.
    Because(String),
}

const TOO_SMALL: &str = "that takes five frequencies, three magnitudes, or a record with twenty \
                         lines, to hold some out";

fn useless(Dropped { id, beside, gain }: &Dropped) -> String {
    let [low, high] = gain.interval95;
    format!(
        "with {id} beside {} the model would fit the data better, but not predict what the fit \
         has not seen: there the error is divided by {:.3}, 95 % from {low:.3} to {high:.3}; so it \
         is not named",
        beside.join(" and "),
        gain.ratio,
    )
}

fn disappointed(chosen: &Key, gain: &Gain) -> String {
    let [low, high] = gain.interval95;
    format!(
        "{} would fit the data better, but not predict what the fit has not seen: there the error \
         is divided by {:.3}, 95 % from {low:.3} to {high:.3} ({}); so it is not named",
        chosen.join(" and "),
        gain.ratio,
        gain.heldout
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_withdrawn_is_said_with_what_it_was_beside() {
        let gain = Gain {
            heldout_nrmse_before: 0.2,
            heldout_nrmse_after: 0.25,
            ratio: 0.8,
            interval95: [0.5, 1.3],
            chi2_per_dof_before: None,
            chi2_per_dof_after: None,
            heldout: "lines".into(),
        };
        let said = useless(&Dropped { id: "spring", beside: vec!["backlash"], gain });
        assert!(said.starts_with("with spring beside backlash the model would fit"), "{said}");
        assert!(said.contains("divided by 0.800, 95 % from 0.500 to 1.300"), "{said}");
    }
}
