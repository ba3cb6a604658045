//! A made-up gain on held-out data, and a validation.

use crate::answers::{
    Gain, IdentifyOptions, ValidatedCause, ValidatedModel, ValidatedModels, Validation,
    ValidationProvenance, Verdict,
};

/// A significant gain on held-out data.
pub fn gain() -> Gain {
    Gain {
        heldout_nrmse_before: 0.039,
        heldout_nrmse_after: 0.0124,
        ratio: 3.15,
        interval95: [2.71, 3.64],
        chi2_per_dof_before: Some(3.31),
        chi2_per_dof_after: Some(0.98),
        heldout: "every third frequency".into(),
    }
}

/// Validation of [`super::explained`] on another measurement.
pub fn validation() -> Validation {
    let model = |nrmse: f64, chi2_per_dof: f64| ValidatedModel {
        nrmse: Some(nrmse),
        rms: nrmse,
        chi2_per_dof: Some(chi2_per_dof),
        components: 96,
        unanswered: Vec::new(),
    };
    let gain = Gain {
        heldout_nrmse_before: 0.02,
        heldout_nrmse_after: 0.005,
        ratio: 4.0,
        interval95: [3.1, 5.2],
        chi2_per_dof_before: Some(4.1),
        chi2_per_dof_after: Some(1.02),
        heldout: "a second measurement: 24 experiments".into(),
    };
    Validation {
        data_sha256: "11ee".into(),
        response_quantity: "velocity".into(),
        response_unit: "rad/s".into(),
        models: ValidatedModels { base: model(0.02, 4.1), extended: Some(model(0.005, 1.02)) },
        causes: vec![ValidatedCause { effect: "static_friction".into(), gain: Some(gain.clone()) }],
        gain: Some(gain),
        motions: Vec::new(),
        verdict: Some(Verdict::Explained),
        remarks: vec![
            "static_friction helps here, too".into(),
            "it says little of the mean".into(),
        ],
        provenance: ValidationProvenance {
            software_version: "0.1.0".into(),
            fitted_data_sha256: "00ff".into(),
            validation_data_sha256: "11ee".into(),
            fitted_by_version: "0.1.0".into(),
            options: IdentifyOptions::default(),
        },
    }
}
