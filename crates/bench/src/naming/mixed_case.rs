//! Accepts the machine of a draw that has small effects beside dominant ones, or that is recorded.

use rand_chacha::ChaCha8Rng;

use super::build_case::{Hidden, Made, truth};
use super::case::Case;
use super::dominance::Dominance;
use super::effect_draws::two;
use super::excess::{COARSE, excess_of};
use super::instrument::Instrument;
use super::mismeasurement::Sort;
use super::mixture::dominance;
use super::recording::{Recorded, Recording, Wanted};
use crate::machines::draw::Draw;
use crate::machines::noise::{NoiseLaw, RelativeNoise};
use crate::machines::simulator::{Effect, Settings};

/// Ids of the dominant effects of a machine; `None` if two were drawn that exclude each other.
pub(super) fn dominant(case: &Case, rng: &mut ChaCha8Rng) -> Option<Vec<&'static str>> {
    case.effect.map_or_else(|| two(rng), |id| Some(vec![id]))
}

/// The dominance and the effects of a machine with small ones; `None` unless it is as wanted.
pub(super) fn mixed(
    case: &Case,
    machine: &Draw,
    instrument: &Instrument,
) -> Option<(Dominance, Vec<Hidden>)> {
    let found = dominance(machine, case.kind.dominant(), instrument, &Settings::default())?;
    let hidden = hidden_alone(case, machine, instrument)?;
    found.is_wanted().then_some((found, hidden))
}

/// The effects of a machine, each with its excess where it is alone in a table.
fn hidden_alone(case: &Case, machine: &Draw, instrument: &Instrument) -> Option<Vec<Hidden>> {
    let hidden = |(place, effect): (usize, &Effect)| {
        let alone = Draw { effects: vec![*effect], ..machine.clone() };
        let excess = excess_of(&alone, instrument, &COARSE)?;
        Some(Hidden { small: place >= case.kind.dominant(), ..Hidden::of(effect, excess) })
    };
    machine.effects.iter().enumerate().map(hidden).collect()
}

/// The draw of a machine that is recorded, at the first attempt. Its noise is that with which its
/// dominant effects leave `target` of χ² per degree of freedom or, without small effects, its only
/// effect has that excess. `None` unless it is as wanted.
pub(super) fn recorded(
    case: &Case,
    machine: &Draw,
    instrument: Instrument,
    recording: Recording,
    target: f64,
    rng: &mut ChaCha8Rng,
) -> Option<Made> {
    let (dominant, wanted) = match (case.kind.dominant(), machine.effects.len()) {
        (0, 0) => (0, Wanted::Sound),
        (0, all) => (all, Wanted::Excess(target)),
        (dominant, _) => (dominant, Wanted::Left(target)),
    };
    let samples_change = Sort::of(case).is_some_and(Sort::is_of_samples);
    let Recorded { records, measurement, dominance, std, level_db } =
        recording.record(machine, dominant, wanted, samples_change, rng)?;
    let excess = if machine.effects.is_empty() { 0.0 } else { dominance.base };
    let (hidden, dominance) = if case.kind.dominant() == 0 {
        (machine.effects.iter().map(|effect| Hidden::of(effect, excess)).collect(), None)
    } else {
        dominance.is_wanted().then_some(())?;
        (hidden_alone(case, machine, &instrument)?, Some(dominance))
    };
    Some(Made {
        hidden,
        excess,
        dominance,
        plant: truth(&machine.plant),
        machine: machine.clone(),
        instrument: Instrument { noise: RelativeNoise::decibels(level_db), ..instrument },
        noise: NoiseLaw::uniform(std),
        measurement,
        records,
        mistake: None,
        attempts: 1,
    })
}
