//! Excess χ² of the base model, and scaling of an effect to a given excess.

use servoscope_core::answers::{ColonyOptions, IdentifyOptions, NetworkOptions, PlantRequest};
use servoscope_core::identify::{IdentifyError, IdentifyRequest, identify};
use servoscope_core::measurement::Measurement;
use servoscope_core::observer::Silent;

use super::effect_draws::scales;
use super::instrument::Instrument;
use super::sizing::Sizing;
use crate::machines::draw::{Draw, DrawError};
use crate::machines::responses::Responses;
use crate::machines::simulator::{Effect, Settings};

/// Smallest excess χ² of a detectable effect (contract, section 2).
pub const DETECTABLE: f64 = 120.0;
/// Largest relative deviation of an excess from its target.
const TARGET_TOLERANCE: f64 = 0.1;
/// Most sizes tried for one drawn effect.
const MOST_TRIALS: usize = 14;
/// Largest change of the logarithm of the size in one step.
const LARGEST_LOG_STEP: f64 = 3.0;
/// An excess below this is due to rounding errors.
const NEGLIGIBLE_EXCESS: f64 = 1e-3;
/// Smallest share of the experiments that must have a periodic response.
const MIN_PERIODIC_SHARE: f64 = 0.8;

/// Simulator settings for the search for a size. Errors of 1e-5 of the response change the excess
/// by (1e-5/1e-3)² per datum even at 60 dB, and by less than 0.1 in all. Where a floor lies 80 dB
/// down it is 0.01 for each harmonic that is small enough to have no other noise; what counts is
/// the excess with the default settings, of the effect that was found.
pub(super) const COARSE: Settings = Settings {
    steps_per_period: 256,
    steps_per_input_line: 64,
    steps_per_time_constant: 4.0,
    tolerance: 1e-7,
    most_periods: 300,
};

/// Excess χ² of the base model with an actuator of this order: its χ² after refitting it to a
/// noise-free response, weighted with the standard deviations that the measurement states.
///
/// Without noise, refinement from the closed-form start is enough: network and colony give the same
/// excess at twenty times the cost.
///
/// # Errors
/// See [`IdentifyError`].
pub fn base_excess(exact: &Measurement, order: u8) -> Result<f64, IdentifyError> {
    let plant = Some(PlantRequest { actuator_order: order });
    let request = IdentifyRequest { plant, options: quick(), ..IdentifyRequest::default() };
    let chi2 = identify(exact, &request, &Silent)?.fit.chi2;
    chi2.ok_or_else(|| IdentifyError::Unusable { reason: "it tells no deviation".into() })
}

/// Options of a fit without network and colony.
pub(super) fn quick() -> IdentifyOptions {
    IdentifyOptions {
        network: NetworkOptions { enabled: false, ..NetworkOptions::default() },
        colony: ColonyOptions { enabled: false, ..ColonyOptions::default() },
        ..IdentifyOptions::default()
    }
}

/// Excess of a drawn machine with all its effects, measured with this instrument; `None` if too few
/// experiments have a response, or the responses cannot be fitted.
pub(super) fn excess_of(draw: &Draw, instrument: &Instrument, settings: &Settings) -> Option<f64> {
    let responses = instrument.responses(draw, settings).ok()?;
    excess_in(&responses, draw, instrument)
}

/// As [`excess_of`], from responses that are already simulated.
pub(super) fn excess_in(
    responses: &Responses,
    draw: &Draw,
    instrument: &Instrument,
) -> Option<f64> {
    let exact = is_periodic(responses, draw).then(|| exact(responses, instrument))?.ok()?;
    base_excess(&exact, draw.plant.actuator.order()).ok()
}

fn is_periodic(responses: &Responses, draw: &Draw) -> bool {
    responses.experiments() as f64 >= MIN_PERIODIC_SHARE * draw.design.len() as f64
}

/// The noise-free measurement, which states the standard deviation of the instrument's noise in
/// every harmonic.
pub(super) fn exact(
    responses: &Responses,
    instrument: &Instrument,
) -> Result<Measurement, DrawError> {
    responses.stating(&instrument.law(responses)?)
}

