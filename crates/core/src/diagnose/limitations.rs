//! Sentences on what a diagnosis cannot say.

use std::f64::consts::TAU;

use crate::answers::{Cause, Identification, Unanswered};
use crate::identify::FitSession;
use crate::measurement::{Measurement, after_number, per_cent};

use super::residuals::sentence::short;
use super::selection::models::Models;

/// Names the effects that could not be tried because there are too few data.
pub(super) fn undecided(session: &FitSession<'_>) -> Option<String> {
    let base = session.base();
    let library = session.library();
    let lacking: Vec<&str> = library
        .iter()
        .filter(|effect| !session.can_decide(base, **effect))
        .map(|effect| effect.id())
        .collect();
    let what = match lacking.len() {
        0 => return None,
        all if all == library.len() => "any effect of the library".to_owned(),
        _ => lacking.join(", "),
    };
    Some(format!(
        "{} numbers were measured, and the base model alone has {} parameters: too few data to \
         test {what}; measure more frequencies, magnitudes or harmonics",
        session.data(),
        base.parameters()
    ))
}

/// Names the effects that were fitted but have no finite criterion: the model has no response in
/// too many experiments, or one without derivatives.
pub(super) fn incomparable(models: &Models) -> Option<String> {
    let fitted = models.all().map(|(key, _)| key).filter(|key| key.len() == 1);
    let without: Vec<&str> =
        fitted.filter(|key| !models.criterion(key).is_finite()).map(|key| key[0]).collect();
    (!without.is_empty()).then(|| {
        format!(
            "{} could be fitted, but not compared with the others: its simulation does not settle \
             to a periodic motion, or changes abruptly with the parameters",
            without.join(", ")
        )
    })
}

/// Largest number of experiments that the sentence lists.
const MOST_PLACES: usize = 3;

/// Lists the experiments in which a model has no response.
pub(super) fn unanswered(answer: &Identification, input_unit: &str) -> Option<String> {
    let experiments = &answer.fit.unanswered;
    if experiments.is_empty() {
        return None;
    }
    let unit = after_number(input_unit);
    let at = |lost: &Unanswered| {
        let hertz = short(lost.omega_rad_s? / TAU);
        Some(format!("magnitude {}{unit} at {hertz} Hz", short(lost.magnitude?)))
    };
    let places: Vec<String> = experiments.iter().take(MOST_PLACES).filter_map(at).collect();
    let more = match experiments.len() - places.len() {
        0 => String::new(),
        more => format!(" and {more} more"),
    };
    Some(format!(
        "in {} of the experiments ({}{more}) the simulation does not settle to a periodic motion: \
         they are not part of the fit, and the model predicts nothing for them",
        experiments.len(),
        places.join(", "),
    ))
}

/// A delay is that of a held input if it differs from half a sampling interval by less than this,
/// relative: other effects that are named beside it move it a little.
const HALF_A_SAMPLE: f64 = 0.1;

/// Says that a delay of half a sampling interval may be that of an input that a converter holds.
pub(super) fn held_input(measurement: &Measurement, causes: &[Cause]) -> Option<String> {
    let delay = causes.iter().find(|cause| cause.effect == "transport_delay")?;
    let delay_s = delay.parameters.get("delay")?.value?;
    let mut steps = measurement
        .experiments()
        .iter()
        .filter_map(|experiment| Some(TAU / experiment.omega_rad_s / experiment.open_samples?));
    let is_half = |step_s: &f64| (delay_s / (0.5 * step_s) - 1.0).abs() < HALF_A_SAMPLE;
    let step_s = steps.find(is_half)?;
    Some(format!(
        "the delay is half the sampling interval of {:.4} ms: a converter that holds the input from \
         one sample to the next delays it by that; if it does, add the line `# intersample: hold`",
        1e3 * step_s
    ))
}

/// Says that the input may have been cut off, where its samples repeat the ends of its range.
pub(super) fn cut_off_input(measurement: &Measurement) -> Option<String> {
    let clipping = measurement.experiments().iter().filter_map(|one| one.clipping.as_deref());
    let share = clipping.map(|clipping| clipping.input_share).fold(0.0, f64::max);
    (share > 0.0).then(|| {
        format!(
            "{} of the samples of the input are its largest or smallest value: if its channel cuts off \
             what is larger, measure again with a larger range of this channel, or with a smaller input",
            per_cent(share)
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::answers::sample;
    use crate::diagnose::fixtures::{multisine_record, plant};
    use crate::measurement::Clipping;

    #[test]
    fn an_input_that_repeats_the_end_of_its_range_may_have_been_cut_off() {
        let record = multisine_record(plant(), &[], None, 1);
        assert_eq!(cut_off_input(&record), None);
        let mut experiments = record.experiments().to_vec();
        let cut = Clipping { filled: None, input_share: 0.44, range: None, response_share: 0.0 };
        experiments[0].clipping = Some(Box::new(cut));
        let cut =
            Measurement::new(record.metadata().clone(), experiments, Vec::new(), String::new());
        assert!(cut_off_input(&cut.unwrap()).unwrap().starts_with("44 % of the samples"));
    }

    // 512 samples in a period of 2π/2 s.
    #[test]
    fn a_delay_of_half_a_sample_may_be_that_of_a_held_input_where_nothing_is_stated() {
        let record = multisine_record(plant(), &[], None, 1);
        let said = |measurement: &Measurement, delay_s: f64| {
            let mut cause = sample::explained().causes.remove(0);
            let mut parameter = cause.parameters.values().next().unwrap().clone();
            parameter.value = Some(delay_s);
            cause.effect = "transport_delay".into();
            cause.parameters = [("delay".to_owned(), parameter)].into_iter().collect();
            held_input(measurement, &[cause])
        };
        let half_s = 0.5 * TAU / 2.0 / 512.0;
        assert!(said(&record, 1.05 * half_s).unwrap().contains("6.1359 ms"));
        assert_eq!(said(&record, 1.3 * half_s), None);
        let mut experiments = record.experiments().to_vec();
        experiments[0].open_samples = None;
        let stated =
            Measurement::new(record.metadata().clone(), experiments, Vec::new(), String::new());
        assert_eq!(said(&stated.unwrap(), half_s), None);
    }
}
