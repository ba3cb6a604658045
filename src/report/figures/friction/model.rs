//! Friction as an identified model has it, and how sure it is.

use servoscope_core::answers::{Identification, ParameterEstimate};

/// Velocities at which the torque is drawn, each side.
const STEPS: usize = 40;

/// One direction of motion.
pub(super) struct Side {
    /// 1: positive velocity; −1: negative.
    pub sign: f64,
    pub level: f64,
    pub level_std: Option<f64>,
    pub static_level: Option<f64>,
    pub name: &'static str,
    pub key: &'static str,
    bend: Bend,
}

/// What effects of a model make of friction in one direction.
struct Bend {
    /// Viscous friction as a share of that of both directions.
    viscous: f64,
    /// By what share friction at rest exceeds the level, and the velocity at which an e-th
    /// part of that is left.
    excess: f64,
    stribeck_velocity: f64,
    /// Torque per velocity squared.
    drag: f64,
}

impl Bend {
    fn of(answer: &Identification, sign: f64) -> Self {
        let value = |name: &str| answer.parameters.get(name).and_then(|estimate| estimate.value);
        Self {
            viscous: 1.0 + sign * value("viscous_asymmetry.alpha").unwrap_or(0.0),
            excess: value("stribeck.fs_over_fc").map_or(0.0, |ratio| ratio - 1.0),
            stribeck_velocity: value("stribeck.stribeck_velocity").unwrap_or(1.0),
            drag: value("quadratic_drag.c").unwrap_or(0.0),
        }
    }
}

impl Side {
    /// What its static level is called.
    pub fn static_name(&self) -> &'static str {
        if self.sign > 0.0 { "Fs⁺" } else { "Fs⁻" }
    }

    /// Size of the torque at this size of the velocity; `slope` is a/K.
    pub fn torque(&self, slope: f64, v: f64) -> f64 {
        let Bend { viscous, excess, stribeck_velocity, drag } = self.bend;
        let stribeck = excess * (-(v / stribeck_velocity).powi(2)).exp();
        self.level * (1.0 + stribeck) + slope * viscous * v + drag * v * v
    }

    /// How fast its viscous friction grows with the speed; `slope` is a/K, that of both directions.
    pub fn slope(&self, slope: f64) -> f64 {
        slope * self.bend.viscous
    }

    /// The same as it is written: `a/K` times what an asymmetry makes of it.
    pub fn slope_name(&self) -> &'static str {
        match (self.bend.viscous == 1.0, self.sign > 0.0) {
            (true, _) => "a/K",
            (false, true) => "(1 + α)·a/K",
            (false, false) => "(1 − α)·a/K",
        }
    }

    /// Points of the torque up to a velocity.
    pub fn curve(&self, slope: f64, reach: f64) -> impl Iterator<Item = [f64; 2]> {
        let at = move |i: usize| reach * i as f64 / STEPS as f64;
        (0..=STEPS).map(move |i| [self.sign * at(i), self.sign * self.torque(slope, at(i))])
    }
}

/// Viscous friction a/K, input per velocity.
pub(super) struct Viscous {
    pub slope: f64,
    pub std: Option<f64>,
}

/// A standard deviation to go by.
fn std(estimate: &ParameterEstimate) -> Option<f64> {
    estimate.std.filter(|std| std.is_finite())
}

/// The viscous friction of an answer, where the data determines it.
pub(super) fn viscous(answer: &Identification) -> Option<Viscous> {
    let [pole, constant] = ["pole", "constant"].map(|name| answer.parameters.get(name));
    let (pole, constant) = (pole?, constant?);
    let slope = -pole.value? / constant.value?;
    let gradient = gradient(answer, None);
    let std = std(pole).and(std(constant)).and_then(|_| deviation(answer, &gradient?));
    slope.is_finite().then_some(Viscous { slope, std })
}

/// Derivatives of a/K by the parameters, or with a level: of the torque at
/// velocity v in its direction.
fn gradient<'a>(
    answer: &Identification,
    level_at: Option<(&'a str, f64)>,
) -> Option<Vec<(&'a str, f64)>> {
    let [pole, constant] =
        ["pole", "constant"].map(|name| answer.parameters.get(name).and_then(|e| e.value));
    let (pole, constant) = (pole?, constant?);
    let v = level_at.map_or(1.0, |(_, v)| v.abs());
    let mut gradient =
        vec![("pole", -v / constant), ("constant", v * pole / (constant * constant))];
    gradient.extend(level_at.map(|(name, _)| (name, 1.0)));
    Some(gradient)
}