/// The effect, scaled so that the base model's excess is the target within 10 % and not below the
/// least (the first); `None` if no size gives that excess.
pub(super) fn scaled_to_excess(
    machine: &Draw,
    effect: &Effect,
    [least, target]: [f64; 2],
    instrument: &Instrument,
    sizing: Sizing,
) -> Option<Effect> {
    let scales = scales(machine);
    // An effect at its smallest size is requested repeatedly, so the last result is kept.
    let mut last: Option<(Effect, Option<f64>)> = None;
    let factor = size_factor([least, target], |factor| {
        let sized = sizing.times(&scales, effect, factor)?;
        let found = match last {
            Some((same, found)) if same == sized => found,
            _ => excess_of(&Draw { effects: vec![sized], ..machine.clone() }, instrument, &COARSE),
        };
        last = Some((sized, found));
        found
    })?;
    sizing.times(&scales, effect, factor)
}

/// The factor at which `excess` is the target and not below the least (the first), by the secant method in the logarithms of both, with
/// bracketing. `excess` returns `None` for sizes that are too large to have one.
fn size_factor(
    [least, target]: [f64; 2],
    mut excess: impl FnMut(f64) -> Option<f64>,
) -> Option<f64> {
    let wanted = target.ln();
    // A small effect's excess grows with the square of its size.
    let mut slope = 2.0_f64;
    let mut at = 0.0_f64;
    let (mut low, mut high): (Option<f64>, Option<f64>) = (None, None);
    let mut last: Option<[f64; 2]> = None;
    for _ in 0..MOST_TRIALS {
        let found = excess(at.exp());
        let next = match found {
            Some(found) if (found / target - 1.0).abs() <= TARGET_TOLERANCE && found >= least => {
                return Some(at.exp());
            }
            Some(found) => {
                let value = found.max(NEGLIGIBLE_EXCESS).ln();
                if let Some([x, y]) = last {
                    // The excess no longer changes: this is the smallest size that can be
                    // simulated.
                    if value == y && value > wanted {
                        return None;
                    }
                    let secant = (value - y) / (at - x);
                    if secant.is_finite() && y.min(value) > NEGLIGIBLE_EXCESS.ln() {
                        slope = secant.clamp(0.5, 6.0);
                    }
                }
                last = Some([at, value]);
                if value < wanted {
                    low = Some(at)
                } else {
                    high = Some(at)
                }
                at + ((wanted - value) / slope).clamp(-LARGEST_LOG_STEP, LARGEST_LOG_STEP)
            }
            None => {
                high = Some(at);
                at - 1.0
            }
        };
        at = match (low, high) {
            (Some(low), Some(high)) => {
                // Without a usable slope, bisect.
                let margin = 0.2 * (high - low);
                if found.is_some_and(|found| found > NEGLIGIBLE_EXCESS) {
                    next.clamp(low + margin, high - margin)
                } else {
                    0.5 * (low + high)
                }
            }
            _ => next,
        };
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    type Law = fn(f64) -> Option<f64>;

    #[test]
    fn a_size_is_found_where_the_excess_grows_as_it_may() {
        let laws: [(&str, Law); 4] = [
            ("a square", |size| Some(5.0 * size * size)),
            ("one that levels off", |size| Some(1e5 * size / (1.0 + size))),
            ("one with a threshold", |size| Some(1e3 * (size - 3.0).max(0.0))),
            ("one with an end", |size| (size < 9.0).then_some(40.0 * size * size)),
        ];
        for (name, law) in laws {
            for target in [130.0, 1_000.0, 3_000.0] {
                let factor = size_factor([DETECTABLE, target], law);
                let factor = factor.unwrap_or_else(|| panic!("{name}: {target}"));
                let found = law(factor).unwrap();
                assert!(
                    (found / target - 1.0).abs() <= TARGET_TOLERANCE,
                    "{name}: {found} for {target}"
                );
            }
        }
    }

    #[test]
    fn an_excess_that_no_size_has_is_given_up() {
        assert_eq!(
            size_factor([DETECTABLE, 1e4], |size| (size < 2.0).then_some(40.0 * size * size)),
            None
        );
        assert_eq!(size_factor([DETECTABLE, 1e4], |_| None), None);
        // 118 is within 10 % of the target, but below the least.
        assert!(
            size_factor([DETECTABLE, 121.0], |size| Some(118.0 * size))
                .is_some_and(|size| size > 1.0)
        );
    }
}
