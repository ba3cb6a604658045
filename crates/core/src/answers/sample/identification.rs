//! A made-up identification.

use indexmap::IndexMap;

use crate::answers::{
    Correlations, Fit, Identification, IdentifyOptions, Method, NoiseSource, OrderCandidate,
    OrderChoice, ParameterEstimate, Provenance, Stage, TransferFunction,
};

/// An adequate identification of the paper's system G1, in which the data does not determine
/// `fc_minus`.
pub fn identification() -> Identification {
    let parameters = IndexMap::from([
        ("pole".to_owned(), estimate(-10.02, 0.031, "rad/s")),
        ("constant".to_owned(), estimate(10.01, 0.028, "rad/s²/A")),
        ("dc_gain".to_owned(), estimate(0.999, 0.0012, "rad/s/A")),
        (
            "fc_plus".to_owned(),
            ParameterEstimate { at_bound: true, ..estimate(0.5004, 0.0021, "A") },
        ),
        ("fc_minus".to_owned(), unidentifiable("A")),
    ]);
    Identification {
        method: Method::AbcAnn,
        seed: 1,
        noise: NoiseSource::Given,
        parameters,
        transfer_function: TransferFunction {
            numerator: vec![10.01],
            denominator: vec![1.0, 10.02],
            poles: vec![[-10.02, 0.0]],
            dc_gain: 0.999,
        },
        fit: Fit {
            chi2: Some(812.3),
            dof: 840,
            chi2_per_dof: Some(0.967),
            nrmse: 0.0123,
            rms_residual: 0.0045,
            p_value: Some(0.74),
            adequate: Some(true),
            uncertainty_scale: 1.0,
            unanswered: Vec::new(),
            noise_law: None,
        },
        correlations: Correlations {
            names: vec!["pole".into(), "constant".into()],
            matrix: vec![vec![1.0, -0.98], vec![-0.98, 1.0]],
        },
        order_choice: Some(OrderChoice {
            actuator_order: 0,
            explanation: "Order 0 explains the data; order 1 gains too little to pay.".into(),
            candidates: vec![
                OrderCandidate { actuator_order: 0, chi2: 812.3, parameters: 4, criterion: 839.2 },
                OrderCandidate { actuator_order: 1, chi2: 811.9, parameters: 5, criterion: 845.6 },
            ],
        }),
        stages: vec![
            stage("refinement (order 0)", 37, 0.81, 812.3),
            stage("colony (order 1)", 1010, 1.5, 840.0),
            stage("refinement (order 1)", 47, 0.4, 811.9),
        ],
        stop_reason: "the cost no longer changes".into(),
        doubts: Vec::new(),
        limitations: vec!["One magnitude only: fc_minus cannot be told from fc_plus.".into()],
        provenance: Provenance {
            software_version: "0.1.0".into(),
            data_sha256: "00ff".into(),
            options: IdentifyOptions::default(),
            actuator_order: None,
        },
    }
}

pub(super) fn estimate(value: f64, std: f64, unit: &str) -> ParameterEstimate {
    ParameterEstimate {
        value: Some(value),
        std: Some(std),
        interval95: Some([value - 1.96 * std, value + 1.96 * std]),
        unit: unit.to_owned(),
        at_bound: false,
        identifiable: true,
    }
}

pub(super) fn unidentifiable(unit: &str) -> ParameterEstimate {
    ParameterEstimate {
        value: None,
        std: None,
        interval95: None,
        unit: unit.to_owned(),
        at_bound: false,
        identifiable: false,
    }
}

/// A stage of a search.
pub fn stage(name: &str, evaluations: u64, seconds: f64, cost: f64) -> Stage {
    Stage {
        name: name.into(),
        evaluations,
        budget: None,
        seconds,
        cost,
        parameters: IndexMap::from([("pole".to_owned(), -10.02)]),
        stop_reason: "the cost no longer changes".into(),
    }
}
