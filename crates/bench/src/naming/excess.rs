//! What a base model leaves of a noise-free response, and effects of a wanted excess.

use servoscope_core::answers::{ColonyOptions, IdentifyOptions, NetworkOptions, PlantRequest};
use servoscope_core::identify::{IdentifyError, IdentifyRequest, identify};
use servoscope_core::measurement::Measurement;
use servoscope_core::observer::Silent;

use super::effect_draws::scales;
use super::sizing::Sizing;
use crate::machines::draw::{Draw, DrawError};
use crate::machines::responses::Responses;
use crate::machines::simulator::{Effect, Settings};

/// Smallest excess of what counts as detectable.
pub const DETECTABLE: f64 = 120.0;
/// Share by which an excess may miss its target.
const ACCURACY: f64 = 0.1;
/// Sizes tried before a shape is given up.
const MOST_TRIALS: usize = 14;
/// Longest change of the logarithm of a size.
const LONGEST_STEP: f64 = 3.0;
/// An excess below this is rounding.
const NOTHING: f64 = 1e-3;
/// Share of the experiments that must have a response.
const FEWEST_PERIODIC: f64 = 0.8;

/// How finely a size is searched: errors of 1e-5 of the response change an excess by
/// (1e-5/1e-3)² a datum even at 60 dB, below 0.1 in all.
pub(super) const COARSE: Settings = Settings {
    steps_per_period: 256,
    steps_per_input_line: 64,
    steps_per_time_constant: 4.0,
    tolerance: 1e-7,
    most_periods: 300,
};

/// Excess χ² of the base model with an actuator of this order: its χ² after refitting it to
/// a noise-free response that tells the deviation of its noise.
///
/// Refinement from the closed-form start is enough where there is no noise: with network and
/// colony the excess is the same, at twenty times the cost.
///
/// # Errors
/// See [`IdentifyError`].
pub fn base_excess(exact: &Measurement, order: u8) -> Result<f64, IdentifyError> {
    let options = IdentifyOptions {
        network: NetworkOptions { enabled: false, ..NetworkOptions::default() },
        colony: ColonyOptions { enabled: false, ..ColonyOptions::default() },
        ..IdentifyOptions::default()
    };
    let plant = Some(PlantRequest { actuator_order: order });
    let request = IdentifyRequest { plant, options, ..IdentifyRequest::default() };
    let chi2 = identify(exact, &request, &Silent)?.fit.chi2;
    chi2.ok_or_else(|| IdentifyError::Unusable { reason: "it tells no deviation".into() })
}

/// Excess of a drawn machine with all its effects in its own noise; `None` where it has no
/// response to most of the design, or none that can be fitted.
pub(super) fn excess_of(draw: &Draw, level_db: u32, settings: &Settings) -> Option<f64> {
    let responses = Responses::simulate(draw, settings).ok()?;
    excess_in(&responses, draw, level_db)
}

/// The same of responses that are there.
pub(super) fn excess_in(responses: &Responses, draw: &Draw, level_db: u32) -> Option<f64> {
    let exact = is_periodic(responses, draw).then(|| exact(responses, level_db))?.ok()?;
    base_excess(&exact, draw.plant.actuator.order()).ok()
}

fn is_periodic(responses: &Responses, draw: &Draw) -> bool {
    responses.experiments() as f64 >= FEWEST_PERIODIC * draw.design.len() as f64
}

/// The noise-free measurement that tells the deviation of noise of `level_db`.
pub(super) fn exact(responses: &Responses, level_db: u32) -> Result<Measurement, DrawError> {
    responses.exact(Some(responses.noise_std(f64::from(level_db))?))
}

/// The effect in the size at which the base model's excess is `target` to 10 %, and at least
/// [`DETECTABLE`]; `None` where no size of this shape has it.
pub(super) fn of_excess(
    machine: &Draw,
    effect: &Effect,
    target: f64,
    level_db: u32,
    sizing: Sizing,
) -> Option<Effect> {
    let scales = scales(machine);
    // An effect at its smallest size is asked for again and again.
    let mut last: Option<(Effect, Option<f64>)> = None;
    let factor = size_factor(target, |factor| {
        let sized = sizing.times(&scales, effect, factor)?;
        let found = match last {
            Some((same, found)) if same == sized => found,
            _ => excess_of(&Draw { effects: vec![sized], ..machine.clone() }, level_db, &COARSE),
        };
        last = Some((sized, found));
        found
    })?;
    sizing.times(&scales, effect, factor)
}

/// The factor at which `excess` is `target`: secants in the logarithms of both, kept between
/// what is known to be too small and too large. `excess` is `None` where there is none.
fn size_factor(target: f64, mut excess: impl FnMut(f64) -> Option<f64>) -> Option<f64> {
    let wanted = target.ln();
    // A small effect's excess grows with the square of its size.
    let mut slope = 2.0_f64;
    let mut at = 0.0_f64;
    let (mut low, mut high): (Option<f64>, Option<f64>) = (None, None);
    let mut last: Option<[f64; 2]> = None;
    for _ in 0..MOST_TRIALS {
        let found = excess(at.exp());
        let next = match found {
            Some(found) if (found / target - 1.0).abs() <= ACCURACY && found >= DETECTABLE => {
                return Some(at.exp());
            }
            Some(found) => {
                let value = found.max(NOTHING).ln();
                if let Some([x, y]) = last {
                    // The smallest size that can be simulated.
                    if value == y && value > wanted {
                        return None;
                    }
                    let secant = (value - y) / (at - x);
                    if secant.is_finite() && y.min(value) > NOTHING.ln() {
                        slope = secant.clamp(0.5, 6.0);
                    }
                }
                last = Some([at, value]);
                if value < wanted {
                    low = Some(at)
                } else {
                    high = Some(at)
                }
                at + ((wanted - value) / slope).clamp(-LONGEST_STEP, LONGEST_STEP)
            }
            None => {
                high = Some(at);
                at - 1.0
            }
        };
        at = match (low, high) {
            (Some(low), Some(high)) => {
                // Where one end tells nothing of the slope, halving is the quickest.
                let margin = 0.2 * (high - low);
                if found.is_some_and(|found| found > NOTHING) {
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
                let factor = size_factor(target, law).unwrap_or_else(|| panic!("{name}: {target}"));
                let found = law(factor).unwrap();
                assert!((found / target - 1.0).abs() <= ACCURACY, "{name}: {found} for {target}");
            }
        }
    }

    #[test]
    fn an_excess_that_no_size_has_is_given_up() {
        assert_eq!(size_factor(1e4, |size| (size < 2.0).then_some(40.0 * size * size)), None);
        assert_eq!(size_factor(1e4, |_| None), None);
        // Of 125 to 110 it would do, were it not below what is detectable.
        assert!(size_factor(121.0, |size| Some(118.0 * size)).is_some_and(|size| size > 1.0));
    }
}
