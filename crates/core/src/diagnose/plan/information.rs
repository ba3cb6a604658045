//! What a repeat of an experiment tells: the products of the changes of its harmonics.
//!
//! A column is the change of all harmonics, in units of their noise, by one parameter of the base model
//! or by one effect of a typical size. The matrix of the products of all columns, summed over the
//! experiments of a design, is all that its criterion needs (the information matrix of V. V. Fedorov
//! 1972, Theory of Optimal Experiments).

use nalgebra::DMatrix;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

use crate::effects::{ALL, ActiveEffect, Effect, Wide};
use crate::measurement::Complex;
use crate::observer::Observer;
use crate::plant::{Friction, Plant};
use crate::simulate::{
    Counts, Excitation, NoResponse, respond, respond_if, respond_with_sensitivities,
};

use super::design::{Design, Point};
use super::scenario;
use super::setting::{HARMONICS, Setting};

/// Forms of every effect that are simulated: a typical one first, then drawn ones.
const FORMS: usize = 2;

/// Sizes of every form that are simulated, as factors on the typical size: log-uniform.
pub(super) const FACTORS: [f64; SIZES] = [1.0, 0.182_574_185_835_055_37, 1.0 / 30.0];
pub(super) const SIZES: usize = 3;

/// Columns of every effect: all sizes of its first form, then of the next. A rival imitates with any
/// sum of them.
pub(super) const VARIANTS: usize = FORMS * SIZES;

/// Share of the order of acquisition at which an experiment stands: its mean and mean square.
#[derive(Debug, Clone, Copy)]
pub(super) struct Share {
    mean: f64,
    square: f64,
}

impl Share {
    /// Anywhere, with the same probability: the order is drawn.
    pub const ANYWHERE: Self = Self { mean: 0.5, square: 1.0 / 3.0 };

    /// At this share: 0 first, 1 last.
    pub fn at(share: f64) -> Self {
        Self { mean: share, square: share * share }
    }
}

/// One axis as it may be, and what every point of the grid tells of it.
pub(super) struct Scenario {
    /// Parameters of the base model.
    pub base: usize,
    /// Parameters of every effect in its variants.
    pub variants: Vec<Vec<Vec<f64>>>,
    /// The columns that grow with the order of acquisition.
    ordered: Vec<bool>,
    /// Of every point, what one repeat tells.
    points: Vec<Told>,
}

/// What one repeat at a point tells.
struct Told {
    /// Products of all columns; of those that grow with the order at its end.
    products: DMatrix<f64>,
    /// Σ|Y|²/σ².
    response: f64,
    /// Largest velocity and travel, for the limits.
    motion: [f64; 2],
}

impl Scenario {
    /// Simulates all points for an axis. Forms of effects beyond the first come from `rng`.
    pub fn of(
        setting: &Setting,
        plant: &Plant,
        points: &[Point],
        rng: &mut ChaCha8Rng,
        observer: &dyn Observer,
    ) -> Self {
        let scales = setting.scales(plant);
        let variants: Vec<Vec<Vec<f64>>> = ALL
            .iter()
            .map(|effect| scenario::variants(*effect, &scales, FORMS, &FACTORS, rng))
            .collect();
        let told = points.par_iter().map(|point| told(setting, plant, &variants, point, observer));
        let points: Vec<Told> = told.collect();
        let base = 4 + usize::from(plant.actuator.order());
        let mut ordered = vec![false; base];
        for effect in ALL {
            ordered.extend([effect.search().needs_run; VARIANTS]);
        }
        Self { base, variants, ordered, points }
    }

    /// Adds `repeats` repeats of a point at a share of the order to the products of a design.
    pub fn add(&self, sum: &mut DMatrix<f64>, point: usize, repeats: f64, share: Share) {
        let products = &self.points[point].products;
        for (j, mut column) in sum.column_iter_mut().enumerate() {
            let by_order = self.ordered[j];
            for (i, entry) in column.iter_mut().enumerate() {
                let factor = match (by_order, self.ordered[i]) {
                    (false, false) => 1.0,
                    (true, true) => share.square,
                    _ => share.mean,
                };
                *entry += repeats * factor * products[(i, j)];
            }
        }
    }

    /// The products of a design whose order is drawn.
    pub fn sum(&self, design: &Design) -> DMatrix<f64> {
        let mut sum = self.nothing();
        for point in design.measured() {
            self.add(&mut sum, point, design.0[point] as f64, Share::ANYWHERE);
        }
        sum
    }

    /// The products of no experiment.
    pub fn nothing(&self) -> DMatrix<f64> {
        DMatrix::zeros(self.ordered.len(), self.ordered.len())
    }

    /// Σ|Y|²/σ² of one repeat at a point.
    pub fn response(&self, point: usize) -> f64 {
        self.points[point].response
    }

    /// The largest velocity and travel at a point.
    pub fn motion(&self, point: usize) -> [f64; 2] {
        self.points[point].motion
    }
}

