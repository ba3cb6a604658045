//! Drawn machines: what they truly are, what is asked, and how answers compare.

use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};

use servoscope_core::answers::{
    ConvergenceRow, Identification, IdentifyOptions, ParameterEstimate, PlantRequest, Progress,
};
use servoscope_core::identify::{IdentifyError, IdentifyRequest, identify};
use servoscope_core::measurement::{Experiment, Measurement, Metadata};
use servoscope_core::observer::{Observer, Silent};
use servoscope_core::plant::{Actuator, Plant};

/// Parameters of a machine by the name they are reported under.
pub fn truth(plant: &Plant) -> Vec<(&'static str, f64)> {
    let (a, k) = (plant.viscous_rate_rad_s, plant.constant);
    let mut truth = vec![
        ("pole", -a),
        ("constant", k),
        ("dc_gain", k / a),
        ("fc_plus", plant.friction.fc_plus),
        ("fc_minus", plant.friction.fc_minus),
    ];
    match plant.actuator {
        Actuator::Direct => {}
        Actuator::FirstOrder { corner_rad_s } => truth.push(("actuator_pole", -corner_rad_s)),
        Actuator::SecondOrder { natural_frequency_rad_s, damping_ratio } => {
            truth.push(("natural_frequency", natural_frequency_rad_s));
            truth.push(("damping_ratio", damping_ratio));
        }
    }
    truth
}

/// Identifies with the actuator's order given, or left to the data.
pub fn ask(
    measurement: &Measurement,
    order: Option<u8>,
    options: IdentifyOptions,
) -> Result<Identification, IdentifyError> {
    ask_watched(measurement, order, options, &Silent)
}

/// The same, watched.
pub fn ask_watched(
    measurement: &Measurement,
    order: Option<u8>,
    options: IdentifyOptions,
    observer: &dyn Observer,
) -> Result<Identification, IdentifyError> {
    let plant = order.map(|actuator_order| PlantRequest { actuator_order });
    identify(measurement, &IdentifyRequest { plant, options, ..Default::default() }, observer)
}

/// An estimate that must be there.
pub fn estimate<'a>(answer: &'a Identification, name: &str) -> &'a ParameterEstimate {
    answer.parameters.get(name).unwrap_or_else(|| panic!("no {name}"))
}

/// Value of an estimate that must be there.
pub fn value(answer: &Identification, name: &str) -> f64 {
    estimate(answer, name).value.unwrap_or_else(|| panic!("{name} has no value"))
}

/// Relative errors of the reported parameters, by name.
pub fn relative_errors(answer: &Identification, plant: &Plant) -> Vec<(&'static str, f64)> {
    let error = |(name, true_value): (&'static str, f64)| {
        (name, (value(answer, name) / true_value - 1.0).abs())
    };
    truth(plant).into_iter().map(error).collect()
}

/// Largest of them.
pub fn largest_error(answer: &Identification, plant: &Plant) -> f64 {
    relative_errors(answer, plant).into_iter().map(|(_, error)| error).fold(0.0, f64::max)
}

/// Median; the mean of the middle two of an even number.
pub fn median(values: &[f64]) -> f64 {
    assert!(!values.is_empty(), "the median of nothing");
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    0.5 * (sorted[(sorted.len() - 1) / 2] + sorted[sorted.len() / 2])
}

/// A measurement with changed metadata and experiments.
pub fn changed(
    measurement: &Measurement,
    metadata: impl FnOnce(&mut Metadata),
    experiments: impl FnOnce(&mut Vec<Experiment>),
) -> Measurement {
    let mut new_metadata = measurement.metadata().clone();
    let mut new_experiments = measurement.experiments().to_vec();
    metadata(&mut new_metadata);
    experiments(&mut new_experiments);
    Measurement::new(new_metadata, new_experiments, vec![], String::new()).expect("valid")
}

/// Keeps rows and progress, and cancels after so many questions whether it should.
pub struct Watcher {
    patience: u64,
    questions: AtomicU64,
    rows: Mutex<Vec<ConvergenceRow>>,
    progress: Mutex<Vec<Progress>>,
}

impl Watcher {
    /// Cancels at the question after `patience` ones.
    pub fn cancelling_after(patience: u64) -> Self {
        let (rows, progress) = Default::default();
        Self { patience, questions: AtomicU64::new(0), rows, progress }
    }

    /// Never cancels.
    pub fn patient() -> Self {
        Self::cancelling_after(u64::MAX)
    }

    /// How often it was asked.
    pub fn questions(&self) -> u64 {
        self.questions.load(Ordering::Relaxed)
    }

    /// Rows so far.
    pub fn rows(&self) -> Vec<ConvergenceRow> {
        self.rows.lock().unwrap().clone()
    }

    /// Progress so far.
    pub fn progress_seen(&self) -> Vec<Progress> {
        self.progress.lock().unwrap().clone()
    }
}

impl Observer for Watcher {
    fn progress(&self, progress: Progress) {
        self.progress.lock().unwrap().push(progress);
    }

    fn row(&self, row: ConvergenceRow) {
        self.rows.lock().unwrap().push(row);
    }

    fn cancelled(&self) -> bool {
        self.questions.fetch_add(1, Ordering::Relaxed) >= self.patience
    }
}
