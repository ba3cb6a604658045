//! The figure of an effect: an axis with and without it.

use std::f64::consts::TAU;

use nalgebra::Complex;
use servoscope_core::effects::{ActiveEffect, Effect, MachineScales, Middle};
use servoscope_core::plant::{Actuator, Friction, Plant};
use servoscope_core::simulate::{Excitation, NoResponse, respond};

use crate::report::figures::Theme;
use crate::report::figures::chart::{self, Line, Plot, Stroke};

/// The axis: the first system of the paper.
const PLANT: Plant = Plant {
    viscous_rate_rad_s: 10.0,
    constant: 10.0,
    actuator: Actuator::Direct,
    friction: Friction { fc_plus: 0.5, fc_minus: 0.4, fs_plus: 0.5, fs_minus: 0.4 },
};

/// Lowest and highest magnitude, input units.
const MAGNITUDES: [f64; 2] = [1.0, 4.0];

/// Lowest and highest frequency, rad/s, and how many there are.
const FREQUENCIES: ([f64; 2], usize) = ([1.0, 100.0], 31);

/// Harmonics of the velocity that is drawn.
const HARMONICS: usize = 60;

/// Points of its period.
const POINTS: usize = 240;

/// Magnitude, frequency, and the harmonics without and with the effect.
struct Pair {
    magnitude: f64,
    omega: f64,
    without: Vec<Complex<f64>>,
    with: Vec<Complex<f64>>,
}

/// Draws an effect of typical size.
///
/// # Errors
/// If no axis can have that, or it does not move.
pub(super) fn draw(effect: &'static dyn Effect) -> Result<String, String> {
    let descriptor = effect.descriptor();
    let scales = MachineScales {
        viscous_rate: PLANT.viscous_rate_rad_s,
        constant: PLANT.constant,
        coulomb: [PLANT.friction.fc_plus, PLANT.friction.fc_minus],
        lowest: MAGNITUDES[0],
        highest: MAGNITUDES[1],
        fastest_rad_s: FREQUENCIES.0[1],
    };
    let values = (descriptor.draw.draw)(&scales, &mut Middle);
    let active = ActiveEffect::new(effect, values).map_err(|error| error.to_string())?;
    let pairs: Vec<Pair> = design().filter_map(|point| pair(&active, point).ok()).collect();
    let most = pairs.iter().max_by(|a, b| changed(a).total_cmp(&changed(b)));
    let most = most.ok_or_else(|| format!("{}: the axis does not move", effect.id()))?;
    let [gain, phase]: [fn(&Pair) -> f64; 2] = [
        |pair| 20.0 * (pair.with[1] / pair.without[1]).norm().log10(),
        |pair| (pair.with[1] / pair.without[1]).arg().to_degrees(),
    ];
    let plots = [
        Plot {
            x: "Share of a period".into(),
            y: format!("Velocity at magnitude {} and {:.3} rad/s", most.magnitude, most.omega),
            lines: vec![
                Line { stroke: Stroke::Dashed, ..period("without", &most.without) },
                period("with it", &most.with),
            ],
            ..Plot::default()
        },
        over_frequency("Change of the gain, dB", &pairs, gain),
        over_frequency("Change of the phase, degrees", &pairs, phase),
    ];
    let says = format!("An axis with and without {}.", descriptor.title);
    Ok(chart::lines(effect.id(), descriptor.title, &says, &plots, Theme::Auto))
}

/// Magnitudes and frequencies.
fn design() -> impl Iterator<Item = [f64; 2]> {
    let ([low, high], count) = FREQUENCIES;
    let omega = move |i: usize| low * (high / low).powf(i as f64 / (count - 1) as f64);
    MAGNITUDES.into_iter().flat_map(move |m| (0..count).map(move |i| [m, omega(i)]))
}

fn pair(effect: &ActiveEffect, [magnitude, omega]: [f64; 2]) -> Result<Pair, NoResponse> {
    // At the end of the order of acquisition a drift has come to its full size.
    let excitation = Excitation::cosine(omega, magnitude).at_run_share(1.0);
    let response = |effects: &[ActiveEffect]| respond(&PLANT, effects, &excitation, HARMONICS);
    let (without, with) = (response(&[])?, response(std::slice::from_ref(effect))?);
    Ok(Pair { magnitude, omega, without, with })
}

/// How much of a response an effect changes.
fn changed(pair: &Pair) -> f64 {
    let power = |values: &mut dyn Iterator<Item = Complex<f64>>| -> f64 {
        values.map(|value| value.norm_sqr()).sum()
    };
    let mut difference = pair.with.iter().zip(&pair.without).map(|(with, without)| with - without);
    power(&mut difference) / power(&mut pair.without.iter().copied())
}

/// One period from its harmonics.
fn period(label: &str, harmonics: &[Complex<f64>]) -> Line {
    let at = |share: f64| {
        let turned = |(order, value): (usize, &Complex<f64>)| {
            (value * Complex::from_polar(1.0, order as f64 * TAU * share)).re
        };
        harmonics.iter().enumerate().map(turned).sum::<f64>()
    };
    let points = (0..=POINTS).map(|i| i as f64 / POINTS as f64).map(|share| [share, at(share)]);
    Line { label: label.into(), points: points.collect(), stroke: Stroke::Solid }
}

fn over_frequency(y: &str, pairs: &[Pair], value: fn(&Pair) -> f64) -> Plot {
    let line = |magnitude: f64| Line {
        label: format!("magnitude {magnitude}"),
        points: pairs
            .iter()
            .filter(|pair| pair.magnitude == magnitude)
            .map(|pair| [pair.omega, value(pair)])
            .collect(),
        stroke: Stroke::Solid,
    };
    Plot {
        x: "Frequency, rad/s".into(),
        y: y.into(),
        logarithmic: [true, false],
        lines: MAGNITUDES.map(line).into(),
        ..Plot::default()
    }
}
