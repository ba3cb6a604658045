//! What a job would cost, estimated before it is accepted.
//!
//! The search of the base model simulates the whole measurement some thousand times, whatever it
//! finds; a diagnosis adds simulations with every effect, which follow the motion through every cell
//! of a period. So the cost is that of the measurement, times what the options say. The constants were
//! measured by the processor time of `identify` and `diagnose` with a given order (release build):
//! 48 cosines with harmonics up to 6 took 0.2 and 2.5 s; with one more harmonic of order 1000, 0.2 and
//! 4.1 s; of order 10 000, 0.5 s and more than 90 s; one record with 1114 lines of the input, 29 s to
//! diagnose. An estimate is good to within a factor of ten.
//!
//! A plan is chosen point by point and repeat by repeat, of points with many repeats several at a time.
//! A plan of 53 repeats took 3 s, one of 86 000 took 27 s.

use servoscope_core::answers::{IdentifyOptions, JobKind, PlanRequest};
use servoscope_core::measurement::{Experiment, Measurement};

use crate::store::MeasurementRow;

use super::{JobRequest, Service, ServiceError};

/// Simulations that refine a fit.
const REFINEMENTS: usize = 100;

/// Seconds of one simulation of a cosine with the base model, and more for each harmonic.
const COSINE_S: f64 = 2.5e-6;
const HARMONIC_S: f64 = 1.5e-8;

/// The same for each cell of a measured input.
const BASE_CELL_S: f64 = 1e-7;

/// Seconds that a diagnosis takes for an experiment, and more for each cell.
const EXPERIMENT_S: f64 = 0.05;
const CELL_S: f64 = 1e-3;

/// From so many cells on, the effort grows with their square: harmonics times cells.
const MANY_CELLS: f64 = 4000.0;

/// Cells of a period for each line of a measured input, and for each harmonic of the response.
const CELLS_PER_LINE: usize = 8;
const CELLS_PER_HARMONIC: usize = 2;

/// The share of a diagnosis that a second measurement costs: its models are only tried on it.
const SECOND_SHARE: f64 = 0.1;

/// Seconds of a plan, and more for each step of its choice.
const PLAN_S: f64 = 2.5;
const PLAN_STEP_S: f64 = 0.01;

/// Experiments of a plan.
const PLANNED: f64 = 12.0;

/// Repeats of an experiment that are added one at a time; beyond, each step multiplies them by this.
const SINGLE_REPEATS: f64 = 64.0;
const REPEATS_GROW: f64 = 1.0 + 1.0 / 32.0;

/// A repeat of a planned experiment, as a multiple of the time constant of the axis.
const REPEAT_TIME_CONSTANTS: f64 = 5.0;

/// What a measurement costs, seconds of one processor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Cost {
    /// One simulation with the base model.
    pub(super) simulation_s: f64,
    /// What a diagnosis takes beside the search of the base model.
    pub(super) diagnosis_s: f64,
}

impl Cost {
    /// What a measurement costs that was just read.
    pub(super) fn of(measurement: &Measurement) -> Self {
        let measurement = measurement.repeated();
        let experiments = measurement.experiments().iter().map(of_experiment);
        experiments.fold(Self { simulation_s: 0.0, diagnosis_s: 0.0 }, |sum, one| Self {
            simulation_s: sum.simulation_s + one.simulation_s,
            diagnosis_s: sum.diagnosis_s + one.diagnosis_s,
        })
    }

    /// What a stored measurement costs; of one that an earlier version stored, at most.
    fn of_row(row: &MeasurementRow) -> Self {
        if let (Some(simulation_s), Some(diagnosis_s)) = (row.simulation_s, row.diagnosis_s) {
            return Self { simulation_s, diagnosis_s };
        }
        let one = of_lines(usize::try_from(row.highest_harmonic).unwrap_or_default(), 0);
        let experiments = row.experiments as f64;
        Self {
            simulation_s: experiments * one.simulation_s,
            diagnosis_s: experiments * one.diagnosis_s,
        }
    }

