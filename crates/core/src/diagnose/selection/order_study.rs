//! Everything that one order of the actuator leads to.

use crate::answers::Discrepancy;
use crate::identify::{IdentifyError, Intervals, Model, ModelFit, Workbench};
use crate::measurement::Measurement;
use crate::observer::Observer as _;

use super::causes;
use super::evidence::Yardstick;
use super::models::Key;
use super::report_assembly::Conclusion;
use crate::diagnose::error::DiagnoseError;
use crate::diagnose::holdout::cv_splits::Folds;
use crate::diagnose::progress::Part;
use crate::diagnose::residuals::discrepancy;
use crate::diagnose::search::Search;

/// Parameters of a base model, at most: of models of any order the misfit counts alike.
const LARGEST_BASE: usize = 6;

/// Shares of the second part: several effects together, and the chosen ones from more starts.
const COMBINING: [f64; 2] = [0.0, 0.8];
const DEEPENING: [f64; 2] = [0.8, 1.0];

/// A base model, what it gets wrong, and the causes that were found.
pub(crate) struct Study<'a> {
    workbench: &'a Workbench<'a>,
    fit: ModelFit,
    discrepancy: Discrepancy,
    search: Search<'a>,
    seed: u64,
    /// Effects of the model that was chosen.
    pub chosen: Key,
    /// Whether noise is all that it leaves.
    fits: bool,
}

impl<'a> Study<'a> {
    /// Fits every effect alone beside the workbench's base model.
    ///
    /// # Errors
    /// When cancelled, or where the base model has no response.
    pub fn new(
        workbench: &'a Workbench<'a>,
        part: Part<'_>,
        seed: u64,
    ) -> Result<Self, DiagnoseError> {
        let fit = workbench.judge(workbench.base(), Intervals::Profile)?;
        let stage = part.part([0.0, 0.05]).stage("discrepancy", 1);
        let discrepancy = discrepancy::of(&fit, seed);
        stage.step();
        let yardstick = Yardstick {
            known: workbench.noise_known(),
            rounding: workbench.rounding(),
            dof: workbench.data().saturating_sub(LARGEST_BASE).max(1) as f64,
        };
        let search = Search::new(workbench, part.part([0.05, 1.0]), seed, yardstick);
        let (chosen, fits) = (Key::new(), discrepancy.noise_like);
        let mut this = Self { workbench, fit, discrepancy, search, seed, chosen, fits };
        this.choose(part)?;
        Ok(this)
    }

    /// Fits several effects together, up to `most`, where one is not enough. Of records, on
    /// which every further effect takes minutes, only as long as one more is expected to
    /// predict better what is left out of a fit to the `measurement`.
    ///
    /// # Errors
    /// When cancelled.
    pub fn combine(
        &mut self,
        part: Part<'_>,
        most: usize,
        measurement: &Measurement,
    ) -> Result<(), DiagnoseError> {
        let Self { workbench, search, seed, .. } = self;
        let yardstick = search.models.yardstick;
        let sufficient = |model: &Model| noise_like(workbench, yardstick, model, *seed);
        let folds = if workbench.has_cosines_alone() { None } else { Folds::of(measurement) };
        let adds = |without: &Model, with: &Model| {
            let Some(folds) = &folds else { return true };
            let errors = [without, with]
                .map(|model| workbench.error_left_out(model, |e, order| folds.part_of(e, order)));
            matches!(errors, [Some(without), Some(with)] if with < without)
        };
        search.combine(part.part(COMBINING), most, sufficient, adds);
        self.choose(part)?;
        self.search.deepen(&self.chosen, part.part(DEEPENING));
        self.choose(part)
    }

    /// Chooses among the models that were fitted.
    fn choose(&mut self, part: Part<'_>) -> Result<(), DiagnoseError> {
        let models = &mut self.search.models;
        self.chosen = models.best_supported();
        self.fits = match models.get(&self.chosen) {
            Some(model) if !self.chosen.is_empty() => {
                noise_like(self.workbench, models.yardstick, model, self.seed)
            }
            _ => self.discrepancy.noise_like,
        };
        if part.cancelled() {
            return Err(IdentifyError::Cancelled.into());
        }
        Ok(())
    }

    /// Order of the actuator.
    pub fn order(&self) -> u8 {
        self.workbench.order()
    }

    /// Whether the model that was chosen leaves noise alone, and is no imitation of
    /// something else.
    pub fn explained(&self) -> bool {
        self.fits && causes::convincing(&self.search.models, &self.chosen)
    }

    /// −2 ln of what speaks for the model that was chosen: see [`super::evidence`].
    pub fn criterion(&self) -> f64 {
        self.search.models.criterion(&self.chosen)
    }

    /// What it comes to.
    pub fn conclusion(self) -> Conclusion<'a> {
        let explained = self.explained();
        let Self { workbench, fit, discrepancy, search, mut chosen, fits, .. } = self;
        let mut models = search.models;
        if !chosen.is_empty() && !fits && models.yardstick.known {
            // What remains widens every uncertainty.
            models.yardstick.known = false;
            chosen = models.best_supported();
        }
        Conclusion { workbench, fit, discrepancy, models, chosen, fits, explained }
    }
}

/// Whether noise is all that a model leaves.
fn noise_like(workbench: &Workbench<'_>, yardstick: Yardstick, model: &Model, seed: u64) -> bool {
    let exact = !yardstick.known && yardstick.explains(model.cost);
    let fit = || workbench.judge(model, Intervals::Curvature);
    exact || fit().is_ok_and(|fit| discrepancy::is_noise(&fit, seed))
}
