//! Which effects of a machine are accepted as hidden ones.

use servoscope_core::measurement::Measurement;

use super::{Hidden, MakeError};
use crate::machines::draw::{Draw, DrawError};
use crate::machines::simulator::Effect;
use crate::naming::case::{Case, Kind};
use crate::naming::excess::DETECTABLE;
use crate::naming::rivals::Rivals;

/// Smallest excess χ² of an outsider, with the effect of the library that imitates it best.
const MIN_OUTSIDER_EXCESS: f64 = 60.0;

/// The hidden effects with their excess, judged by the noise-free measurement; `None` if one effect of
/// a pair is not detectable, or an effect of the library imitates an outsider.
pub(super) fn accepted(
    case: &Case,
    machine: &Draw,
    exact: impl Fn() -> Result<Measurement, DrawError>,
    excess: f64,
) -> Result<Option<Vec<Hidden>>, MakeError> {
    let rivals = || -> Result<Rivals, MakeError> { Ok(Rivals::ask(&exact()?, case.order)?) };
    let excesses = match case.kind {
        Kind::Pair => {
            let ids = [machine.effects[0].id(), machine.effects[1].id()];
            detectable_beside(&rivals()?, ids)?.map(Vec::from)
        }
        Kind::Outsider => is_outside(&rivals()?, machine)?.then(|| vec![excess]),
        _ => Some(vec![excess]),
    };
    let hidden = |(effect, excess): (&Effect, f64)| Hidden::of(effect, excess);
    Ok(excesses.map(|excesses| machine.effects.iter().zip(excesses).map(hidden).collect()))
}

/// Excess of each of two effects if only the other is in the model; `None` if one of them is not
/// detectable.
fn detectable_beside(rivals: &Rivals, ids: [&str; 2]) -> Result<Option<[f64; 2]>, MakeError> {
    let without = |other: &str| {
        let unjudged = || MakeError::Unjudged { effect: other.to_owned() };
        rivals.excess_with(other).ok_or_else(unjudged)
    };
    let excesses = [without(ids[1])?, without(ids[0])?];
    Ok(excesses.iter().all(|excess| *excess >= DETECTABLE).then_some(excesses))
}

/// Whether no effect of the library imitates the outsider.
fn is_outside(rivals: &Rivals, machine: &Draw) -> Result<bool, MakeError> {
    let unjudged = || MakeError::Unjudged { effect: "any".to_owned() };
    Ok(rivals.nearest_to(machine.effects[0].id()).ok_or_else(unjudged)?.excess
        >= MIN_OUTSIDER_EXCESS)
}
