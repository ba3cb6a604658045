//! Made-up answers of each kind, for tests of the code that displays or stores them.

use indexmap::IndexMap;

use super::{
    AsMeasured, BandDeparture, Candidate, Cause, ComparedExperiment, ComparedHarmonic, Comparison,
    Correlations, Diagnosis, Discrepancy, DistortionLine, EffectSize, FaultKind, Fit, Gain,
    Identification, IdentifyOptions, LeftOutRow, LinearLine, Linearity, LinearityLevel,
    MeasurementFault, Method, NextExperiment, NoiseSource, OrderCandidate, OrderChoice,
    ParameterEstimate, Parity, Pattern, Plan, PlanOptions, PlanRequest, PlannedEffect,
    PlannedExperiment, PlannedSweep, Provenance, ResidualGroup, ResidualTest, RoughAxis, Share,
    SizedParameter, Stage, TransferFunction, ValidBand, ValidatedCause, ValidatedModel,
    ValidatedModels, Validation, ValidationProvenance, Verdict,
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

fn estimate(value: f64, std: f64, unit: &str) -> ParameterEstimate {
    ParameterEstimate {
        value: Some(value),
        std: Some(std),
        interval95: Some([value - 1.96 * std, value + 1.96 * std]),
        unit: unit.to_owned(),
        at_bound: false,
        identifiable: true,
    }
}

fn unidentifiable(unit: &str) -> ParameterEstimate {
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

/// Three magnitudes at six frequencies with harmonics 0 to 3; every measured value is 1 % above the
/// simulated one.
pub fn comparison() -> Comparison {
    let experiment = |index: usize, magnitude: f64, omega_rad_s: f64| {
        let harmonic = |order: usize| {
            let slow = 1.0 + omega_rad_s / 10.0;
            let size = magnitude / (slow * (1.0 + (order * order) as f64));
            let [re, im] = if order == 0 { [-0.02 * size, 0.0] } else { [size, -0.4 * size] };
            ComparedHarmonic {
                order,
                input: [if order == 1 { magnitude } else { 0.0 }, 0.0],
                measured: [1.01 * re, 1.01 * im],
                simulated: [re, im],
                std: 0.002,
            }
        };
        ComparedExperiment {
            experiment: index,
            magnitude,
            omega_rad_s,
            run: Some(index as f64),
            harmonics: (0..4).map(harmonic).collect(),
        }
    };
    let design = [1.0, 2.0, 4.0].into_iter();
    let design = design.flat_map(|m| [1.0, 2.0, 5.0, 10.0, 20.0, 50.0].map(|omega| (m, omega)));
    Comparison {
        input_unit: "A".into(),
        response_unit: "rad/s".into(),
        response_quantity: "velocity".into(),
        std_estimated: false,
        experiments: design.enumerate().map(|(i, (m, w))| experiment(i, m, w)).collect(),
        unanswered: Vec::new(),
    }
}

/// A pattern that covers the whole measurement.
pub fn pattern(sentence: &str) -> Pattern {
    Pattern {
        magnitudes: None,
        frequencies_hz: None,
        harmonics: Vec::new(),
        runs: None,
        count: 12,
        rms_sigmas: 9.0,
        rms_response: 0.02,
        relative_size: Some(0.01),
        phase_deg: None,
        share: 0.4,
        sentence: sentence.to_owned(),
    }
}

/// Three overlapping patterns of [`comparison`].
pub fn discrepancy() -> Discrepancy {
    let high = Pattern {
        magnitudes: Some([4.0, 4.0]),
        frequencies_hz: Some([0.3, 3.0]),
        harmonics: vec![1],
        ..pattern("At 4 A from 0.3 to 3 Hz the fundamental is 1 % larger than simulated (9 σ).")
    };
    let odd = Pattern {
        harmonics: vec![1, 3],
        ..pattern("At every magnitude the odd harmonics are larger than simulated.")
    };
    let late = Pattern { runs: Some([10.0, 17.0]), ..pattern("It grows with the run.") };
    Discrepancy {
        sentence: "The simulation is wrong in the fundamental at the largest magnitude.".into(),
        noise_like: false,
        tests: Vec::new(),
        patterns: vec![high, odd, late],
        by_magnitude: Vec::new(),
        by_frequency: Vec::new(),
        by_harmonic: Vec::new(),
        by_run: Vec::new(),
    }
}

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

/// A stepped sine of two magnitudes with odd distortion.
pub fn linearity() -> Linearity {
    let level = |magnitude: f64, odd: f64| LinearityLevel {
        magnitude,
        realisations: 1,
        approximation: [0.5, 1.0, 2.0]
            .map(|hz| LinearLine {
                omega_rad_s: std::f64::consts::TAU * hz,
                gain: [0.9 / hz, -0.3],
                noise_std: Some(0.001),
                total_std: None,
                amplitude: magnitude / hz,
                noise: Some(0.001),
            })
            .to_vec(),
        distortion: [(0.5, Parity::Odd), (0.5, Parity::Even), (2.0, Parity::Odd)]
            .map(|(hz, parity)| DistortionLine {
                omega_rad_s: std::f64::consts::TAU * hz,
                parity,
                amplitude: if parity == Parity::Odd { odd * magnitude } else { 0.001 },
                noise: Some(0.001),
            })
            .to_vec(),
        noise: Some(0.003),
        even: Some(Share { value: 0.0, detectable: Some(0.002) }),
        odd: Some(Share { value: odd, detectable: Some(0.002) }),
        stochastic: None,
    };
    Linearity {
        levels: vec![level(1.0, 0.11), level(2.0, 0.06)],
        change_with_level: Some(Share { value: 0.21, detectable: Some(0.002) }),
        sentence: "before any model: noise is 0.3 % of the response; odd distortion is 6 to 11 %; \
                   there is no even distortion above 0.2 %; from the smallest to the largest \
                   magnitude the gain changes by 21 %"
            .into(),
    }
}

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

/// Validation of [`explained`] on another measurement.
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