    /// What a job on it would take, seconds of one processor.
    fn of_job(self, kind: JobKind, order_given: bool, options: &IdentifyOptions) -> f64 {
        let network = if options.network.enabled { options.network.training_plants } else { 0 };
        let evaluations = network + options.search_budget() + REFINEMENTS;
        let orders = if order_given { 1.0 } else { 3.0 };
        let search_s = orders * evaluations as f64 * self.simulation_s;
        match kind {
            JobKind::Identify => search_s,
            JobKind::Diagnose => search_s + self.diagnosis_s,
        }
    }
}

fn of_experiment(experiment: &Experiment) -> Cost {
    // A cosine has the line 1 alone, and perhaps a mean.
    let cosine = experiment.input.len() <= 2;
    of_lines(experiment.highest_harmonic(), if cosine { 0 } else { experiment.input.len() })
}

fn of_lines(highest: usize, input_lines: usize) -> Cost {
    let cells = (CELLS_PER_HARMONIC * highest).max(CELLS_PER_LINE * input_lines) as f64;
    let simulation_s = match input_lines {
        0 => COSINE_S + HARMONIC_S * highest as f64,
        _ => BASE_CELL_S * cells,
    };
    let diagnosis_s = EXPERIMENT_S + CELL_S * cells * (1.0 + cells / MANY_CELLS);
    Cost { simulation_s, diagnosis_s }
}

impl Service {
    /// What a job would cost, seconds of one processor.
    ///
    /// # Errors
    /// [`ServiceError::TooCostly`] where it is more than a job may; it says how much, and what to do.
    pub(super) fn cost(
        &self,
        measurement: &MeasurementRow,
        second: Option<&MeasurementRow>,
        request: &JobRequest,
    ) -> Result<f64, ServiceError> {
        let second_s = second.map_or(0.0, |second| SECOND_SHARE * Cost::of_row(second).diagnosis_s);
        let order_given = request.plant.is_some();
        let first_s = Cost::of_row(measurement).of_job(request.kind, order_given, &request.options);
        self.affordable(first_s + second_s, measurement)?;
        Ok(first_s + second_s)
    }

    /// Refuses to inspect a measurement that would take longer than a job may: it simulates every
    /// effect, as a diagnosis does.
    ///
    /// # Errors
    /// As [`Service::cost`].
    pub(super) fn check_inspection(
        &self,
        measurement: &MeasurementRow,
    ) -> Result<(), ServiceError> {
        self.affordable(Cost::of_row(measurement).diagnosis_s, measurement)
    }

    /// Refuses to try a result on a measurement that would take longer than a job may.
    ///
    /// # Errors
    /// As [`Service::cost`].
    pub(super) fn check_validation(
        &self,
        measurement: &MeasurementRow,
    ) -> Result<(), ServiceError> {
        self.affordable(SECOND_SHARE * Cost::of_row(measurement).diagnosis_s, measurement)
    }

    /// Refuses a plan that would take longer than a job may.
    ///
    /// # Errors
    /// As [`Service::cost`].
    pub(super) fn check_plan(&self, request: &PlanRequest) -> Result<(), ServiceError> {
        self.within_cost(of_plan(request), || {
            format!("give less than {} s for the experiments (`budget_s`)", request.budget_s)
        })
    }

    fn affordable(&self, seconds: f64, measurement: &MeasurementRow) -> Result<(), ServiceError> {
        let MeasurementRow { experiments, highest_harmonic, .. } = measurement;
        self.within_cost(seconds, || {
            format!(
                "the measurement has {experiments} experiments and harmonics up to \
                 {highest_harmonic}: upload it without harmonics of high order or with fewer \
                 experiments, ask for a smaller search (`options.evaluation_budget`)"
            )
        })
    }

    fn within_cost(&self, seconds: f64, less: impl Fn() -> String) -> Result<(), ServiceError> {
        let most_s = self.most_cost.as_secs_f64();
        if seconds <= most_s {
            return Ok(());
        }
        let (minutes, most_minutes) = (seconds / 60.0, most_s / 60.0);
        Err(ServiceError::TooCostly { minutes, most_minutes, less: less() })
    }
}

