//! What a diagnosis says of its progress, and how soon it ends when it is no longer wanted.

use std::collections::BTreeSet;

use servoscope_bench::machines::draw::{Draw, NoiseStatement, measure};
use servoscope_bench::machines::simulator::Effect;
use servoscope_core::answers::Diagnosis;
use servoscope_core::diagnose::{DiagnoseError, diagnose};
use servoscope_core::identify::{IdentifyError, IdentifyRequest};
use servoscope_core::measurement::Measurement;

use crate::machines::Watcher;
use crate::reference::g_draw;

/// An axis that sticks harder than it slides, 60 dB above its noise.
fn sticky() -> Measurement {
    let effects = vec![Effect::new("static_friction", [("fs_plus", 0.8), ("fs_minus", 0.6)])];
    let (noise_db, noise_statement) = (Some(60.0), NoiseStatement::Std);
    let machine = Draw { effects, noise_db, noise_statement, ..g_draw(0) };
    measure(&machine, 1).expect("a periodic response")
}

fn watched(measurement: &Measurement, watcher: &Watcher) -> Result<Diagnosis, DiagnoseError> {
    diagnose(measurement, &IdentifyRequest::default(), watcher)
}

#[test]
fn a_diagnosis_reports_a_share_that_never_falls_and_asks_before_every_simulation() {
    let (measurement, watcher) = (sticky(), Watcher::patient());
    let answer = watched(&measurement, &watcher).unwrap();
    let seen = watcher.progress_seen();
    assert_eq!(seen[0].fraction, 0.0);
    assert_eq!(seen.last().unwrap().fraction, 1.0);
    for pair in seen.windows(2) {
        assert!(pair[0].fraction <= pair[1].fraction, "{pair:?}");
        assert!(pair[1].done <= pair[1].total, "{pair:?}");
    }
    // Those of the named model alone; each simulates every experiment.
    let model = answer.extended.expect("static friction is named");
    let simulations: u64 = model.stages.iter().map(|stage| stage.evaluations).sum();
    let experiments = measurement.experiments().len() as u64;
    assert!(watcher.questions() >= simulations * experiments, "{}", watcher.questions());
}

#[test]
fn a_cancelled_diagnosis_ends_at_any_stage_and_simulates_nothing_more() {
    let (measurement, patient) = (sticky(), Watcher::patient());
    watched(&measurement, &patient).unwrap();
    let questions = patient.questions();
    let mut stages = BTreeSet::new();
    for step in 0..12 {
        let patience = step * questions / 12 + 1;
        let watcher = Watcher::cancelling_after(patience);
        let answer = watched(&measurement, &watcher);
        assert_eq!(answer, Err(DiagnoseError::Identify(IdentifyError::Cancelled)));
        let last = watcher.progress_seen().last().expect("progress").clone();
        assert!(last.fraction < 1.0);
        let after = watcher.questions() - patience;
        println!("{after} after the answer was no at {last:?}");
        stages.insert(last.stage);
    }
    assert!(stages.len() >= 4, "cancelled at several stages: {stages:?}");
}
