//! Makes a draw: its machine, the effects hidden in it, and its measurement.

mod acceptance;
mod made;

use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use servoscope_core::observer::Observer;

use super::case::{Case, Kind};
use super::effect_draws::{draw_effect, two};
use super::excess::{DETECTABLE, exact, excess_in, scaled_to_excess};
use super::instrument::Instrument;
use super::mismeasurement::{Mistake, Sort};
use super::mixed_case::{dominant, mixed, recorded};
use super::mixture::{CHI2_PER_DOF, Mixing};
use super::outsiders;
use super::sizing::Sizing;
use crate::machines::draw::{Draw, DrawError, draw, log_uniform};
use crate::machines::simulator::{Effect, Settings};
use acceptance::accepted;
pub(super) use made::truth;
pub use made::{Hidden, Made, MakeError};

/// Most machines and effects tried for a draw.
const MOST_ATTEMPTS: usize = 24;
/// Number of attempts with the excess that was drawn first; later attempts draw a new one. Several
/// attempts keep an excess that is hard to reach from becoming rare. A new excess is needed because
/// some cannot be reached at all (e.g. with a bristle softer than can be simulated).
const ATTEMPTS_WITH_FIRST_TARGET: usize = 6;
/// Excess χ² from which an effect has to be named.
const MUST_BE_NAMED: f64 = 300.0;
/// Smallest and largest excess χ² of an effect in an analyser's table.
const ANALYSER_EXCESS: [f64; 2] = [MUST_BE_NAMED, 30_000.0];

/// Makes a draw. `base_seed` and the key of the case determine all random numbers. `sizing` says
/// how hidden effects are scaled to their excess. The observer can cancel before every attempt.
///
/// # Errors
/// See [`MakeError`].
pub fn build_case(
    case: &Case,
    base_seed: u64,
    sizing: Sizing,
    observer: &dyn Observer,
) -> Result<Made, MakeError> {
    let rng = &mut case.rng(base_seed);
    let [least, most] = target_range(case);
    let targets = |rng: &mut ChaCha8Rng| [(); 2].map(|()| log_uniform(least, most, rng));
    let mut wanted = targets(rng);
    let mut instrument = Instrument::of(case, rng);
    for attempt in 1..=MOST_ATTEMPTS {
        if observer.cancelled() {
            return Err(MakeError::Cancelled);
        }
        if attempt > ATTEMPTS_WITH_FIRST_TARGET {
            wanted = targets(rng);
            instrument = Instrument::of(case, rng);
        }
        let mut machine = instrument.at(draw(case.order, rng.random()));
        let sized = |effect: Effect, target: f64| {
            scaled_to_excess(&machine, &effect, [least, target], &instrument, sizing)
        };
        let hidden = match case.kind.dominant() {
            1.. => {
                let (machine, instrument) = (&machine, &instrument);
                let mixing = Mixing { machine, instrument, sized, chi2_per_dof: wanted[0] };
                dominant(case, rng).and_then(|ids| mixing.draw(&ids, rng))
            }
            0 => effects(case, &machine, sized, wanted, attempt, rng),
        };
        let Some(effects) = hidden else { continue };
        machine.effects = effects;
        if let Some(recording) = instrument.recording {
            let made = recorded(case, &machine, instrument, recording, wanted[0], rng);
            let Some(made) = made else { continue };
            return mismade(case, Made { attempts: attempt, ..made }, rng);
        }
        let responses = instrument.responses(&machine, &Settings::default())?;
        let excess = if machine.effects.is_empty() {
            0.0
        } else {
            match excess_in(&responses, &machine, &instrument) {
                Some(excess) if excess >= least => excess,
                _ => continue,
            }
        };
        let exact = || exact(&responses, &instrument);
        let (dominance, hidden) = match case.kind.dominant() {
            1.. => mixed(case, &machine, &instrument).unzip(),
            0 => (None, accepted(case, &machine, exact, excess)?),
        };
        let Some(hidden) = hidden else { continue };
        let noise = instrument.law(&responses)?;
        let sound = responses.noisy(&instrument.noise, instrument.said.statement(), rng)?;
        let made = Made {
            hidden,
            excess,
            dominance,
            plant: truth(&machine.plant),
            instrument,
            noise,
            machine,
            measurement: sound,
            records: Vec::new(),
            mistake: None,
            attempts: attempt,
        };
        return mismade(case, made, rng);
    }
    Err(MakeError::Unreachable)
}

/// The draw with the fault of its measurement, if it shall have one.
fn mismade(case: &Case, sound: Made, rng: &mut ChaCha8Rng) -> Result<Made, MakeError> {
    let Some(sort) = Sort::of(case) else { return Ok(sound) };
    let (mistake, measurement) = match sound.instrument.recording {
        Some(recording) if sort.is_of_samples() => {
            Mistake::in_samples(sort, &sound, recording, rng).ok_or(MakeError::Unreachable)?
        }
        recording => {
            // Of records no rows are made wrong.
            let exact = match recording {
                None => sound.exact()?,
                Some(_) => sound.measurement.clone(),
            };
            Mistake::make(sort, sound.measurement, &exact, &sound.noise, rng)
                .map_err(DrawError::from)?
        }
    };
    Ok(Made { mistake: Some(mistake), measurement, ..sound })
}

/// Smallest and largest target of a draw: of its excess, in a machine with small effects of the χ²
/// per degree of freedom that the dominant ones leave.
fn target_range(case: &Case) -> [f64; 2] {
    match case.kind {
        Kind::Analyser | Kind::AnalyserRecord => ANALYSER_EXCESS,
        Kind::Mismeasured | Kind::MismeasuredRecord => [MUST_BE_NAMED, most_excess(case.level_db)],
        _ if case.kind.dominant() > 0 => CHI2_PER_DOF,
        _ => [DETECTABLE, most_excess(case.level_db)],
    }
}

