//! Everything that one order of the actuator leads to.

use crate::answers::{Diagnosis, Discrepancy, Identification, Verdict};
use crate::identify::{Effort, IdentifyError, Model, ModelFit, Workbench};
use crate::observer::Observer as _;

use super::evidence::Yardstick;
use super::progress::Part;
use super::search::{Key, Search};
use super::{DiagnoseError, ROUNDING, causes, discrepancy, next_experiment};

/// A base model, what it gets wrong, and the causes that were found.
pub(super) struct Study<'a> {
    workbench: &'a Workbench<'a>,
    fit: ModelFit,
    discrepancy: Discrepancy,
    search: Search<'a>,
    /// Effects of the model that was chosen.
    pub chosen: Key,
    explained: bool,
}

impl<'a> Study<'a> {
    /// Looks for what the workbench's base model lacks.
    ///
    /// # Errors
    /// When cancelled, or where the base model has no response.
    pub fn new(
        workbench: &'a Workbench<'a>,
        part: Part<'a>,
        seed: u64,
    ) -> Result<Self, DiagnoseError> {
        let fit = workbench.judge(workbench.base())?;
        let stage = part.part([0.0, 0.05]).stage("discrepancy", 1);
        let discrepancy = discrepancy::of(&fit, seed);
        stage.step();
        let yardstick = Yardstick {
            known: workbench.noise_known(),
            rounding: workbench.rounding(ROUNDING),
            dof: fit.identification.fit.dof.max(1) as f64,
        };
        let mut search = Search::new(workbench, part.part([0.05, 1.0]), seed, yardstick);
        let noise_like = |model: &Model| {
            let exact = !yardstick.known && yardstick.explains(model.cost);
            exact || workbench.judge(model).is_ok_and(|fit| discrepancy::is_noise(&fit, seed))
        };
        let mut chosen = search.run(&mut |model| noise_like(model));
        let mut explained = discrepancy.noise_like;
        if !chosen.is_empty() {
            explained = noise_like(&search.visited[&chosen].model);
            if !explained && yardstick.known {
                // What remains widens every uncertainty.
                search.yardstick = Yardstick { known: false, ..yardstick };
                chosen = search.best_supported();
            }
        }
        if part.cancelled() {
            return Err(IdentifyError::Cancelled.into());
        }
        Ok(Self { workbench, fit, discrepancy, search, chosen, explained })
    }

    /// −2 ln of what speaks for the model that was chosen: see [`super::evidence`].
    pub fn criterion(&self) -> f64 {
        self.search.criterion(&self.chosen)
    }

    /// The answer.
    ///
    /// # Errors
    /// Where the extended model has no response.
    pub fn diagnosis(self) -> Result<Diagnosis, DiagnoseError> {
        let Self { workbench, fit, discrepancy, search, chosen, explained } = self;
        let extended = extended(workbench, &search, &chosen)?;
        let causes = extended
            .as_ref()
            .map(|extended| causes::named(&search, &chosen, extended, explained))
            .unwrap_or_default();
        let next_experiment = causes.iter().find_map(|cause| {
            let rivals = causes::rivals(&search, &chosen, &cause.effect);
            let (rival, model) = rivals.into_iter().next()?;
            let named = (&search.visited[&chosen].model, cause.effect.as_str());
            next_experiment::between(workbench, named, (model, rival))
        });
        Ok(Diagnosis {
            verdict: match (chosen.is_empty(), explained) {
                (true, true) => Verdict::Adequate,
                (true, false) => Verdict::Unexplained,
                (false, true) => Verdict::Explained,
                (false, false) => Verdict::Improved,
            },
            limitations: discrepancy::limitations(&fit, &discrepancy),
            discrepancy,
            causes,
            candidates: causes::candidates(&search, &chosen),
            gain: None,
            provenance: fit.identification.provenance.clone(),
            base: fit.identification,
            extended,
            next_experiment,
        })
    }
}

/// The model with these effects, to the last digit; `None` where there are none.
fn extended(
    workbench: &Workbench<'_>,
    search: &Search<'_>,
    chosen: &Key,
) -> Result<Option<Identification>, DiagnoseError> {
    if chosen.is_empty() {
        return Ok(None);
    }
    let model = workbench.refine(&search.visited[chosen].model, Effort::Thorough);
    Ok(Some(workbench.judge(&model)?.identification))
}
