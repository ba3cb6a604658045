//! Hand-made draws and answers for the tests.

use indexmap::IndexMap;
use servoscope_core::answers::sample;
use servoscope_core::answers::{
    Cause, Diagnosis, FaultKind, LeftOutRow, MeasurementFault, Verdict,
};

use super::build_case::{Hidden, Made};
use super::case::Case;
use super::dominance::Dominance;
use super::instrument::Instrument;
use super::judge::{Outcome, Seconds};
use super::mismeasurement::{Mismeasurement, Mistake, Sort};
use crate::machines::draw::{draw, measure};
use crate::machines::noise::NoiseLaw;

pub(super) fn cause(effect: &str, confidence: f64, equivalents: &[&str]) -> Cause {
    Cause {
        effect: effect.to_owned(),
        parameters: IndexMap::new(),
        confidence,
        explanation: String::new(),
        gain: None,
        margin: None,
        equivalents: equivalents.iter().map(|id| (*id).to_owned()).collect(),
    }
}

/// An answer without causes.
pub(super) fn diagnosis(verdict: Verdict) -> Diagnosis {
    Diagnosis { verdict, ..sample::diagnosis() }
}

/// The draw of this case with hidden effects whose amplitude, cycles per unit and phase are all 1.
pub(super) fn made(case: &Case, hidden: &[&'static str]) -> Made {
    let mut machine = draw(0, 1);
    machine.design.truncate(1);
    let parameters = ["amplitude", "cycles_per_unit", "phase"].map(|name| (name, 1.0));
    let with_parameters = |effect: &&'static str| Hidden {
        effect,
        parameters: IndexMap::from(parameters),
        excess: 1_000.0,
        small: false,
    };
    Made {
        hidden: hidden.iter().map(with_parameters).collect(),
        excess: 1_000.0,
        dominance: None,
        plant: IndexMap::from([("pole", -10.0)]),
        measurement: measure(&machine, 1).expect("a machine that moves"),
        records: Vec::new(),
        mistake: None,
        instrument: Instrument::of(case, &mut case.rng(1)),
        noise: NoiseLaw::uniform(0.1),
        machine,
        attempts: 1,
    }
}

/// The outcome of the draw with this key if these causes are named.
pub(super) fn outcome(
    key: &str,
    hidden: &[&'static str],
    causes: &[(&str, f64, &[&str])],
    verdict: Verdict,
) -> Outcome {
    let case: Case = key.parse().expect("a key");
    let mut answer = diagnosis(verdict);
    answer.causes = causes.iter().map(|(id, p, equivalents)| cause(id, *p, equivalents)).collect();
    Outcome::new(&case, &made(&case, hidden), Ok(&answer), Seconds { data: 0.5, job: 2.0 })
}

/// As [`outcome`], of a machine of which only the first effects, this many, dominate.
pub(super) fn machine(
    key: &str,
    dominant: usize,
    hidden: &[&'static str],
    causes: &[(&str, f64, &[&str])],
) -> Outcome {
    let mut outcome = outcome(key, hidden, causes, Verdict::Improved);
    outcome.hidden[dominant..].iter_mut().for_each(|hidden| hidden.small = true);
    let alone = vec![100.0; dominant];
    outcome.dominance = Some(Dominance { base: 1_000.0, alone, left: 50.0, chi2_per_dof: 2.5 });
    outcome
}

/// A fault that shows, in a measurement of one experiment.
pub(super) fn mistake(sort: Sort, fault: Mismeasurement) -> Mistake {
    let sound = made(&"clean-60-o0-0".parse().expect("a key"), &[]).measurement;
    Mistake { sort, fault, shows: true, sound }
}

/// Bad rows that are named: experiment and harmonic of each.
pub(super) fn left_out(rows: &[(usize, usize)]) -> MeasurementFault {
    let row = |&(experiment, harmonic): &(usize, usize)| LeftOutRow {
        experiment,
        harmonic,
        repeat: None,
        line: None,
        off: 0.2,
        sigmas: 9.0,
    };
    MeasurementFault {
        left_out: rows.iter().map(row).collect(),
        ..MeasurementFault::of(FaultKind::BadRows)
    }
}
