//! The page of a job: its answer and what was measured, as one document.

use std::sync::Arc;

use servoscope_core::measurement::formats::Source;
use servoscope_core::measurement::{Experiment, Loop, Measurement, ResponseKind};
use sha2::{Digest, Sha256};

use crate::report::page::{Content, DataFile, Measured, page};

use super::descriptions::described;
use super::measurements::{hexadecimal, sources};
use super::{Compared, Service, ServiceError};

/// Magnitudes and frequencies that differ by less than this share are the same:
/// those of a record are measured.
const SAME: f64 = 1e-3;

impl Service {
    /// Writes the page of a job that has a result. Where its files cannot be read
    /// or compared any more, the page is without the figures that need them.
    ///
    /// # Errors
    /// As [`Service::result`].
    pub async fn report(&self, id: &str) -> Result<String, ServiceError> {
        let answer = self.answer(id).await?;
        let row = self.job(id).await?.row;
        let convergence = self.convergence(id).await?;
        let stored = self.measurement(&row.measurement_id).await?;
        let (place, files) = self.place_with_files(&row.measurement_id).await?;
        let numerics = Arc::clone(&self.numerics);
        let writing = place.compute(move || {
            let sources = sources(&files);
            let measurement =
                numerics.read(&sources).map(|measurement| described(measurement, &stored));
            let measured = measured(measurement.as_ref().ok(), &sources);
            let measurement = measurement.as_ref().map_err(ToString::to_string);
            let compared = Compared::of(numerics.as_ref(), measurement, &answer);
            page(&Content {
                answer: &answer,
                measured: &measured,
                comparison: compared.base.as_ref().ok(),
                extended: compared.extended.as_ref(),
                convergence: &convergence,
            })
        });
        Ok(writing.await)
    }
}

/// What a page says of a measurement and its files; of the files alone where
/// they could not be read.
pub fn measured(measurement: Option<&Measurement>, sources: &[Source<'_>]) -> Measured {
    let files = sources.iter().map(|source| DataFile {
        name: without_folder(source.name),
        bytes: source.bytes.len(),
        sha256: hexadecimal(&Sha256::digest(source.bytes)),
    });
    let files = files.collect();
    let Some(measurement) = measurement else {
        return Measured { files, ..Measured::default() };
    };
    let measurement = measurement.repeated();
    let metadata = measurement.metadata();
    let experiments = measurement.experiments();
    let orders = || experiments.iter().flat_map(|e| e.response.iter().map(|h| h.order));
    let repeats = || experiments.iter().map(|e| e.repeats.len());
    let kind = match metadata.response_kind {
        ResponseKind::Velocity => "velocity",
        ResponseKind::Position => "position",
        ResponseKind::Acceleration => "acceleration",
    };
    let response = match metadata.response.name.as_str() {
        "" => kind.to_owned(),
        name => name.to_owned(),
    };
    Measured {
        name: metadata.name.clone(),
        machine: metadata.machine.clone(),
        axis: metadata.axis.clone(),
        measured_at: metadata.measured_at.map(|time| time.to_string()),
        operator: metadata.operator.clone(),
        labels: metadata.labels.clone().into_iter().collect(),
        input: metadata.input.name.clone(),
        input_unit: metadata.input.unit.clone(),
        response,
        response_unit: metadata.response.unit.clone(),
        closed_loop: metadata.feedback.map(|feedback| feedback == Loop::Closed),
        experiments: experiments.len(),
        magnitudes: different(experiments, |experiment| experiment.magnitude),
        omegas_rad_s: different(experiments, |experiment| experiment.omega_rad_s),
        harmonics: [orders().min().unwrap_or_default(), orders().max().unwrap_or_default()],
        repeats: [repeats().min().unwrap_or_default(), repeats().max().unwrap_or_default()],
        from_records: experiments.iter().any(|experiment| experiment.from_record),
        runs_known: experiments.iter().all(|experiment| experiment.run.is_some()),
        files,
        notes: measurement.notes().to_vec(),
    }
}

/// The name of a file alone: where it lies is nobody's business but its owner's.
fn without_folder(name: &str) -> String {
    let last = std::path::Path::new(name).file_name().and_then(|last| last.to_str());
    last.unwrap_or(name).to_owned()
}

/// Values of all experiments, ascending, none twice.
fn different(experiments: &[Experiment], value: fn(&Experiment) -> f64) -> Vec<f64> {
    let mut values: Vec<f64> = experiments.iter().map(value).collect();
    values.sort_by(f64::total_cmp);
    values.dedup_by(|next, kept| *next - *kept <= SAME * kept.abs());
    values
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::service::Numerics;
    use crate::service::testing::Scripted;

    #[test]
    fn a_page_says_of_a_measurement_what_it_says_of_itself() {
        let source = [Source { name: "a.csv", bytes: b"any" }];
        let measurement = Scripted.read(&source).unwrap();
        let measured = measured(Some(&measurement), &source);
        assert_eq!(measured.machine.as_deref(), Some("press 4"));
        assert_eq!((measured.magnitudes, measured.omegas_rad_s), (vec![1.0, 3.0], vec![2.0, 20.0]));
        assert_eq!((measured.experiments, measured.harmonics), (2, [1, 1]));
        assert_eq!((measured.response.as_str(), measured.runs_known), ("velocity", false));
        // As `sha256sum` computes it.
        let digest = "d6a7cd2a7371b1a15d543196979ff74fdb027023ebf187d5d329be11055c77fd";
        assert_eq!(measured.files[0].sha256, digest);
        assert_eq!((measured.files[0].name.as_str(), measured.files[0].bytes), ("a.csv", 3));
    }

    #[test]
    fn values_that_differ_by_measurement_alone_are_one() {
        let source = [Source { name: "a.csv", bytes: b"any" }];
        let measurement = Scripted.read(&source).unwrap();
        let mut experiments = measurement.experiments().to_vec();
        experiments[1].magnitude = 1.0 + 0.5 * SAME;
        assert_eq!(different(&experiments, |experiment| experiment.magnitude), [1.0]);
    }

    #[test]
    fn a_page_does_not_tell_where_a_file_lies() {
        assert_eq!(["/home/me/a.csv", "a.csv", ""].map(without_folder), ["a.csv", "a.csv", ""]);
    }

    #[test]
    fn of_files_that_cannot_be_read_a_page_has_the_names() {
        let measured = measured(None, &[Source { name: "a.csv", bytes: b"bad" }]);
        assert_eq!((measured.files.len(), measured.experiments), (1, 0));
    }
}
