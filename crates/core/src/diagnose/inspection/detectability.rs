//! From which size a measurement shows an effect.
//!
//! The base model is fitted. Beside it, every effect of the library is simulated at a typical size
//! for the fitted machine and scaled until its *excess* reaches the limit: the χ² that the base
//! model, refitted, would leave of it in data without noise. One Gauss–Newton step of the base model
//! finds what that is. What is left of it outside the directions in which another effect shows says
//! from which size the effect would be told from that imitator.

use rayon::prelude::*;

use crate::answers::{Detectability, DetectableEffect, EffectSize};
use crate::effects::Effect;
use crate::identify::{FitSession, IdentifyError, IdentifyRequest, Intervals, no_response};
use crate::measurement::{Measurement, per_cent};

use super::size::{SizeSearch, Sized, Unseen};
use crate::diagnose::progress::Part;
use crate::diagnose::residuals::subspace::Subspace;
use crate::diagnose::search::linearization::Linearization;
use crate::diagnose::search::score_tests::Changes;

/// The excess χ² from which an effect is detectable (contract, section 2).
const LEAST_EXCESS: f64 = 120.0;

/// Shares of the progress at which the fit of the base model and the sizes end.
const FITTED: f64 = 0.4;
const SIZED: f64 = 0.7;

/// A smaller relative change of the response is rounding.
const ROUNDING: f64 = 1e-9;

/// From which size a measurement shows each effect of the library.
///
/// # Errors
/// See [`IdentifyError`].
pub(super) fn of(
    measurement: &Measurement,
    request: &IdentifyRequest,
    part: Part<'_>,
) -> Result<Detectability, IdentifyError> {
    let fitting = part.part([0.0, FITTED]);
    let session = FitSession::new(measurement, request, &fitting)?;
    let base = session.judge(session.base(), Intervals::Curvature)?.identification;
    let linearization = Linearization::new(&session, session.base()).ok_or_else(no_response)?;
    let search = SizeSearch::new(&session, &linearization, LEAST_EXCESS);
    let library = session.library();

    let stage = part.part([FITTED, SIZED]).stage("sizes of effects", library.len());
    let sizes: Vec<Result<Sized, Unseen>> = library
        .par_iter()
        .map(|effect| {
            let sized = search.smallest(*effect);
            stage.step();
            sized
        })
        .collect();
    let stage = part.part([SIZED, 1.0]).stage("imitators", library.len());
    let spans: Vec<Vec<Subspace>> = library
        .par_iter()
        .map(|effect| {
            let changes = Changes::of(&session, &linearization, *effect);
            let spans = changes.probe(&session, &linearization).spans;
            stage.step();
            spans
        })
        .collect();

    let looked = Looked { session: &session, search, spans };
    let effects = sizes.iter().enumerate().map(|(index, found)| looked.effect(index, found));
    Ok(Detectability {
        noise: base.noise,
        nrmse: base.fit.nrmse,
        chi2_per_dof: base.fit.chi2_per_dof,
        least_excess: LEAST_EXCESS,
        effects: effects.collect(),
    })
}

/// What every effect of the library does to the response.
struct Looked<'a> {
    session: &'a FitSession<'a>,
    search: SizeSearch<'a>,
    /// The directions in which each effect would show.
    spans: Vec<Vec<Subspace>>,
}

impl Looked<'_> {
    /// From which size the effect at an index of the library shows.
    fn effect(&self, index: usize, found: &Result<Sized, Unseen>) -> DetectableEffect {
        let effect = self.session.library()[index];
        let mut answer = DetectableEffect {
            effect: effect.id().to_owned(),
            title: effect.descriptor().title.to_owned(),
            detected_from: None,
            named_from: None,
            closest_imitator: None,
            reason: None,
        };
        match found {
            Err(unseen) => answer.reason = Some(reason(&self.search, effect, unseen)),
            Ok(found) => {
                answer.detected_from = Some(self.size(effect, found));
                let named = match self.closest(index, found) {
                    None => Some(found.clone()),
                    Some((imitator, span)) => {
                        answer.closest_imitator = Some(imitator.id().to_owned());
                        self.search.beyond(effect, found, span)
                    }
                };
                answer.named_from = named.map(|named| self.size(effect, &named));
            }
        }
        answer
    }

    fn size(&self, effect: &dyn Effect, sized: &Sized) -> EffectSize {
        EffectSize {
            parameters: self.session.in_units(effect, &sized.values),
            set_by: self.search.set_by(effect, sized),
            change: self.search.relative(sized),
        }
    }

    /// The other effect that explains the largest share of what the base model does not take up,
    /// and the directions in which it does.
    fn closest(&self, index: usize, found: &Sized) -> Option<(&'static dyn Effect, &Subspace)> {
        let direction = found.left.normalize();
        let others = self.spans.iter().enumerate().filter(|(other, _)| *other != index);
        others
            .flat_map(|(other, spans)| spans.iter().map(move |span| (other, span)))
            .map(|(other, span)| (other, span, span.energy(&direction)))
            .max_by(|a, b| a.2.total_cmp(&b.2))
            .map(|(other, span, _)| (self.session.library()[other], span))
    }
}

/// Why an effect is not seen, as a clause.
fn reason(search: &SizeSearch<'_>, effect: &dyn Effect, unseen: &Unseen) -> String {
    let sized = match unseen {
        _ if search.lacks_order(effect) => {
            return "the order of acquisition is not given; add the column `run`".into();
        }
        Unseen::NoResponse => {
            return "it could not be simulated: there is no periodic motion at \
                                      these magnitudes and frequencies"
                .into();
        }
        Unseen::TooSmall(sized) => sized,
    };
    let change = search.relative(sized);
    if change < ROUNDING {
        return "it has no effect at the points measured".into();
    }
    match search.raw_share(sized) {
        share if share < 1.0 => format!(
            "even a large one changes the response by {} only, less than the noise would show",
            per_cent(change)
        ),
        _ => "other values of pole, constant and friction look the same; measure more magnitudes, \
              frequencies or harmonics"
            .into(),
    }
}
