//! Figures of a job.

use std::sync::Arc;

use servoscope_core::answers::{Answer, ConvergenceRow};

use crate::report::figures::{self, Format, Subject};

use super::both::AGAINST;
use super::jobs::answer;
use super::measurements::sources;
use super::{Compared, Service, ServiceError};

/// A figure of a job.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Plot {
    /// The SVG document.
    pub svg: String,
    /// Whether the job has ended, so that the figure stays as it is.
    pub settled: bool,
}

impl Service {
    /// Draws the figure of this name: of the result, or, where it shows nothing
    /// but convergence, of a job that still runs. `bode-against-` with the id of another job behind
    /// it is the figure of both.
    ///
    /// # Errors
    /// [`ServiceError::NoPlot`] lists the figures there are where this is none;
    /// otherwise as [`Service::result`].
    pub async fn plot(&self, id: &str, name: &str, format: Format) -> Result<Plot, ServiceError> {
        if let Some(other) = name.strip_prefix(AGAINST) {
            return self.plot_against(id, other, format).await;
        }
        let row = self.job(id).await?.row;
        if !figures::names().any(|known| known == name) {
            let available = figures::names().collect();
            return Err(no_plot(id, name, "there is no such figure", available));
        }
        let convergence = self.convergence(id).await?;
        let Some(result) = self.store.result(&self.reach, id).await? else {
            let subject = Subject { convergence: &convergence, ..Subject::default() };
            return match figures::draw(name, &subject, format) {
                Ok(svg) => Ok(Plot { svg, settled: row.status.is_final() }),
                // The result says what has become of it.
                Err(_) => Err(self.result(id).await.err().unwrap_or_else(|| {
                    no_plot(id, name, "the job has just ended; ask again", Vec::new())
                })),
            };
        };
        let answer = answer(&result)?;
        let (place, files) = self.place_with_files(&row.measurement_id).await?;
        let numerics = Arc::clone(&self.numerics);
        let (id, name) = (id.to_owned(), name.to_owned());
        let drawing = place.compute(move || {
            let measurement = numerics.read(&sources(&files)).map_err(|error| error.to_string());
            let compared = Compared::of(
                numerics.as_ref(),
                measurement.as_ref().map_err(Clone::clone),
                &answer,
            );
            drawn(&answer, &compared, &convergence, &name, format)
                .map_err(|(reason, available)| no_plot(&id, &name, &reason, available))
        });
        Ok(Plot { svg: drawing.await?, settled: true })
    }
}

/// The figure, or why there is none and which there are.
fn drawn(
    answer: &Answer,
    compared: &Compared,
    convergence: &[ConvergenceRow],
    name: &str,
    format: Format,
) -> Result<String, (String, Vec<&'static str>)> {
    let subject = compared.subject(answer, convergence);
    figures::draw(name, &subject, format).map_err(|nothing| {
        let error = compared.base.as_ref().err();
        let cause = error.map(|error| format!(" ({error})")).unwrap_or_default();
        (format!("{nothing}{cause}"), figures::available(&subject))
    })
}

pub(super) fn no_plot(
    id: &str,
    name: &str,
    reason: &str,
    available: Vec<&'static str>,
) -> ServiceError {
    let (id, name, reason) = (id.to_owned(), name.to_owned(), reason.to_owned());
    ServiceError::NoPlot { id, name, reason, available }
}

#[cfg(test)]
mod tests {
    use servoscope_core::answers::Diagnosis;
    use servoscope_core::answers::sample;

    use super::*;

    use servoscope_core::measurement::formats::Source;

    use crate::service::Numerics;
    use crate::service::testing::Scripted;

    fn compared(answer: &Answer) -> Compared {
        let measurement = Scripted.read(&[Source { name: "a.csv", bytes: b"any" }]).unwrap();
        Compared::of(&Scripted, Ok(&measurement), answer)
    }

    #[test]
    fn a_diagnosis_is_drawn_with_its_base_model_and_discrepancy() {
        let discrepancy = sample::discrepancy();
        let answer = Diagnosis { discrepancy, ..sample::diagnosis() }.into();
        let svg = drawn(&answer, &compared(&answer), &[], "residuals", Format::default()).unwrap();
        assert!(svg.contains("It grows with the run."));
    }

    #[test]
    fn a_model_with_its_cause_is_drawn_beside_the_base_model() {
        let answer = sample::explained().into();
        let svg = drawn(&answer, &compared(&answer), &[], "bode", Format::default()).unwrap();
        assert!(svg.contains("simulated with static friction") && svg.contains("base model"));
    }

    #[test]
    fn a_figure_that_lacks_its_data_says_why_and_which_there_are() {
        let answer = sample::identification().into();
        let compared = Compared::of(&Scripted, Err("the files are gone".into()), &answer);
        let (reason, available) =
            drawn(&answer, &compared, &[], "bode", Format::default()).unwrap_err();
        assert!(reason.contains("the files are gone"), "{reason}");
        assert_eq!(available, ["friction"]);
    }
}
