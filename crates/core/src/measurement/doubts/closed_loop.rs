//! The input varies from period to period more than the response, as where a controller makes it.

use super::finding::{Finding, per_cent};
use crate::measurement::{Complex, EXCITED_SHARE, Experiment, Loop, Measurement};

/// Least ratio of the relative scatter of the input to that of the response.
const LEAST_RATIO: f64 = 5.0;

pub(super) fn check(measurement: &Measurement) -> Option<Finding> {
    if measurement.metadata().feedback == Some(Loop::Closed) {
        return None;
    }
    let scatters = measurement.experiments().iter().filter_map(scatters);
    let [input, response] = scatters.reduce(|a, b| [a[0].max(b[0]), a[1].max(b[1])])?;
    (input > LEAST_RATIO * response).then(|| Finding {
        sentence: format!(
            "from period to period the input varies by {}, the response by {}: either a controller \
             generates the input (closed loop), or the input is measured with noise",
            per_cent(input),
            per_cent(response)
        ),
        remedy:
            "if the loop was closed, say so: `--loop closed`, the query parameter `loop`, or the \
                 line `# loop: closed`"
                .into(),
    })
}

/// Relative scatter of the input and of the response at the excited lines; `None` if the input has
/// none.
fn scatters(experiment: &Experiment) -> Option<[f64; 2]> {
    let lines = || experiment.input.iter().enumerate().skip(1);
    let largest = lines().map(|(_, u)| u.norm()).fold(0.0, f64::max);
    let excited: Vec<usize> = lines()
        .filter(|(_, u)| u.norm() > EXCITED_SHARE * largest)
        .map(|(order, _)| order)
        .collect();
    let share = |lines: Vec<Complex>, deviations: Vec<Complex>| {
        let sum = |values: &[Complex]| values.iter().map(Complex::norm_sqr).sum::<f64>();
        let count = experiment.repeats.len() as f64;
        (sum(&deviations) / (count * sum(&lines))).sqrt()
    };
    let repeats = || experiment.repeats.iter().filter(|repeat| !repeat.input.is_empty());
    let input = share(
        excited.iter().map(|k| experiment.input[*k]).collect(),
        repeats().flat_map(|repeat| excited.iter().map(|k| repeat.input[*k])).collect(),
    );
    let at: Vec<usize> = (0..experiment.response.len())
        .filter(|i| excited.contains(&experiment.response[*i].order))
        .collect();
    let response = share(
        at.iter().map(|i| experiment.response[*i].value).collect(),
        experiment
            .repeats
            .iter()
            .flat_map(|repeat| at.iter().map(|i| repeat.response[*i]))
            .collect(),
    );
    (input > 0.0 && response.is_finite()).then_some([input, response])
}
