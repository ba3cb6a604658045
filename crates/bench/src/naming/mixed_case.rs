//! Accepts the machine of a draw with small effects beside dominant ones, as a table or recorded.

use rand_chacha::ChaCha8Rng;

use super::build_case::{Hidden, Made, truth};
use super::case::Case;
use super::dominance::Dominance;
use super::effect_draws::two;
use super::excess::{COARSE, excess_of};
use super::instrument::Instrument;
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

/// The draw of a machine with one effect or none that is recorded, at the first attempt, with the
/// noise with which an effect has this excess; `None` if it cannot be recorded.
pub(super) fn recorded(
    machine: &Draw,
    instrument: Instrument,
    recording: Recording,
    excess: f64,
    rng: &mut ChaCha8Rng,
) -> Option<Made> {
    let count = machine.effects.len();
    let wanted = if count == 0 { Wanted::Sound } else { Wanted::Excess(excess) };
    let Recorded { measurement, dominance, std, level_db } =
        recording.record(machine, count, wanted, rng)?;
    let excess = if count == 0 { 0.0 } else { dominance.base };
    Some(Made {
        hidden: machine.effects.iter().map(|effect| Hidden::of(effect, excess)).collect(),
        excess,
        dominance: None,
        plant: truth(&machine.plant),
        machine: machine.clone(),
        instrument: Instrument { noise: RelativeNoise::decibels(level_db), ..instrument },
        noise: NoiseLaw::uniform(std),
        measurement,
        mistake: None,
        attempts: 1,
    })
}

/// The draw of a machine with small effects that is recorded, at the first attempt; `None` unless it
/// is as wanted.
pub(super) fn recorded_mixed(
    case: &Case,
    machine: &Draw,
    instrument: Instrument,
    recording: Recording,
    chi2_per_dof: f64,
    rng: &mut ChaCha8Rng,
) -> Option<Made> {
    let Recorded { measurement, dominance, std, level_db } =
        recording.record(machine, case.kind.dominant(), Wanted::Left(chi2_per_dof), rng)?;
    dominance.is_wanted().then_some(())?;
    Some(Made {
        hidden: hidden_alone(case, machine, &instrument)?,
        excess: dominance.base,
        dominance: Some(dominance),
        plant: truth(&machine.plant),
        machine: machine.clone(),
        instrument: Instrument { noise: RelativeNoise::decibels(level_db), ..instrument },
        noise: NoiseLaw::uniform(std),
        measurement,
        mistake: None,
        attempts: 1,
    })
}