/// Largest target excess at a noise level.
fn most_excess(level_db: u32) -> f64 {
    match level_db {
        60.. => 120_000.0,
        50..60 => 36_000.0,
        _ => 12_000.0,
    }
}

/// Draws the effects hidden in a machine and scales them to their targets with `sized`; `None` if
/// no size reaches a target, or the two effects of a pair cannot be distinguished.
fn effects(
    case: &Case,
    machine: &Draw,
    sized: impl Fn(Effect, f64) -> Option<Effect>,
    targets: [f64; 2],
    attempt: usize,
    rng: &mut ChaCha8Rng,
) -> Option<Vec<Effect>> {
    match case.kind {
        Kind::Single
        | Kind::Analyser
        | Kind::AnalyserRecord
        | Kind::Mismeasured
        | Kind::MismeasuredRecord => match case.effect {
            Some(id) => Some(vec![sized(draw_effect(id, machine, rng), targets[0])?]),
            None => Some(Vec::new()),
        },
        Kind::Pair => {
            let ids = two(rng)?;
            let shapes = [draw_effect(ids[0], machine, rng), draw_effect(ids[1], machine, rng)];
            Some(vec![sized(shapes[0], targets[0])?, sized(shapes[1], targets[1])?])
        }
        Kind::Outsider => {
            // All outsiders in turn; a new attempt takes the next one.
            let ids = outsiders::ids();
            let id = ids[(case.index as usize + attempt - 1) % ids.len()];
            Some(vec![sized(outsiders::draw_outsider(id, machine, rng), targets[0])?])
        }
        // The effects of a machine with small ones are mixed, not drawn here.
        _ => Some(Vec::new()),
    }
}

#[cfg(test)]
mod tests {
    use servoscope_core::observer::Silent;

    use super::super::instrument::NoiseSaid;
    use super::*;
    use crate::naming::base_excess;

    fn made(key: &str) -> Made {
        let case: Case = key.parse().unwrap();
        build_case(&case, 1, Sizing::Amount, &Silent).unwrap()
    }

    // The excess is asked for to 10 %, at coarse steps; at full ones it may differ a little more.
    #[test]
    fn an_effect_in_an_analysers_table_shows_as_much_as_was_drawn_by_its_own_noise() {
        let made = made("analyser-70-gain_asymmetry-o0-1");
        let [least, most] = ANALYSER_EXCESS;
        assert!(made.excess >= least && made.excess <= 1.15 * most, "{}", made.excess);
        assert!(made.hides("gain_asymmetry") && made.noise.share >= 0.001);
        let responses = made.instrument.responses(&made.machine, &Settings::default()).unwrap();
        let exact = responses.stating(&made.noise).unwrap();
        assert_eq!(base_excess(&exact, 0), Ok(made.excess));
    }

    #[test]
    fn a_fault_lies_in_the_measurement_and_not_in_the_machine() {
        // Index 9 is a wrong sign, and has repeats.
        let Made { mistake, measurement, excess, .. } = made("mismeasured-60-gain_asymmetry-o0-9");
        assert!(excess >= MUST_BE_NAMED && excess <= 1.15 * most_excess(60), "{excess}");
        let Mistake { sort, shows, sound, .. } = mistake.unwrap();
        assert!(shows && sort == Sort::ReversedSign);
        for (sound, faulty) in sound.experiments().iter().zip(measurement.experiments()) {
            assert_eq!(faulty.repeats.len(), 6);
            for (right, wrong) in sound.response.iter().zip(&faulty.response) {
                assert_eq!(wrong.value, -right.value);
            }
        }
        assert_eq!(made("clean-60-o0-0").mistake, None);
    }

    #[test]
    fn a_machine_has_a_dominant_effect_and_small_ones_that_leave_what_they_may() {
        let Made { hidden, dominance, excess, machine, measurement, .. } =
            made("machine-60-quadratic_drag-o0-0");
        assert_eq!((hidden[0].effect, hidden[0].small), ("quadratic_drag", false));
        let small = &hidden[1..];
        assert!(small.iter().all(|one| one.small) && (3..=6).contains(&small.len()));
        assert_eq!(machine.effects.len(), hidden.len());
        let dominance = dominance.unwrap();
        assert!((1.5..=30.0).contains(&dominance.chi2_per_dof) && dominance.share() >= 0.9);
        assert!(small.iter().all(|one| one.excess < 0.5 * hidden[0].excess), "{hidden:?}");
        // Both are the excess of the whole machine, fitted twice.
        assert!((dominance.base / excess - 1.0).abs() < 1e-6, "{excess} {dominance:?}");
        assert_eq!(measurement.experiments().len(), 48);
    }

    #[test]
    fn an_analysers_table_has_the_points_harmonics_and_statement_of_its_instrument() {
        for index in 0..6 {
            let Made { instrument, measurement, hidden, excess, machine, .. } =
                made(&format!("analyser-70-o0-{index}"));
            assert!(hidden.is_empty() && excess == 0.0);
            let [magnitudes, frequencies] = instrument.points.unwrap();
            assert_eq!(measurement.experiments().len(), magnitudes * frequencies);
            for experiment in measurement.experiments() {
                assert_eq!(experiment.highest_harmonic(), machine.harmonics);
                assert_eq!(experiment.std_given(), instrument.said == NoiseSaid::Coherence);
                let repeats = match instrument.said {
                    NoiseSaid::Repeats(count) => count,
                    _ => 0,
                };
                assert_eq!(experiment.repeats.len(), repeats);
            }
        }
    }
}
