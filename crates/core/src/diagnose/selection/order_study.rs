//! The study of one actuator order: residual tests, search for missing effects, model choice.

use crate::answers::{AsMeasured, Discrepancy, Identification};
use crate::identify::{FitAccuracy, FitSession, IdentifyError, Intervals, Model, ModelFit};
use crate::measurement::Measurement;
use crate::observer::Observer as _;

use super::causes;
use super::evidence::NoiseScale;
use super::models::Key;
use super::report_assembly::ReportAssembly;
use crate::diagnose::error::DiagnoseError;
use crate::diagnose::faults::of_records;
use crate::diagnose::faults::suspects::{Suspected, Suspects, misfit};
use crate::diagnose::holdout::cv_splits::CvSplits;
use crate::diagnose::progress::Part;
use crate::diagnose::residuals::discrepancy;
use crate::diagnose::search::Search;

/// Shares of the progress of [`OrderStudy::new`]: the tests of residuals, and every effect alone.
const RESIDUALS_SPAN: [f64; 2] = [0.0, 0.05];
const SINGLES_SPAN: [f64; 2] = [0.05, 1.0];

/// Shares of the progress of [`OrderStudy::combine`]: fitting several effects together, refitting the
/// chosen ones from more starting points, if that is done, and their imitators.
const COMBINING_SPAN: [f64; 2] = [0.0, 0.75];
const MULTISTART_SPAN: [f64; 2] = [0.75, 0.9];
const IMITATORS_SPAN: [f64; 2] = [0.9, 1.0];

/// A base model of one actuator order, where it is wrong, and the effects found to be missing.
pub(crate) struct OrderStudy<'a> {
    session: &'a FitSession<'a>,
    fit: ModelFit,
    discrepancy: Discrepancy,
    search: Search<'a>,
    seed: u64,
    /// Whether effects were combined.
    combined: bool,
    /// Effects of the chosen model.
    pub chosen: Key,
    /// Whether the chosen model leaves only noise.
    fits: bool,
}

impl<'a> OrderStudy<'a> {
    /// Tests the residuals of the session's base model and fits every effect alone beside it.
    ///
    /// # Errors
    /// When cancelled, or if the base model has no response.
    pub fn new(
        session: &'a FitSession<'a>,
        part: Part<'_>,
        seed: u64,
    ) -> Result<Self, DiagnoseError> {
        let stage = part.part(RESIDUALS_SPAN).stage("testing the residual", 2);
        let fit = session.judge(session.base(), Intervals::Profile)?;
        stage.step();
        let discrepancy = discrepancy::of(&fit, seed, session.observer());
        stage.step();
        let noise_scale = NoiseScale::of(session);
        let search = Search::new(session, part.part(SINGLES_SPAN), seed, noise_scale);
        let (chosen, fits) = (Key::new(), discrepancy.noise_like);
        let mut this =
            Self { session, fit, discrepancy, search, seed, combined: false, chosen, fits };
        this.choose(part)?;
        this.leave_local_minimum(part)?;
        Ok(this)
    }

    /// Where the chosen effect leaves no more than noise would, but with a structure, it may be in a
    /// wrong local minimum: then it is started again. Else a few rows that speak against that minimum
    /// would be taken for faults of the measurement.
    fn leave_local_minimum(&mut self, part: Part<'_>) -> Result<(), DiagnoseError> {
        let Self { session, search, seed, chosen, .. } = self;
        let noise_scale = search.models.noise_scale;
        let explains = |model: &Model| noise_scale.explains(model.cost);
        if self.fits || chosen.is_empty() || !search.models.get(chosen).is_some_and(explains) {
            return Ok(());
        }
        let sufficient = |model: &Model| noise_like(session, noise_scale, model, *seed);
        search.restart(chosen, part.part([1.0, 1.0]), sufficient);
        self.choose(part)
    }

    /// Fits several effects together, up to `most`, if one is not enough. On time records, where
    /// every further effect takes minutes, one is added only while it is expected to lower the
    /// cross-validation error on `measurement` (to first order).
    ///
    /// # Errors
    /// When cancelled.
    pub fn combine(
        &mut self,
        part: Part<'_>,
        most: usize,
        measurement: &Measurement,
    ) -> Result<(), DiagnoseError> {
        let Self { session, search, seed, .. } = self;
        let noise_scale = search.models.noise_scale;
        let sufficient = |model: &Model| noise_like(session, noise_scale, model, *seed);
        let splits = if session.has_cosines_alone() { None } else { CvSplits::of(measurement) };
        let adds = |without: &Model, with: &Model| {
            let Some(splits) = &splits else { return true };
            let error =
                |model| session.leaving_out(model)?.error(|e, order| splits.part_of(e, order));
            let errors = [without, with].map(error);
            matches!(errors, [Some(without), Some(with)] if with < without)
        };
        let combining = if search.deepens() { COMBINING_SPAN } else { [0.0, 0.9] };
        search.combine(part.part(combining), most, sufficient, adds);
        self.combined = true;
        self.choose(part)?;
        self.search.deepen(&self.chosen, part.part(MULTISTART_SPAN));
        self.choose(part)?;
        if self.search.exchange_nested(&self.chosen, part) {
            self.choose(part)?;
        }
        if self.fits {
            self.search.exchange_imitators(&self.chosen, part.part(IMITATORS_SPAN));
            self.choose(part)?;
        }
        Ok(())
    }

