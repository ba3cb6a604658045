//! Fine scans of effects whose misfit has many valleys.
//!
//! A torque that ripples over position fits only where its pitch is right to a
//! radian over the travel. So a grid as fine as that is tried with first-order
//! responses: the sine and the cosine of each pitch, whose sizes follow from
//! least squares.

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use crate::effects::{Effect, Range};
use crate::identify::{Model, Workbench};

use super::anchor::Anchor;
use super::subspace::Subspace;

/// Places that are looked at in full.
const PLACES: usize = 6;

/// Steps of the angle over the longest travel, radians.
const STEP: f64 = 1.0;

/// Longest step of the pitch, as a factor.
const LONGEST: f64 = 1.15;

/// A pitch with what its sine and cosine would explain.
struct Pitch {
    values: Vec<f64>,
    gain: f64,
    span: Subspace,
}

/// Parameters (size, pitch, angle) that promise most, and the span of every
/// pitch that was tried; `extended` is the anchor's model with the effect.
pub(super) fn scan(
    workbench: &Workbench<'_>,
    anchor: &Anchor,
    effect: &'static dyn Effect,
    extended: &Model,
    ranges: &[Range],
) -> (Vec<Vec<f64>>, Vec<Subspace>) {
    let own = extended.parameters_of(extended.effects().len() - 1);
    let mut without = extended.clone();
    without.set(own.start, ranges[0].absent.unwrap_or(0.0));
    let Some(balanced) = workbench.predict(&without) else { return Default::default() };
    let left = anchor.fitted.complement(&(&anchor.residuals + &anchor.prediction - balanced));
    let [low, high] = ranges[1].likely;
    let travel = 0.5 / low;
    let next = |pitch: &f64| Some((pitch * LONGEST).min(pitch + STEP / travel));
    let grid: Vec<f64> =
        std::iter::successors(Some(low), next).take_while(|pitch| *pitch < high).collect();
    let tried: Vec<Option<Pitch>> = grid
        .par_iter()
        .map(|pitch| {
            let settings = [0.0, std::f64::consts::FRAC_PI_2].map(|angle| vec![1.0, *pitch, angle]);
            let changes = workbench.torque_changes(&anchor.model, effect, &settings, *pitch)?;
            let columns: Vec<DVector<f64>> =
                changes.iter().map(|change| anchor.fitted.complement(change)).collect();
            let columns = DMatrix::from_columns(&columns);
            let span = Subspace::of(&columns);
            let sizes = columns.tr_mul(&columns).cholesky()?.solve(&columns.tr_mul(&left));
            let size = sizes.norm().min(ranges[0].likely[1]);
            let values = vec![size, *pitch, sizes[1].atan2(sizes[0])];
            Some(Pitch { values, gain: span.energy(&left), span })
        })
        .collect();
    let mut tried: Vec<Pitch> = tried.into_iter().flatten().collect();
    let peak = |i: usize| {
        let gain = |j: usize| tried.get(j).map_or(0.0, |pitch| pitch.gain);
        gain(i) >= gain(i + 1) && (i == 0 || gain(i) >= gain(i - 1))
    };
    let mut peaks: Vec<&Pitch> = (0..tried.len()).filter(|i| peak(*i)).map(|i| &tried[i]).collect();
    peaks.sort_by(|a, b| b.gain.total_cmp(&a.gain));
    let places = peaks.into_iter().take(PLACES).map(|pitch| pitch.values.clone()).collect();
    (places, tried.drain(..).map(|pitch| pitch.span).collect())
}
