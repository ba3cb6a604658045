//! Made-up diagnoses.

use indexmap::IndexMap;

use super::identification::{estimate, identification, unidentifiable};
use super::linearity::linearity;
use crate::answers::{
    AsMeasured, BandDeparture, Candidate, Cause, Diagnosis, Discrepancy, FaultKind, LeftOutRow,
    MeasurementFault, NextExperiment, ParameterEstimate, Pattern, ResidualGroup, ResidualTest,
    ValidBand, Verdict,
};

/// A diagnosis of [`identification`] that finds one pattern and no cause.
pub fn diagnosis() -> Diagnosis {
    let base = identification();
    let sentence = "at the lowest magnitude (1 A), below 3 Hz, the third harmonic is 40 % larger than simulated";
    let group = |from: f64, to: f64| ResidualGroup {
        from,
        to,
        count: 96,
        rms_sigmas: 3.21,
        rms_response: 0.00123,
        relative: 0.0456,
    };
    let test = |name: &str, p_value: Option<f64>, explanation: &str| ResidualTest {
        name: name.into(),
        statistic: 12.5,
        p_value,
        passed: p_value.is_none(),
        explanation: explanation.into(),
    };
    Diagnosis {
        verdict: Verdict::Unexplained,
        discrepancy: Discrepancy {
            sentence: format!("the simulation is wrong: {sentence}"),
            noise_like: false,
            tests: vec![
                test("size", Some(1e-30), "the residuals are larger than the noise"),
                test("run", None, "not tested: the order of acquisition is not given"),
            ],
            patterns: vec![Pattern {
                magnitudes: Some([1.0, 1.0]),
                frequencies_hz: Some([0.3, 2.8]),
                harmonics: vec![3],
                runs: None,
                count: 12,
                rms_sigmas: 14.2,
                rms_response: 0.0021,
                relative_size: Some(0.4),
                phase_deg: None,
                share: 0.62,
                sentence: sentence.into(),
            }],
            by_magnitude: vec![group(1.0, 1.0), group(2.0, 2.0)],
            by_frequency: vec![group(0.3, 2.8)],
            by_harmonic: vec![group(1.0, 1.0), group(3.0, 3.0)],
            by_run: Vec::new(),
        },
        causes: Vec::new(),
        candidates: Vec::new(),
        gain: None,
        provenance: base.provenance.clone(),
        base,
        extended: None,
        linearity: Some(linearity()),
        measurement: Vec::new(),
        as_measured: None,
        rival_faults: Vec::new(),
        valid_band: Some(ValidBand {
            usable_hz: Some([0.1, 8.0]),
            departures: vec![BandDeparture {
                from_hz: 8.2,
                to_hz: 20.0,
                gain_db: -15.0,
                phase_deg: 157.0,
            }],
            sentence: "use the model from 0.1 to 8 Hz only, where it stays within about 3 dB and \
                       20° of the measurement; from 8.2 to 20 Hz it is off by up to 15 dB and 157°"
                .into(),
        }),
        next_experiment: None,
        validation: None,
        limitations: Vec::new(),
    }
}

/// [`diagnosis`] of a measurement of which one row was left out.
pub fn mended() -> Diagnosis {
    let row = LeftOutRow {
        experiment: 4,
        harmonic: 1,
        repeat: None,
        line: Some(153),
        off: 0.2,
        sigmas: 190.0,
    };
    let sentence = "line 153 (harmonic 1 at magnitude 2 and 3 Hz) is an outlier: 20 % off the fit, \
                    190 standard deviations; left out";
    let fault = MeasurementFault {
        sentence: sentence.into(),
        remedy: "measure again what is listed, or delete its lines".into(),
        left_out: vec![row],
        ..MeasurementFault::of(FaultKind::BadRows)
    };
    let as_measured = AsMeasured {
        nrmse: 0.041,
        chi2_per_dof: Some(69.0),
        causes: vec!["friction_drift".into()],
        nrmse_with_causes: Some(0.039),
    };
    Diagnosis { measurement: vec![fault], as_measured: Some(as_measured), ..diagnosis() }
}

/// [`diagnosis`] with static friction as the cause. The data does not determine `fs_minus`, and two
/// other effects are equivalent.
pub fn explained() -> Diagnosis {
    let mut answer = diagnosis();
    let mut extended = identification();
    let fit = &mut answer.base.fit;
    (fit.chi2, fit.dof, fit.chi2_per_dof) = (Some(2740.6), 842, Some(3.25));
    (fit.nrmse, fit.adequate) = (0.0381, Some(false));
    let levels = [("fs_plus", estimate(0.80135, 0.00332, "A")), ("fs_minus", unidentifiable("A"))];
    let parameters = IndexMap::from(levels.map(|(name, level)| (name.to_owned(), level)));
    let named = |(name, level): (&String, &ParameterEstimate)| {
        (format!("static_friction.{name}"), level.clone())
    };
    extended.parameters.extend(parameters.iter().map(named));
    let candidate = |effect: &str, delta_chi2: f64, rejected: Option<&str>| Candidate {
        effect: effect.into(),
        cost: 2740.6 - delta_chi2,
        delta_chi2,
        criterion: 2764.1 - delta_chi2,
        heldout_error: None,
        rejected: rejected.map(str::to_owned),
    };
    let chance = "the improvement may be chance";
    Diagnosis {
        verdict: Verdict::Explained,
        causes: vec![Cause {
            effect: "static_friction".into(),
            parameters,
            confidence: 0.93,
            margin: Some(12.4),
            explanation: "breakaway takes more torque than sliding".into(),
            gain: None,
            equivalents: vec!["stribeck".into(), "presliding".into()],
        }],
        candidates: vec![
            candidate("static_friction", 2131.9, None),
            candidate("stribeck", 2013.8, Some("static_friction explains the data better")),
            candidate("cogging", -47122.8, Some(chance)),
        ],
        extended: Some(extended),
        next_experiment: Some(NextExperiment {
            magnitude: 1.25,
            omega_rad_s: 2.0,
            reason: "measure at magnitude 1.25 A and 0.318 Hz: there the predictions of \
                     static_friction and stribeck differ most"
                .into(),
        }),
        ..answer
    }
}