/// Simulates one point. Where the axis has no periodic response, it tells nothing.
fn told(
    setting: &Setting,
    plant: &Plant,
    variants: &[Vec<Vec<f64>>],
    point: &Point,
    observer: &dyn Observer,
) -> Told {
    let columns = 4 + usize::from(plant.actuator.order()) + variants.iter().flatten().count();
    let still = || Told {
        products: DMatrix::zeros(columns, columns),
        response: 0.0,
        motion: [f64::INFINITY; 2],
    };
    if observer.cancelled() {
        return still();
    }
    let excitation = Excitation::cosine(point.omega_rad_s, point.magnitude);
    let Ok((velocity, by_parameter)) = base(plant, &excitation, setting.magnitudes[1]) else {
        return still();
    };
    let weights: Vec<f64> = velocity
        .iter()
        .map(|value| {
            let additive = setting.noise_std / point.repeat_s().sqrt();
            1.0 / additive.hypot(setting.request.options.noise_share * value.norm())
        })
        .collect();
    let row = |change: &[Complex]| -> Vec<f64> {
        let parts = change.iter().zip(&weights).enumerate();
        parts
            .flat_map(|(k, (value, weight))| {
                let im = (k > 0).then_some(value.im * weight);
                [Some(value.re * weight), im].into_iter().flatten()
            })
            .collect()
    };
    let mut rows: Vec<Vec<f64>> = by_parameter.iter().map(|change| row(change)).collect();
    let last = excitation.clone().at_run_share(1.0);
    let balanced = balanced(plant, &excitation);
    for (effect, variants) in ALL.iter().zip(variants) {
        let without = match effect.search().forces_zero_mean {
            true => balanced.as_ref(),
            false => Some(&velocity),
        };
        for values in variants {
            let with = with_effect(plant, *effect, values, &last);
            let change: Option<Vec<Complex>> = with.zip(without).map(|(with, without)| {
                with.iter().zip(without).map(|(with, without)| with - without).collect()
            });
            let nothing = || vec![0.0; 2 * HARMONICS + 1];
            rows.push(change.map_or_else(nothing, |change| row(&change)));
        }
    }
    let sized = |value: &Vec<f64>| value.iter().all(|x| x.is_finite());
    if !rows.iter().all(sized) {
        return still();
    }
    let matrix = DMatrix::from_fn(2 * HARMONICS + 1, rows.len(), |i, j| rows[j][i]);
    let response = row(&velocity).iter().map(|x| x * x).sum();
    Told { products: matrix.tr_mul(&matrix), response, motion: motion(&velocity, point) }
}

/// The response of the base model and its change by each parameter, per e-fold (friction: per level).
fn base(
    plant: &Plant,
    excitation: &Excitation,
    largest: f64,
) -> Result<(Vec<Complex>, Vec<Vec<Complex>>), NoResponse> {
    let mut sizes = Vec::new();
    let mut variable = |value: f64, size: f64| {
        sizes.push(size);
        Wide::variable(value, sizes.len() - 1)
    };
    let viscous_rate_rad_s = variable(plant.viscous_rate_rad_s, plant.viscous_rate_rad_s);
    let constant = variable(plant.constant, plant.constant);
    let actuator = plant.actuator.map(|value| variable(value, value));
    let mut level = |fc: f64| variable(fc, fc.max(1e-3 * largest));
    let friction = Friction::coulomb(level(plant.friction.fc_plus), level(plant.friction.fc_minus));
    let plant = Plant { viscous_rate_rad_s, constant, actuator, friction };
    let found = respond_with_sensitivities(
        Counts::FromRest,
        &plant,
        sizes.len(),
        &[],
        excitation,
        HARMONICS,
    )?;
    let scaled = |(row, size): (Vec<Complex>, f64)| row.into_iter().map(|x| x * size).collect();
    Ok((found.velocity, found.sensitivities.into_iter().zip(sizes).map(scaled).collect()))
}

/// The response with one effect; `None` if there is none of the input's period.
fn with_effect(
    plant: &Plant,
    effect: &'static dyn Effect,
    values: &[f64],
    excitation: &Excitation,
) -> Option<Vec<Complex>> {
    let active = ActiveEffect::new(effect, values.to_vec()).ok()?;
    respond_if(Counts::FromRest, plant, &[active], excitation, HARMONICS).ok()
}

/// The response with the mean velocity forced to zero and nothing else: a ripple of size zero.
fn balanced(plant: &Plant, excitation: &Excitation) -> Option<Vec<Complex>> {
    let ripple = ALL.iter().find(|effect| effect.is_scanned())?;
    let mut values = vec![1.0; ripple.parameters().len()];
    values[0] = 0.0;
    let active = ActiveEffect::new(*ripple, values).ok()?;
    respond(plant, &[active], excitation, HARMONICS).ok()
}

/// Bounds of the largest velocity and of the largest distance from the middle of the travel.
fn motion(velocity: &[Complex], point: &Point) -> [f64; 2] {
    let parts = velocity.iter().enumerate();
    parts.fold([0.0, 0.0], |[speed, travel], (k, value)| match k {
        0 => [speed + value.norm(), travel],
        _ => [speed + value.norm(), travel + value.norm() / (k as f64 * point.omega_rad_s)],
    })
}
