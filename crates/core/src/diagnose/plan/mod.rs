//! Plans experiments before anything is measured.
//!
//! 1. `setting`: the rough idea of the axis and the limits are checked.
//! 2. `scenario`, `information`: on a grid of magnitudes and frequencies (`design`) the response of the
//!    axis, and of some axes drawn around it, is simulated with its derivatives and with every effect of
//!    the library in several sizes.
//! 3. `criterion`: how surely a set of experiments names each effect.
//! 4. `exchange`: the set of experiments that does it best within the budget. `sweep`: what it is compared
//!    with.
//! 5. `order`: the order of the experiments. `report`: the answer.
//! 6. `excitation`: the input of the plan as samples.

mod criterion;
mod design;
mod error;
mod exchange;
mod excitation;
mod information;
mod order;
mod report;
mod scenario;
mod setting;
mod sizes;
mod sweep;
#[cfg(test)]
mod tests;

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use crate::answers::{Plan, PlanRequest};
use crate::observer::Observer;

pub use error::PlanError;
pub use excitation::{ExcitationError, ExcitationKind, excitation};

use design::{FEWEST_REPEATS, Point};
use exchange::Choice;
use information::Scenario;
use report::Report;
use setting::Setting;
use sweep::Sweep;

/// Axes that a plan is made for: the rough idea itself and some drawn around it.
const SCENARIOS: usize = 3;

/// Fewest experiments that a plan consists of.
const FEWEST_EXPERIMENTS: usize = 4;

/// Plans experiments that tell as much as possible of what an axis may have beyond the base model, within
/// a budget of time.
///
/// # Errors
/// See [`PlanError`].
pub fn plan(request: &PlanRequest, observer: &dyn Observer) -> Result<Plan, PlanError> {
    let setting = Setting::of(request)?;
    let points = design::grid(&setting);
    let rng = &mut ChaCha8Rng::seed_from_u64(request.options.seed);
    let mut scenarios = Vec::with_capacity(SCENARIOS);
    for index in 0..SCENARIOS {
        let plant = match index {
            0 => setting.plant,
            _ => scenario::drawn(&setting.plant, request.options.uncertainty, rng),
        };
        scenarios.push(Scenario::of(&setting, &plant, &points, rng, observer));
    }
    let allowed = allowed(&setting, &points, &scenarios);
    check_budget(&setting, &points, &allowed)?;
    let budget_s = request.budget_s;
    let sweeps: Vec<Sweep> = [sweep::ONE.as_slice(), sweep::ALL.as_slice()]
        .into_iter()
        .filter_map(|magnitudes| Sweep::within(&points, &allowed, magnitudes, budget_s))
        .collect();
    let imitators = criterion::imitators();
    let choice = Choice {
        scenarios: &scenarios,
        points: &points,
        allowed: &allowed,
        imitators: &imitators,
        budget_s,
        observer,
    };
    let starts: Vec<_> = sweeps.iter().map(|sweep| sweep.design.clone()).collect();
    let design = choice.best(&starts);
    if observer.cancelled() {
        return Err(PlanError::Cancelled);
    }
    let report = Report {
        setting: &setting,
        points: &points,
        scenarios: &scenarios,
        imitators: &imitators,
        allowed: &allowed,
    };
    Ok(report.plan(&design, &sweeps, rng))
}

/// Which points keep within the limits for every axis.
fn allowed(setting: &Setting, points: &[Point], scenarios: &[Scenario]) -> Vec<bool> {
    let within = |value: f64, most: Option<f64>| most.is_none_or(|most| value <= most);
    let request = &setting.request;
    let is_allowed = |point: usize| {
        scenarios.iter().map(|scenario| scenario.motion(point)).all(|[speed, travel]| {
            within(speed, request.options.largest_velocity)
                && within(travel, request.options.largest_travel)
        })
    };
    (0..points.len()).map(is_allowed).collect()
}

/// Refuses limits and budgets that leave too few experiments.
fn check_budget(setting: &Setting, points: &[Point], allowed: &[bool]) -> Result<(), PlanError> {
    let mut durations: Vec<f64> = points
        .iter()
        .zip(allowed)
        .filter(|(_, allowed)| **allowed)
        .map(|(point, _)| point.duration_s(FEWEST_REPEATS))
        .collect();
    let (left, of) = (durations.len(), points.len());
    if left < FEWEST_EXPERIMENTS {
        return Err(PlanError::NothingAllowed { left, of });
    }
    durations.sort_by(f64::total_cmp);
    let needed_s = durations[..FEWEST_EXPERIMENTS].iter().sum();
    let budget_s = setting.request.budget_s;
    match budget_s < needed_s {
        true => Err(PlanError::TooShort { budget_s, fewest: FEWEST_EXPERIMENTS, needed_s }),
        false => Ok(()),
    }
}
