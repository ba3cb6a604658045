//! Plans keep within what is asked, are better than sweeps, and their excitations are read again.

use std::f64::consts::TAU;

use super::*;
use crate::answers::{PlannedExperiment, RoughAxis};
use crate::measurement::Measurement;
use crate::measurement::formats::{Source, read};
use crate::observer::Silent;

/// The first system of the paper: a = 10 1/s.
fn axis() -> RoughAxis {
    RoughAxis {
        pole: -10.0,
        constant: 10.0,
        fc_plus: 0.5,
        fc_minus: 0.4,
        actuator_pole: None,
        natural_frequency: None,
        damping_ratio: None,
    }
}

fn request(budget_s: f64) -> PlanRequest {
    PlanRequest::new(axis(), budget_s)
}

fn planned(request: &PlanRequest) -> Plan {
    plan(request, &Silent).unwrap()
}

fn refused(change: impl Fn(&mut PlanRequest)) -> String {
    let mut request = request(60.0);
    change(&mut request);
    plan(&request, &Silent).unwrap_err().to_string()
}

#[test]
fn look() {
    for budget in [20.0, 40.0, 60.0, 100.0] {
        let plan = planned(&request(budget));
        println!("budget {budget}: {:.2} s, score {:.3}, nameable {}", plan.duration_s, plan.score, plan.nameable);
        for s in &plan.sweeps {
            println!("  sweep {}x{} r{} {:.2} s score {:.3} nameable {}", s.magnitudes.len(), s.frequencies_rad_s.len(), s.repeats, s.duration_s, s.score, s.nameable);
        }
        for e in &plan.experiments {
            println!("   {} m {:.2} w {:.2} settle {} meas {} x{} {:.2}s {:?}", e.run, e.magnitude, e.omega_rad_s, e.settle_periods, e.measured_periods, e.repeats, e.duration_s, e.serves);
        }
        for e in &plan.effects {
            println!("   {:22} p {:.2} score {:.2} sweep3 {:.2} sweep1 {:.2} imit {:?} noticed {:?}", e.effect, e.probability, e.score, plan.sweeps.last().unwrap().probabilities[&e.effect], plan.sweeps[0].probabilities[&e.effect], e.closest_imitator, e.noticed_from.as_ref().map(|s| s.change));
        }
    }
}
