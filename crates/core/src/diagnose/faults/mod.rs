//! Faults of the measurement, as rivals of effects of the machine.
//!
//! A wrong row, a level with another gain, or a conjugated response makes a healthy axis look
//! wrong. Each such fault changes the data in a known way ([`candidates`]), so that it can be
//! estimated together with a model. A fault is found if it explains more than chance does
//! ([`family`]) and if a model with it has more evidence than every model without any fault, and
//! leaves only noise ([`suspects`]). The measurement is then mended ([`mending`]) and diagnosed
//! again.
//!
//! [`rounds`] mends and diagnoses again until nothing new is found.
//! [`readings`] tries other ways to read the whole file, and [`repeats`] compares repeats with each
//! other by their [`usual_scatter`]. [`one_level_out`] fits without one magnitude, which [`wrong_gain`]
//! does before anything else where a table is far from its noise, and [`trimmed`] without the rows
//! that fit worst. [`of_records`] tries the faults of records, and [`isolated`] finds rows that stand
//! out where nothing explains the measurement. Before faults are accepted, [`retest`] asks whether they
//! are still needed beside the effects that are named in the end, and [`row_regions`] whether rows that
//! were left out form regions, as what a model lacks does. Rows, levels and conventions ([`convention`])
//! are looked for in tables only. [`bad_samples`] and [`clipping`] take what was found as records were
//! read, [`one_run`] another gain or delay of one of them.

mod bad_samples;
mod beside;
mod candidates;
mod clipping;
mod convention;
mod course;
mod family;
mod fault;
mod isolated;
mod joint_fit;
mod mending;
mod noise_size;
pub(super) mod of_records;
mod one_level_out;
mod one_run;
mod power;
mod projection;
mod reached;
pub(super) mod readings;
mod repeats;
mod repeats_left_out;
mod retest;
mod rounds;
mod row_regions;
mod scan;
mod skew;
mod standing;
pub(super) mod suspects;
#[cfg(test)]
mod tests;
mod trimmed;
mod unmended;
mod usual_scatter;
pub(super) mod words;
pub(super) mod wrong_gain;

use crate::answers::{Diagnosis, MeasurementFault};
use crate::identify::IdentifyRequest;
use crate::measurement::Measurement;

use super::error::DiagnoseError;
use super::progress::Part;
use unmended::base_alone;

pub use mending::as_understood;

/// Diagnoses a measurement, and looks for faults of it unless the request keeps all of it. Faults that show
/// without a model are mended first, whatever explains the rest.
///
/// # Errors
/// See [`DiagnoseError`].
pub(super) fn diagnose(
    measurement: &Measurement,
    request: &IdentifyRequest,
    part: Part<'_>,
) -> Result<Diagnosis, DiagnoseError> {
    if request.options.keep_all {
        return rounds::undoubted(measurement, request, part);
    }
    let shown = repeats::odd_rows(measurement).into_iter().chain(bad_samples::fault(measurement));
    let mut faults: Vec<MeasurementFault> = shown.collect();
    if faults.is_empty() {
        return rounds::diagnose(measurement, request, &part);
    }
    let Ok(mended) = mending::mended(measurement, &faults) else {
        return rounds::diagnose(measurement, request, &part);
    };
    let answer = rounds::diagnose(&mended.measurement, request, &part)?;
    // What is known without the other faults is known of the mended measurement only.
    let as_measured = base_alone(measurement, retest::order(&answer), request, &part);
    for mut found in answer.measurement {
        renumber(&mut found, &mended.experiments);
        fault::add(&mut faults, found);
    }
    words::describe(&mut faults, measurement);
    Ok(Diagnosis { measurement: faults, as_measured, ..answer })
}

/// Replaces indices of experiments of a mended measurement by those before it was mended.
fn renumber(fault: &mut MeasurementFault, experiments: &[usize]) {
    let before = |index: &mut usize| *index = experiments.get(*index).copied().unwrap_or(*index);
    fault.experiment.iter_mut().for_each(before);
    fault.left_out.iter_mut().for_each(|row| before(&mut row.experiment));
}