/// Standard deviation of a function of the parameters, to first order, with
/// their correlations.
fn deviation(answer: &Identification, gradient: &[(&str, f64)]) -> Option<f64> {
    let correlations = &answer.correlations;
    let index = |name: &str| correlations.names.iter().position(|known| known == name);
    let term = |(name, slope): &(&str, f64)| {
        Some((slope * std(answer.parameters.get(*name)?)?, index(name)))
    };
    let terms: Vec<(f64, Option<usize>)> = gradient.iter().map(term).collect::<Option<_>>()?;
    let mut variance = 0.0;
    for (i, (a, row)) in terms.iter().enumerate() {
        for (j, (b, column)) in terms.iter().enumerate() {
            let listed = row.zip(*column).and_then(|(r, c)| correlations.matrix.get(r)?.get(c));
            variance += a * b * if i == j { 1.0 } else { listed.copied().unwrap_or(0.0) };
        }
    }
    // Rounding may leave a little less than nothing.
    let deviation = variance.max(0.0).sqrt();
    deviation.is_finite().then_some(deviation)
}

/// One direction of an answer, where the data determines its level.
pub(super) fn side(answer: &Identification, sign: f64) -> Option<Side> {
    let (key, static_key, name) = if sign > 0.0 {
        ("fc_plus", "fs_plus", "Fc⁺")
    } else {
        ("fc_minus", "fs_minus", "Fc⁻")
    };
    let estimate =
        |key: &str| answer.parameters.get(key).filter(|estimate| estimate.value.is_some());
    let (key, estimate_of_level) = match estimate(key) {
        Some(own) => (key, own),
        None => ("fc_mean", estimate("fc_mean")?),
    };
    Some(Side {
        sign,
        level: estimate_of_level.value?,
        level_std: std(estimate_of_level),
        static_level: estimate(static_key)
            .or_else(|| estimate(&format!("static_friction.{static_key}")))
            .and_then(|estimate| estimate.value),
        name,
        key,
        bend: Bend::of(answer, sign),
    })
}

/// Widths of a 95 % interval in standard deviations, as the answer has them.
pub(super) fn quantile(answer: &Identification) -> f64 {
    let widths = answer.parameters.values().filter(|e| !e.at_bound).filter_map(|estimate| {
        let [from, to] = estimate.interval95?;
        let width = 0.5 * (to - from) / estimate.std?;
        (1.9..13.0).contains(&width).then_some(width)
    });
    widths.fold(1.96, f64::max)
}

/// Lower edge outwards, upper edge back: the area of the 95 % band.
pub(super) fn band(
    answer: &Identification,
    side: &Side,
    viscous: &Viscous,
    reach: f64,
) -> Vec<[f64; 2]> {
    let quantile = quantile(answer);
    let edge = |end: f64| {
        (0..=STEPS).map(move |i| {
            let v = reach * i as f64 / STEPS as f64;
            let gradient = gradient(answer, Some((side.key, v))).unwrap_or_default();
            let std = side.level_std.and(viscous.std);
            let std = std.and_then(|_| deviation(answer, &gradient)).unwrap_or(0.0);
            let torque = side.torque(viscous.slope, v) + end * quantile * std;
            [side.sign * v, side.sign * torque]
        })
    };
    edge(-1.0).chain(edge(1.0).collect::<Vec<_>>().into_iter().rev()).collect()
}

#[cfg(test)]
mod tests {
    use servoscope_core::answers::sample;

    use super::*;

    #[test]
    fn the_band_knows_that_pole_and_constant_go_together() {
        let mut answer = sample::identification();
        let gradient = gradient(&answer, None).unwrap();
        let loose = deviation(&answer, &gradient).unwrap();
        // a/K with both terms of the same size: σ√2 without correlation, 0 with that of −1
        // between pole (negative) and constant, which is what the sample nearly has.
        answer.correlations.matrix = vec![vec![1.0, 0.0], vec![0.0, 1.0]];
        let free = deviation(&answer, &gradient).unwrap();
        assert!(loose < 0.2 * free, "{loose} {free}");
    }

    #[test]
    fn what_an_effect_makes_of_friction_is_drawn() {
        let mut answer = sample::identification();
        let mut set = |name: &str, value: f64| {
            let mut estimate = answer.parameters["fc_plus"].clone();
            estimate.value = Some(value);
            answer.parameters.insert(name.to_owned(), estimate);
        };
        set("fc_minus", 0.4);
        set("static_friction.fs_minus", 0.6);
        set("viscous_asymmetry.alpha", -0.25);
        set("stribeck.fs_over_fc", 1.5);
        set("stribeck.stribeck_velocity", 2.0);
        set("quadratic_drag.c", 0.01);
        let minus = side(&answer, -1.0).unwrap();
        assert_eq!(minus.static_level, Some(0.6));
        assert!((minus.torque(1.0, 0.0) - 0.6).abs() < 1e-12);
        let expected = 0.4 * (1.0 + 0.5 * (-1.0_f64).exp()) + 1.25 * 2.0 + 0.04;
        assert!((minus.torque(1.0, 2.0) - expected).abs() < 1e-12);
        let ends = minus.curve(1.0, 2.0).last().unwrap();
        assert_eq!(ends, [-2.0, -minus.torque(1.0, 2.0)]);
    }
}
