//! Faults beside something else that is wrong.

use super::*;

// Means and even harmonics both follow from the difference in friction. In peak-to-peak values they
// contradict each other by a factor of 2, far from a small change.
#[test]
fn peak_to_peak_values_are_told_by_the_means_beside_an_effect_too() {
    for late_s in [0.0, 5e-3] {
        let measurement = changed(18, |_, experiment, harmonic| {
            turned(harmonic, -(experiment.omega_rad_s * late_s).to_degrees());
            scaled(harmonic, if harmonic.order > 0 { 2.0 } else { 1.0 });
        });
        let answer = answer(&measurement);
        let faults: Vec<_> = answer.measurement.iter().map(|f| (f.fault, f.value)).collect();
        assert_eq!(faults, [(FaultKind::AmplitudeConvention, Some(0.5))]);
        let remedy = &answer.measurement[0].remedy;
        assert!(remedy.contains("--amplitude peak-to-peak"), "{remedy}");
        let causes: Vec<&str> = answer.causes.iter().map(|cause| cause.effect.as_str()).collect();
        assert_eq!(causes.first().copied(), (late_s > 0.0).then_some("transport_delay"));
    }
}

// The means are only some ten deviations large: with the effect alone all tests of noise are passed.
#[test]
fn a_fault_that_all_tests_of_noise_overlook_is_named_beside_an_effect() {
    let sound = with_noise(&exact(), 45.0, NoiseStatement::Std, 30);
    let mut experiments = sound.experiments().to_vec();
    for experiment in &mut experiments {
        let late = -(experiment.omega_rad_s * 0.02).to_degrees();
        for harmonic in &mut experiment.response {
            turned(harmonic, late);
            scaled(harmonic, if harmonic.order > 0 { 0.5_f64.sqrt() } else { 1.0 });
        }
    }
    let answer = answer(&of(experiments));
    let faults: Vec<_> = answer.measurement.iter().map(|f| (f.fault, f.value)).collect();
    assert_eq!(faults, [(FaultKind::AmplitudeConvention, Some(SQRT_2))]);
    let remedy = &answer.measurement[0].remedy;
    assert!(remedy.contains("--amplitude rms"), "{remedy}");
    let causes: Vec<&str> = answer.causes.iter().map(|cause| cause.effect.as_str()).collect();
    assert_eq!(causes, ["transport_delay"]);
}

#[test]
fn a_row_that_stands_out_is_left_out_though_something_unknown_is_wrong_too() {
    // What no effect does: every third frequency has another third harmonic.
    let frequency = |experiment: &Experiment| {
        let mut all: Vec<f64> = exact().iter().map(|one| one.omega_rad_s).collect();
        all.sort_by(f64::total_cmp);
        all.dedup();
        all.iter().position(|omega| *omega == experiment.omega_rad_s).unwrap()
    };
    let unknown = |experiment: &Experiment, harmonic: &mut Harmonic| {
        let size = 2.5 * (1.3 * frequency(experiment) as f64).sin();
        if harmonic.order == 3 {
            harmonic.value += size * harmonic.std.unwrap();
        }
    };
    let whole = changed(19, |_, experiment, harmonic| unknown(experiment, harmonic));
    let alone = answer(&whole);
    assert_eq!((alone.verdict, alone.measurement.len()), (Verdict::Unexplained, 0));
    let measurement = changed(19, |index, experiment, harmonic| {
        unknown(experiment, harmonic);
        harmonic.value *= if (index, harmonic.order) == (5, 1) { 1.2 } else { 1.0 };
    });
    let answer = answer(&measurement);
    let [fault] = answer.measurement.as_slice() else { panic!("{:?}", answer.measurement) };
    let rows: Vec<_> = fault.left_out.iter().map(|row| (row.experiment, row.harmonic)).collect();
    assert_eq!((answer.verdict, rows), (Verdict::Unexplained, vec![(5, 1)]));
}

// A noise that is stated too large hides nothing, so that the model leaves no more than that without
// mending it.
#[test]
fn a_deviation_that_is_stated_too_large_is_named_beside_an_effect() {
    let measurement = changed(17, |_, experiment, harmonic| {
        turned(harmonic, -(experiment.omega_rad_s * 5e-3).to_degrees());
        harmonic.std = harmonic.std.map(|std| 2.0 * std);
    });
    let answer = answer(&measurement);
    let faults: Vec<FaultKind> = answer.measurement.iter().map(|fault| fault.fault).collect();
    assert_eq!(faults, [FaultKind::StdFactor]);
    assert_eq!(answer.causes[0].effect, "transport_delay", "{:?}", answer.causes);
}

#[test]
fn an_effect_behind_a_fault_is_still_named() {
    let late = |experiment: &Experiment, harmonic: &mut Harmonic| {
        turned(harmonic, -(experiment.omega_rad_s * 5e-3).to_degrees());
    };
    let measurement = changed(16, |index, experiment, harmonic| {
        late(experiment, harmonic);
        harmonic.value *= if (index, harmonic.order) == (5, 1) { 1.2 } else { 1.0 };
    });
    let answer = answer(&measurement);
    assert_eq!(answer.measurement[0].fault, FaultKind::BadRows);
    assert_eq!(answer.causes[0].effect, "transport_delay", "{:?}", answer.causes);
    assert_eq!(answer.verdict, Verdict::Explained);
}
