//! Marginal likelihood (evidence) of a model, by the Laplace approximation.
//!
//! −2 ln of the probability of the data under a model with priors on its parameters (Kass and
//! Raftery 1995, doi:10.1080/01621459.1995.10476572) is the misfit, plus ln det(I + S·Λ·S), minus 2
//! ln of the prior where a value lies below its likely range. S are the prior standard deviations
//! of the effects' parameters, Λ their information matrix after the base parameters are eliminated.
//! A parameter that the data do not determine costs little; a small value costs nothing if a larger
//! one fits as well.

use nalgebra::DMatrix;

use crate::effects::{Coordinate, Range};
use crate::identify::{FitSession, Linear, Model};

use crate::diagnose::residuals::subspace::Subspace;

/// Cost of one more effect, −2 ln of its prior odds against none: −2 ln(1/20) ≈ 6, as there are
/// about twenty effects, and together they are as likely as none.
const EFFECT_COST: f64 = 6.0;

/// Least cost of a parameter, −2 ln ½: one that the data do not determine is no reason to prefer
/// the model that has it, and is taken to be as likely to show as not.
const LEAST_PARAMETER_COST: f64 = 2.0 * std::f64::consts::LN_2;

/// By how much one parameter that means nothing lowers the misfit on average.
pub(crate) const CHANCE_GAIN: f64 = 1.0;

/// Prior standard deviation of the size of an effect, as a multiple of the fitted size: sizes
/// differ by orders of magnitude between machines, so that no fixed range would be fair to all.
/// Tuned.
const SIZE_DEVIATION: f64 = 2.0;

/// Number of larger values tried in place of one below its likely range, in equal ratios.
const LARGER_VALUES: usize = 4;

/// Cost of one more actuator order: that of an effect with one parameter whose deviation the data
/// reduce by a factor of e².
pub(crate) const ACTUATOR_ORDER_COST: f64 = EFFECT_COST + 4.0;

/// Parameters of the largest base model. The degrees of freedom are counted with them at every
/// order, so that misfits are comparable.
const LARGEST_BASE_PARAMETERS: usize = 6;

/// Turns the cost of a fit (its weighted sum of squares) into a misfit, −2 ln likelihood.
#[derive(Debug, Clone, Copy)]
pub(crate) struct NoiseScale {
    /// Whether costs are χ²; otherwise their logarithms count.
    pub known: bool,
    /// Sum of squares that rounding alone leaves.
    pub rounding: f64,
    /// Degrees of freedom ν: residuals less parameters of a base model.
    pub dof: f64,
}

impl NoiseScale {
    /// That of a session.
    pub fn of(session: &FitSession<'_>) -> Self {
        let dof = session.data().saturating_sub(LARGEST_BASE_PARAMETERS).max(1) as f64;
        Self { known: session.noise_known(), rounding: session.rounding(), dof }
    }

    /// −2 ln of the likelihood of a cost c, up to a constant: c where the noise is known, else
    /// ν·ln((c + rounding)/ν).
    pub fn misfit(&self, cost: f64) -> f64 {
        match self.known {
            true => cost,
            false => self.dof * ((cost + self.rounding) / self.dof).ln(),
        }
    }

    /// By how much the misfit must fall where χ² would have to fall by `gain`. If the noise is
    /// unknown its variance is taken as c/ν, with c the cost before the effect is added, and the
    /// misfit falls by ν·ln(c/(c − gain·c/ν)). A gain of ν or more would leave no cost and cannot
    /// be told from chance: the result is infinite.
    pub fn bar(&self, gain: f64) -> f64 {
        match self.known {
            true => gain,
            false if gain < self.dof => -self.dof * (-gain / self.dof).ln_1p(),
            false => f64::INFINITY,
        }
    }

    /// Whether a cost is no larger than noise makes it (4 standard deviations of χ² allowed), or
    /// than rounding makes it if the noise is unknown.
    pub fn explains(&self, cost: f64) -> bool {
        let noise = self.dof + 4.0 * (2.0 * self.dof).sqrt();
        cost <= self.rounding + if self.known { noise } else { 0.0 }
    }

    /// The part of a cost above its expectation ν under noise; all of it if the noise is unknown.
    pub fn beyond(&self, cost: f64) -> f64 {
        if self.known { (cost - self.dof).max(0.0) } else { cost }
    }

    /// Variance of the noise in units of the weights; if unknown, that estimated from a cost.
    pub fn variance(&self, cost: f64) -> f64 {
        if self.known { 1.0 } else { (cost + self.rounding) / self.dof }
    }
}

/// The penalty for a model's effects: the criterion without the misfit. It is infinite for a model
/// that cannot be linearized.
pub(crate) fn complexity(session: &FitSession<'_>, model: &Model, noise_scale: &NoiseScale) -> f64 {
    if model.effects().is_empty() {
        return 0.0;
    }
    let Some(Linear { jacobian, .. }) = session.linearise(model) else { return f64::INFINITY };
    let first = model.parameters_of(0).start;
    let base = Subspace::of(&jacobian.columns(0, first).into_owned());
    let own = base.complements(&jacobian.columns(first, model.parameters() - first).into_owned());
    let deviations = deviations(session, model);
    let scaled = DMatrix::from_fn(own.nrows(), own.ncols(), |row, i| own[(row, i)] * deviations[i]);
    let information = scaled.tr_mul(&scaled) / noise_scale.variance(model.cost);
    let volume: f64 = information
        .symmetric_eigenvalues()
        .iter()
        .map(|eigenvalue| (1.0 + eigenvalue.max(0.0)).ln().max(LEAST_PARAMETER_COST))
        .sum();
    let small =
        (0..model.effects().len()).map(|i| small_value_cost(session, model, i, noise_scale));
    volume + EFFECT_COST * model.effects().len() as f64 + small.sum::<f64>()
}