    /// Chooses the best supported model among those fitted so far.
    fn choose(&mut self, part: Part<'_>) -> Result<(), DiagnoseError> {
        if part.cancelled() {
            return Err(IdentifyError::Cancelled.into());
        }
        let models = &mut self.search.models;
        self.chosen = models.best_verified(self.session);
        self.fits = match models.get(&self.chosen) {
            Some(model) if !self.chosen.is_empty() => {
                noise_like(self.session, models.noise_scale, model, self.seed)
            }
            _ => self.discrepancy.noise_like,
        };
        Ok(())
    }

    /// The best model with faults of the measurement, with no effects but those of `explaining`, if any
    /// model leaves only noise: one with other effects and a fault cannot be more likely. By `lead_s` (s)
    /// the response was ahead of the input before that was mended.
    pub fn suspected(&self, lead_s: f64, explaining: Option<&Key>) -> Option<Suspected> {
        let is_part = |of: &Key, key: &Key| key.iter().all(|id| of.contains(id));
        let wanted = |key: &Key| explaining.is_none_or(|of| is_part(of, key));
        let suspects = Suspects { lead_s, ..self.suspects() };
        match self.session.has_cosines_alone() {
            true => suspects.best(wanted),
            false => of_records::best(&suspects, wanted),
        }
    }

    /// −2 ln evidence of the best model without faults, comparable with that of [`Self::suspected`].
    pub fn best_criterion(&self) -> f64 {
        self.suspects().best_without()
    }

    /// −2 ln evidence of the chosen effects beside the base model of a session of another order,
    /// comparable with [`Self::criterion`]; `None` if there is no such model.
    pub fn criterion_beside(&self, other: &FitSession<'_>) -> Option<f64> {
        let models = &self.search.models;
        let model = models.get(&self.chosen)?;
        let reported = self.session.judge(model, Intervals::Curvature).ok()?.identification;
        let base = other.base().clone();
        let start =
            model.effects().iter().fold(base, |model, effect| other.extend(&model, *effect));
        let fitted =
            other.refine(&other.with_reported_effects(&start, &reported)?, FitAccuracy::Settle);
        let NoiseScale { dof, known, .. } = models.noise_scale;
        Some(misfit(fitted.cost, dof, known) + models.complexity(&self.chosen))
    }

    fn suspects(&self) -> Suspects<'_> {
        let Self { session, fit, search, seed, combined, .. } = self;
        let (models, combined, seed) = (&search.models, *combined, *seed);
        Suspects { session, base: fit, models, combined, seed, lead_s: 0.0 }
    }

    /// The chosen model.
    ///
    /// # Errors
    /// If it has no response.
    pub fn best(&self) -> Result<Identification, DiagnoseError> {
        let model = self.search.models.get(&self.chosen).unwrap_or(self.session.base());
        Ok(self.session.judge(model, Intervals::Curvature)?.identification)
    }

    /// The answer so far.
    ///
    /// # Errors
    /// If a model has no response.
    pub fn as_measured(&self) -> Result<AsMeasured, DiagnoseError> {
        let base = &self.fit.identification.fit;
        let model = self.search.models.get(&self.chosen).filter(|_| !self.chosen.is_empty());
        let fit = model.map(|model| self.session.judge(model, Intervals::Curvature)).transpose()?;
        Ok(AsMeasured {
            nrmse: base.nrmse,
            chi2_per_dof: base.chi2_per_dof,
            causes: self.chosen.iter().map(|id| (*id).to_owned()).collect(),
            nrmse_with_causes: fit.map(|fit| fit.identification.fit.nrmse),
        })
    }

    /// Order of the actuator.
    pub fn order(&self) -> u8 {
        self.session.order()
    }

    /// Whether the chosen model leaves only noise and is convincing: [`causes::convincing`].
    pub fn explained(&self) -> bool {
        self.fits && causes::convincing(&self.search.models, &self.chosen)
    }

    /// −2 ln evidence of the chosen model: see [`super::evidence`].
    pub fn criterion(&self) -> f64 {
        self.search.models.criterion(&self.chosen)
    }

    /// The results from which the answer is assembled.
    pub fn conclusion(self) -> ReportAssembly<'a> {
        let explained = self.explained();
        let Self { session, fit, discrepancy, search, mut chosen, fits, .. } = self;
        let mut models = search.models;
        if !chosen.is_empty() && !fits && models.noise_scale.known {
            // Count what the model leaves as noise, which widens every uncertainty.
            models.noise_scale.known = false;
            chosen = models.best_supported();
        }
        ReportAssembly { session, fit, discrepancy, models, chosen, fits, explained }
    }
}

/// Whether a model leaves only noise.
fn noise_like(session: &FitSession<'_>, noise_scale: NoiseScale, model: &Model, seed: u64) -> bool {
    let exact = !noise_scale.known && noise_scale.explains(model.cost);
    exact || discrepancy::leaves_noise(session, model, seed)
}
