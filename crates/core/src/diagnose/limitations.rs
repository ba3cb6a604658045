//! Sentences on what a diagnosis cannot say.

use crate::answers::{Identification, Unanswered};
use crate::effects::ALL;
use crate::identify::FitSession;

use super::selection::models::Models;

/// Names the effects that could not be tried because there are too few data.
pub(super) fn undecided(session: &FitSession<'_>) -> Option<String> {
    let base = session.base();
    let lacking: Vec<&str> = ALL
        .iter()
        .filter(|effect| !session.can_decide(base, **effect))
        .map(|effect| effect.id())
        .collect();
    let what = match lacking.len() {
        0 => return None,
        all if all == ALL.len() => "no effect of the library".to_owned(),
        _ => lacking.join(", "),
    };
    Some(format!(
        "{} numbers were measured, and the base model alone has {} parameters: too few data to \
         decide on {what}; measure more frequencies, magnitudes or harmonics",
        session.data(),
        base.parameters()
    ))
}

/// Names the effects that were fitted but have no finite criterion: the model has no response in
/// too many experiments, or one without derivatives.
pub(super) fn incomparable(models: &Models) -> Option<String> {
    let fitted = models.all().map(|(key, _)| key).filter(|key| key.len() == 1);
    let without: Vec<&str> =
        fitted.filter(|key| !models.criterion(key).is_finite()).map(|key| key[0]).collect();
    (!without.is_empty()).then(|| {
        format!(
            "{} could be fitted, but not compared with the others: there its simulation has no \
             periodic response, or one that jumps with the parameters",
            without.join(", ")
        )
    })
}

/// Largest number of experiments that the sentence lists.
const MOST_PLACES: usize = 3;

/// Lists the experiments in which a model has no response.
pub(super) fn unanswered(answer: &Identification) -> Option<String> {
    let experiments = &answer.fit.unanswered;
    if experiments.is_empty() {
        return None;
    }
    let at = |lost: &Unanswered| {
        Some(format!("magnitude {} at {:.4} rad/s", lost.magnitude?, lost.omega_rad_s?))
    };
    let places: Vec<String> = experiments.iter().take(MOST_PLACES).filter_map(at).collect();
    let more = match experiments.len() - places.len() {
        0 => String::new(),
        more => format!(" and {more} more"),
    };
    Some(format!(
        "the model has no periodic response from rest in {} of the experiments ({}{more}): they \
         are in no sum of its fit, and what the axis does there it does not say",
        experiments.len(),
        places.join(", "),
    ))
}