/// The cost of a parameter of the effect `i` that lies below its likely range, if it has one that
/// is rarer the smaller it is.
fn small_value_cost(
    session: &FitSession<'_>,
    model: &Model,
    i: usize,
    noise_scale: &NoiseScale,
) -> f64 {
    let effect = model.effects()[i];
    let Some(rare) = effect.search().rare_when_small else { return 0.0 };
    let parameter = model.parameters_of(i).start + rare;
    let growth = |value: f64| {
        let mut larger = model.clone();
        larger.set(parameter, value);
        Some(noise_scale.misfit(session.cost(&larger)?) - noise_scale.misfit(model.cost))
    };
    cheapest_value_cost(&session.ranges(effect)[rare], model.value(parameter), growth)
}

/// −2 ln of the prior density of a value relative to that in the likely range; or the same of a
/// larger value plus the `growth` of the misfit there, if that is less. The largest of them is the
/// lower end of the likely range.
fn cheapest_value_cost(range: &Range, value: f64, growth: impl Fn(f64) -> Option<f64>) -> f64 {
    let price = |value: f64| -2.0 * range.share_of_small(value).ln();
    if price(value) == 0.0 {
        return 0.0;
    }
    let larger = |step: usize| {
        let share = step as f64 / LARGER_VALUES as f64;
        let larger = value * (range.likely[0] / value).powf(share);
        Some(price(larger) + growth(larger)?)
    };
    (1..=LARGER_VALUES).filter_map(larger).fold(price(value), f64::min).max(0.0)
}

/// Prior standard deviations of the effects' parameters, in the coordinates of the fit.
fn deviations(session: &FitSession<'_>, model: &Model) -> Vec<f64> {
    let mut deviations = Vec::new();
    for (i, effect) in model.effects().iter().enumerate() {
        let ranges = session.ranges(*effect);
        let own = model.parameters_of(i);
        let size = model.value(own.start);
        deviations.extend(own.map(|parameter| model.prior_std(parameter)));
        let first = deviations.len() - ranges.len();
        if let (Coordinate::Linear, Some(absent)) =
            (effect.parameters()[0].coordinate, ranges[0].absent)
        {
            deviations[first] = SIZE_DEVIATION * (size - absent).abs();
        }
    }
    deviations
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::tests::{exact, noisy, request};
    use crate::machines::draw::NoiseStatement;
    use crate::observer::Silent;

    const RANGE: Range = Range { bounds: [1e-6, 1.0], likely: [1e-2, 0.1], absent: None };

    // With ten degrees of freedom, a chance gain of 8 takes up four fifths of the cost.
    #[test]
    fn with_unknown_noise_the_misfit_must_fall_by_the_logarithm_of_what_chance_leaves() {
        let noise_scale = |known: bool| NoiseScale { known, rounding: 0.0, dof: 10.0 };
        let unknown = noise_scale(false);
        let fall = unknown.misfit(3.0) - unknown.misfit(0.2 * 3.0);
        assert!((unknown.bar(8.0) - fall).abs() < 1e-12);
        assert_eq!(unknown.bar(10.0), f64::INFINITY);
        assert_eq!(noise_scale(true).bar(12.0), 12.0);
    }

    #[test]
    fn a_small_value_costs_the_less_of_its_rarity_and_the_misfit_of_a_larger_one() {
        let rarity = 2.0 * 10.0_f64.ln();
        let price =
            |value: f64, growth: fn(f64) -> Option<f64>| cheapest_value_cost(&RANGE, value, growth);
        let close = |found: f64, expected: f64| (found - expected).abs() < 1e-12;
        assert!(close(price(1e-4, |_| Some(1e3)), 2.0 * rarity));
        assert!(close(price(1e-4, |_| None), 2.0 * rarity));
        assert!(close(price(1e-4, |value| Some(if value > 2e-3 { 1e3 } else { 0.0 })), rarity));
        assert!(close(price(1e-4, |_| Some(0.5)), 0.5));
        assert_eq!(price(1e-4, |_| Some(-0.5)), 0.0);
        assert_eq!(price(0.05, |_| Some(-0.5)), 0.0);
    }

    // With a heavy load (0.1) the data determine the gap, so a tenfold smaller one costs 2 ln 10;
    // the other terms differ by 0.5 at most. A light load (1e-3) hardly shows, whatever its gap.
    #[test]
    fn a_small_gap_costs_only_where_the_data_determine_it() {
        let (measurement, request) = (noisy(&exact(), NoiseStatement::Std, 1), request());
        let session = FitSession::new(&measurement, &request, &Silent).unwrap();
        let noise_scale = NoiseScale { known: true, rounding: 0.0, dof: 100.0 };
        let play = crate::effects::find("backlash").unwrap();
        let likely = session.ranges(play)[3].likely[0];
        let cost_of = |load: f64, gap: f64| {
            let mut model = session.extend(session.base(), play);
            let own = model.parameters_of(0);
            model.set(own.start, load);
            model.set(own.end - 1, gap * likely);
            model.cost = session.cost(&model).unwrap();
            complexity(&session, &model, &noise_scale)
        };
        for (load, expected) in [(0.1, 2.0 * 10.0_f64.ln()), (1e-3, 0.0)] {
            let difference = cost_of(load, 0.01) - cost_of(load, 0.1);
            assert!((difference - expected).abs() < 0.5, "{load}: {difference}");
        }
    }
}
