//! Tables of a plan.

use servoscope_core::answers::{Plan, PlannedEffect, PlannedExperiment};

use crate::report::columns::Side::{Left, Right};

use super::{Cell, Table, parameter_of_size};

/// How surely each effect is named, the surest first.
pub(in crate::report) fn nameable(plan: &Plan) -> Table {
    let mut effects: Vec<&PlannedEffect> = plan.effects.iter().collect();
    effects.sort_by(|a, b| b.score.total_cmp(&a.score));
    let rows = effects.into_iter().map(|effect| {
        let swept = plan.sweeps.last().and_then(|sweep| sweep.probabilities.get(&effect.effect));
        let size = |size: &Option<_>| size.as_ref().map_or("no size".into(), parameter_of_size);
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
        ("named", Right, "named with"),
        ("by a sweep", Right, "by a sweep"),
        ("typical size", Left, "typical size"),
        ("told from its imitators from", Left, "told from its imitators from"),
        ("closest imitator", Left, "closest imitator"),
    ];
    Table::new(columns, rows)
}

/// Experiments in their order.
pub(in crate::report) fn planned(experiments: &[PlannedExperiment]) -> Table {
    let rows = experiments.iter().map(|experiment| {
        [
            Cell::words(experiment.run.to_string()),
            Cell::Value(experiment.magnitude, 4),
            Cell::Value(experiment.omega_rad_s, 4),
            Cell::words(experiment.settle_periods.to_string()),
            Cell::words(format!("{} × {}", experiment.repeats, experiment.measured_periods)),
            Cell::Value(experiment.duration_s, 3),
            Cell::of(experiment.serves.clone(), Cell::Effect),
        ]
    });
    let columns = [
        ("run", Right, "run"),
        ("magnitude", Right, "magnitude"),
        ("rad/s", Right, "rad/s"),
        ("settle", Right, "periods to settle"),
        ("measure", Right, "repeats × periods"),
        ("s", Right, "s"),
        ("serves most", Left, "serves most"),
    ];
    Table::new(columns, rows)
}
