//! Sizes of effects that an experiment shows.

use crate::answers::{EffectSize, SizedParameter};
use crate::effects::{Effect, MachineScales};
use crate::identify::Units;

use super::information::{FACTORS, SIZES};

/// The excess χ² from which an effect is detectable (contract, section 2).
const LEAST_EXCESS: f64 = 120.0;

/// A smaller relative difference of two values is rounding.
const ROUNDING: f64 = 1e-9;

/// The factor on the typical size from which the excess is large enough, from the excess at each of
/// [`FACTORS`]: a power law between two of them, the square of the size beyond.
pub(super) fn factor_from(excess: [f64; SIZES]) -> f64 {
    let small = excess.iter().position(|excess| *excess < LEAST_EXCESS);
    match small {
        Some(0) => FACTORS[0] * (LEAST_EXCESS / excess[0]).sqrt(),
        None => FACTORS[SIZES - 1] * (LEAST_EXCESS / excess[SIZES - 1]).sqrt(),
        Some(small) => {
            let large = small - 1;
            let exponent = (excess[large].ln() - excess[small].max(f64::MIN_POSITIVE).ln())
                / (FACTORS[large] / FACTORS[small]).ln();
            FACTORS[large] * (LEAST_EXCESS / excess[large]).powf(1.0 / exponent)
        }
    }
}

/// The effect `factor` times as large; `None` if no machine has that. `change` is the relative change of
/// the response at the typical size.
pub(super) fn size(
    effect: &dyn Effect,
    scales: &MachineScales,
    typical: &[f64],
    factor: f64,
    change: f64,
) -> Option<EffectSize> {
    let scaled = effect.descriptor().draw.scaled;
    let values = scaled(scales, typical, factor)?;
    let units = Units { input: "input".into(), velocity: "response".into() };
    let parameters = effect.parameters().iter().zip(&values).map(|(parameter, value)| {
        let unit = units.unit(parameter.dimension);
        (parameter.name.to_owned(), SizedParameter { value: *value, unit })
    });
    let near = [0.99, 1.01].into_iter().find_map(|k| scaled(scales, typical, k * factor));
    let differs = |(here, near): (&f64, f64)| (here - near).abs() > ROUNDING * here.abs();
    let set_by = near.into_iter().flat_map(|near| {
        let names = effect.parameters().iter().map(|parameter| parameter.name.to_owned());
        let pairs = names.zip(values.iter().zip(near));
        pairs.filter(|(_, pair)| differs(*pair)).map(|(name, _)| name).collect::<Vec<_>>()
    });
    Some(EffectSize {
        set_by: set_by.collect(),
        parameters: parameters.collect(),
        change: factor * change,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_excess_grows_with_the_square_of_a_size_unless_two_sizes_say_otherwise() {
        let quadratic = FACTORS.map(|factor| 1200.0 * factor * factor);
        assert!((factor_from(quadratic) - 0.1_f64.sqrt()).abs() < 1e-12);
        for (whole, factor) in [(30.0, 2.0), (120.0 * 3600.0, 1.0 / 60.0)] {
            let excess = FACTORS.map(|factor| whole * factor * factor);
            assert!((factor_from(excess) - factor).abs() < 1e-12);
        }
        // Nothing shows below the middle size, 8 times what is needed at the whole one.
        let limit = factor_from([960.0, 0.0, 0.0]);
        assert!(limit > 0.98 && limit < 1.0, "{limit}");
        // An exponent of 4 between the first two.
        let steep = factor_from([1920.0, 1920.0 * FACTORS[1].powi(4), 0.0]);
        assert!((steep - 0.5).abs() < 1e-12, "{steep}");
    }
}
