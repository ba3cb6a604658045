//! Tables of a plan.

use std::f64::consts::TAU;

use servoscope_core::answers::{Plan, PlannedEffect, PlannedExperiment};

use crate::report::columns::Side::{Left, Right};

use super::{Cell, Table, parameter_of_size};

/// How surely each effect is identified, the surest first.
pub(in crate::report) fn nameable(plan: &Plan) -> Table {
    let mut effects: Vec<&PlannedEffect> = plan.effects.iter().collect();
    effects.sort_by(|a, b| b.score.total_cmp(&a.score));
    let rows = effects.into_iter().map(|effect| {
        let swept = plan.sweeps.last().and_then(|sweep| sweep.probabilities.get(&effect.effect));
        let size = |size: &Option<_>| size.as_ref().map_or("never".into(), parameter_of_size);
        [
            Cell::Effect(effect.effect.clone()),
            Cell::PerCent(effect.probability, 2),
            Cell::of(swept, |share| Cell::PerCent(*share, 2)),
            Cell::words(parameter_of_size(&effect.typical)),
            Cell::words(size(&effect.named_from)),
            Cell::of(effect.closest_imitator.clone(), Cell::Effect),
        ]
    });
    let columns = [
        ("effect", Left, "Effect"),
        ("identified", Right, "probability"),
        ("by a sweep", Right, "by a sweep"),
        ("typical size", Left, "typical size"),
        ("smallest size told apart", Left, "smallest size told apart"),
        ("most similar effect", Left, "most similar effect"),
    ];
    Table::new(columns, rows)
}

/// Experiments in their order.
pub(in crate::report) fn planned(experiments: &[PlannedExperiment]) -> Table {
    let rows = experiments.iter().map(|experiment| {
        [
            Cell::words(experiment.run.to_string()),
            Cell::Value(experiment.magnitude, 4),
            Cell::Value(experiment.omega_rad_s / TAU, 4),
            Cell::words(experiment.settle_periods.to_string()),
            Cell::words(format!("{} × {}", experiment.repeats, experiment.measured_periods)),
            Cell::Value(experiment.duration_s, 3),
            Cell::of(experiment.serves.clone(), Cell::Effect),
        ]
    });
    let columns = [
        ("run", Right, "run"),
        ("magnitude", Right, "magnitude"),
        ("Hz", Right, "frequency, Hz"),
        ("settling periods", Right, "settling periods"),
        ("repeats × periods", Right, "repeats × periods"),
        ("duration, s", Right, "duration, s"),
        ("mainly for", Left, "mainly for"),
    ];
    Table::new(columns, rows)
}
