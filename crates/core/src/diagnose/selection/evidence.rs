//! The marginal likelihood (evidence) of a model, by Laplace's approximation.
//!
//! −2 ln of the probability of the data under a model whose parameters are uncertain within their
//! likely ranges (Kass and Raftery 1995, doi:10.1080/01621459.1995.10476572): the misfit, plus
//! ln det(I + S·Λ·S) with S the prior deviations of the effects' parameters and Λ what the data says
//! of them once the base parameters are fitted too, less 2 ln of the prior where a value lies below
//! its likely range. A parameter that the data does not determine costs little; that its value is
//! small costs nothing where a larger one fits as well.

use nalgebra::DMatrix;

use crate::effects::{Coordinate, Range};
use crate::identify::{FitSession, Linear, Model};

use crate::diagnose::residuals::subspace::Subspace;

/// −2 ln of the prior odds of one more effect against none: each of some twenty
/// is as likely as all together are not.
const RARITY: f64 = 6.0;

/// Least that a parameter costs: one that the data does not determine is no reason to
/// prefer the model that has it. That it does not show is taken to be as likely as that it
/// does: −2 ln ½.
const LEAST: f64 = 2.0 * std::f64::consts::LN_2;

/// Deviation of how much there is of an effect, in units of what was found: machines differ in
/// that by orders of magnitude, so that no range would be fair to a large and to a small one.
const SIZE: f64 = 2.0;

/// What one more order of the actuator costs: as an effect of one parameter that the data
/// narrows down by a factor of e².
pub(crate) const ORDER: f64 = RARITY + 4.0;

/// How large a misfit is.
#[derive(Debug, Clone, Copy)]
pub(crate) struct NoiseScale {
    /// Whether costs are χ²; otherwise their logarithms count.
    pub known: bool,
    /// Sum of squares that rounding leaves.
    pub rounding: f64,
    /// Residuals less parameters of a base model.
    pub dof: f64,
}

impl NoiseScale {
    /// −2 ln of the likelihood of a cost, up to a constant.
    pub fn misfit(&self, cost: f64) -> f64 {
        match self.known {
            true => cost,
            false => self.dof * ((cost + self.rounding) / self.dof).ln(),
        }
    }

    /// What a misfit must fall by where χ² must fall by `gain`. Where the noise is unknown, gains
    /// are counted as if it were as large as what is left before them makes it: of a cost c with
    /// ν degrees of freedom chance takes up the share gain/ν at most, and ν·ln(c/(c − gain·c/ν))
    /// of the misfit; what is as large as everything that is left cannot be told from chance.
    pub fn bar(&self, gain: f64) -> f64 {
        match self.known {
            true => gain,
            false if gain < self.dof => -self.dof * (-gain / self.dof).ln_1p(),
            false => f64::INFINITY,
        }
    }

    /// Whether a cost is no larger than noise makes it, 4 standard deviations of χ²
    /// allowed, or rounding where the noise is unknown.
    pub fn explains(&self, cost: f64) -> bool {
        let noise = self.dof + 4.0 * (2.0 * self.dof).sqrt();
        cost <= self.rounding + if self.known { noise } else { 0.0 }
    }

    /// What a cost is beyond that of noise, where it is known.
    pub fn beyond(&self, cost: f64) -> f64 {
        if self.known { (cost - self.dof).max(0.0) } else { cost }
    }

    /// Variance of the noise in units of the weights, after a model of this cost.
    pub fn variance(&self, cost: f64) -> f64 {
        if self.known { 1.0 } else { (cost + self.rounding) / self.dof }
    }
}

/// What parameters cost, given what the data says of them.
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
        .map(|eigenvalue| (1.0 + eigenvalue.max(0.0)).ln().max(LEAST))
        .sum();
    let small = (0..model.effects().len()).map(|i| smallness(session, model, i, noise_scale));
    volume + RARITY * model.effects().len() as f64 + small.sum::<f64>()
}

/// What it costs that a parameter of this effect is smaller than is likely.
fn smallness(session: &FitSession<'_>, model: &Model, i: usize, noise_scale: &NoiseScale) -> f64 {
    let effect = model.effects()[i];
    let Some(rare) = effect.rarer_where_small() else { return 0.0 };
    let parameter = model.parameters_of(i).start + rare;
    let growth = |value: f64| {
        let mut larger = model.clone();
        larger.set(parameter, value);
        Some(noise_scale.misfit(session.cost(&larger)?) - noise_scale.misfit(model.cost))
    };
    let tried = session.search().larger_values;
    least_price(&session.ranges(effect)[rare], model.value(parameter), tried, growth)
}

/// −2 ln of the prior of a value, as a share of that within the likely range, or what a larger
/// one costs, by which the misfit grows so much, if that is less; so many larger ones are tried.
fn least_price(
    range: &Range,
    value: f64,
    tried: usize,
    growth: impl Fn(f64) -> Option<f64>,
) -> f64 {
    let price = |value: f64| -2.0 * range.share_of_small(value).ln();
    if price(value) == 0.0 {
        return 0.0;
    }
    let larger = |step: usize| {
        let share = step as f64 / tried as f64;
        let larger = value * (range.likely[0] / value).powf(share);
        Some(price(larger) + growth(larger)?)
    };
    (1..=tried).filter_map(larger).fold(price(value), f64::min).max(0.0)
}

/// Standard deviations of the effects' parameters before the data is seen, in coordinates.
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
            deviations[first] = SIZE * (size - absent).abs();
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

    // Chance that takes up four fifths of ten degrees of freedom leaves a fifth of the cost.
    #[test]
    fn of_unknown_noise_a_misfit_must_fall_by_what_chance_leaves_of_all_that_there_is() {
        let noise_scale = |known: bool| NoiseScale { known, rounding: 0.0, dof: 10.0 };
        let unknown = noise_scale(false);
        let fall = unknown.misfit(3.0) - unknown.misfit(0.2 * 3.0);
        assert!((unknown.bar(8.0) - fall).abs() < 1e-12);
        assert_eq!(unknown.bar(10.0), f64::INFINITY);
        assert_eq!(noise_scale(true).bar(12.0), 12.0);
    }

    #[test]
    fn what_must_be_small_costs_its_rarity_and_what_may_be_likely_what_the_misfit_grows_by() {
        let rarity = 2.0 * 10.0_f64.ln();
        let price =
            |value: f64, growth: fn(f64) -> Option<f64>| least_price(&RANGE, value, 4, growth);
        let close = |found: f64, expected: f64| (found - expected).abs() < 1e-12;
        assert!(close(price(1e-4, |_| Some(1e3)), 2.0 * rarity));
        assert!(close(price(1e-4, |_| None), 2.0 * rarity));
        assert!(close(price(1e-4, |value| Some(if value > 2e-3 { 1e3 } else { 0.0 })), rarity));
        assert!(close(price(1e-4, |_| Some(0.5)), 0.5));
        assert_eq!(price(1e-4, |_| Some(-0.5)), 0.0);
        assert_eq!(price(0.05, |_| Some(-0.5)), 0.0);
    }

    // What the data says of a heavy joint with either gap differs by half a unit at most; a light
    // one hardly shows.
    #[test]
    fn that_a_play_is_small_costs_only_where_the_data_says_so() {
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
