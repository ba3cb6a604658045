//! A made-up plan of experiments.

use crate::answers::{
    EffectSize, Plan, PlanOptions, PlanRequest, PlannedEffect, PlannedExperiment, PlannedSweep,
    RoughAxis, SizedParameter,
};

/// A plan of twelve experiments, and a sweep at three magnitudes.
pub fn plan() -> Plan {
    let axis = RoughAxis {
        pole: -10.0,
        constant: 10.0,
        fc_plus: 0.5,
        fc_minus: 0.4,
        actuator_pole: None,
        natural_frequency: None,
        damping_ratio: None,
    };
    let experiment = |run: usize| PlannedExperiment {
        run,
        magnitude: [1.0, 2.0, 4.0][run % 3],
        omega_rad_s: 10.0 + run as f64,
        settle_periods: 2,
        measured_periods: 1,
        repeats: 2 + run % 2,
        duration_s: 2.0,
        serves: (run > 0).then(|| "stribeck".to_owned()),
    };
    let experiments: Vec<PlannedExperiment> = (0..12).map(experiment).collect();
    let ids = ["stribeck", "spring", "transport_delay"];
    let size = |value: f64| EffectSize {
        parameters: [("stiffness".to_owned(), SizedParameter { value, unit: "input".into() })]
            .into(),
        set_by: vec!["stiffness".into()],
        change: 0.1 * value,
    };
    let effect = |(index, id): (usize, &str)| PlannedEffect {
        effect: id.into(),
        title: id.into(),
        typical: size(1.0),
        noticed_from: Some(size(0.1)),
        named_from: (index > 0).then(|| size(0.3)),
        closest_imitator: Some(ids[(index + 1) % ids.len()].into()),
        probability: 0.95 - 0.3 * index as f64,
        score: 0.6 - 0.2 * index as f64,
    };
    Plan {
        software_version: "0.0.0".into(),
        request: PlanRequest { axis, budget_s: 25.0, options: PlanOptions::default() },
        duration_s: 24.0,
        harmonics: 7,
        score: 0.4,
        nameable: 1,
        effects: ids.into_iter().enumerate().map(effect).collect(),
        sweeps: vec![PlannedSweep {
            magnitudes: vec![1.0, 2.0, 4.0],
            frequencies_rad_s: vec![5.0, 50.0],
            repeats: 2,
            duration_s: 20.0,
            score: 0.3,
            nameable: 0,
            probabilities: ids.map(|id| (id.to_owned(), 0.5)).into(),
            experiments: experiments[..6].to_vec(),
        }],
        notes: vec!["the axis is known to ± 25 % per parameter".into()],
        experiments,
    }
}