/// What a plan would take, seconds of one processor.
fn of_plan(request: &PlanRequest) -> f64 {
    let repeats = request.budget_s * request.axis.pole.abs() / REPEAT_TIME_CONSTANTS;
    // A budget that is no number is refused where it is planned with.
    let each = (repeats / PLANNED).max(0.0);
    let several = (each / SINGLE_REPEATS).max(1.0).ln() / REPEATS_GROW.ln();
    PLAN_S + PLAN_STEP_S * PLANNED * (each.min(SINGLE_REPEATS) + several)
}

#[cfg(test)]
mod tests {
    use servoscope_core::answers::{PlanOptions, RoughAxis};
    use servoscope_core::measurement::formats::{self, Source};

    use super::*;

    fn cost(table: &str) -> Cost {
        let text = format!("magnitude,omega_rad_s,harmonic,re,im\n{table}");
        let source = Source { name: "a.csv", bytes: text.as_bytes() };
        Cost::of(&formats::read(&[source]).unwrap())
    }

    fn seconds(cost: Cost, kind: JobKind) -> f64 {
        cost.of_job(kind, true, &IdentifyOptions::default())
    }

    // The bounds are those of a factor of ten beside what was measured.
    #[test]
    fn an_estimate_is_as_large_as_what_was_measured() {
        let within = |estimate: f64, measured: f64| {
            assert!((0.1..10.0).contains(&(estimate / measured)), "{estimate} s, not {measured} s");
        };
        let g1: String = (1..=48)
            .flat_map(|omega| (1..=6).map(move |k| format!("1,{omega},{k},1,0\n")))
            .collect();
        within(seconds(cost(&g1), JobKind::Identify), 0.2);
        within(seconds(cost(&g1), JobKind::Diagnose), 2.5);
        let high = format!("{g1}1,48,10000,1,0\n");
        within(seconds(cost(&high), JobKind::Identify), 0.5);
        within(seconds(cost(&high), JobKind::Diagnose), 90.0);
    }

    #[test]
    fn what_options_ask_for_is_paid_for() {
        let cost = cost("1,1,1,1,0\n");
        let mut options = IdentifyOptions::default();
        let usual = cost.of_job(JobKind::Identify, true, &options);
        options.evaluation_budget = Some(1_000_000);
        assert!(cost.of_job(JobKind::Identify, true, &options) > 100.0 * usual);
        assert!(cost.of_job(JobKind::Identify, false, &IdentifyOptions::default()) > 2.0 * usual);
    }

    #[test]
    fn a_motion_between_two_rests_costs_what_a_period_does() {
        let at =
            |n: i32| if (20..380).contains(&n) { (f64::from(n * n) * 1e-3).sin() } else { 0.0 };
        let rows: String = (0..400).map(|n| format!("{n},{},{}\n", at(n), at(n))).collect();
        let read = |period: &str| {
            let text = format!("# period_s: {period}\ntime_s,input,output\n{rows}");
            formats::read(&[Source { name: "a.csv", bytes: text.as_bytes() }]).unwrap()
        };
        let [motion, period] = ["none", "400"].map(read);
        assert_eq!((motion.transients().len(), period.experiments().len()), (1, 1));
        assert_eq!(Cost::of(&motion), Cost::of(&period));
        assert!(Cost::of(&motion).diagnosis_s > 0.0);
    }

    // As `servoscope plan --pole -10 --constant 10 --fc-plus 0.5 --budget-s …` took.
    #[test]
    fn a_plan_costs_more_the_longer_it_is_but_never_much_more() {
        let axis = RoughAxis {
            pole: -10.0,
            constant: 10.0,
            fc_plus: 0.5,
            fc_minus: 0.5,
            actuator_pole: None,
            natural_frequency: None,
            damping_ratio: None,
        };
        let of =
            |budget_s| of_plan(&PlanRequest { axis, budget_s, options: PlanOptions::default() });
        for (budget_s, measured) in [(80.0, 3.0), (100_000.0, 27.0)] {
            let ratio = of(budget_s) / measured;
            assert!((0.3..3.0).contains(&ratio), "{ratio}");
        }
        assert!(of(1e300) < 3600.0);
    }
}
