//! Figures of a job.

use std::sync::Arc;

use serde::Deserialize;

use crate::answers::{Cause, Comparison, ConvergenceRow, Discrepancy, Identification};
use crate::report::figures::{self, Extended, Subject, Theme};
use crate::report::with_causes;
use crate::store::{FileRow, JobRow};

use super::measurements::sources;
use super::{Numerics, Service, ServiceError};

/// A figure of a job.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Plot {
    /// The SVG document.
    pub svg: String,
    /// Whether the job has ended, so that the figure stays as it is.
    pub settled: bool,
}

/// What figures need of a result. Every kind of job has a base model; what else
/// a kind answers is left where it is.
#[derive(Debug, Clone, Deserialize)]
struct Answered {
    base: Identification,
    discrepancy: Option<Discrepancy>,
    #[serde(default)]
    causes: Vec<Cause>,
    extended: Option<Identification>,
}

/// A measurement beside what the models of a result make of it.
struct Compared {
    base: Result<Comparison, String>,
    /// `None` where there is no such model, or no comparison with it.
    extended: Option<Comparison>,
}

impl Service {
    /// Draws the figure of this name: of the result, or, where it shows nothing
    /// but convergence, of a job that still runs.
    ///
    /// # Errors
    /// [`ServiceError::NoPlot`] lists the figures there are where this is none;
    /// otherwise as [`Service::result`].
    pub async fn plot(&self, id: &str, name: &str, theme: Theme) -> Result<Plot, ServiceError> {
        let row = self.job(id).await?.row;
        if !figures::names().any(|known| known == name) {
            let available = figures::names().collect();
            return Err(no_plot(id, name, "there is no such figure", available));
        }
        let convergence = self.convergence(id).await?;
        let Some(result) = self.store.result(id).await? else {
            let subject = Subject { convergence: &convergence, ..Subject::default() };
            return match figures::draw(name, &subject, theme) {
                Ok(svg) => Ok(Plot { svg, settled: row.status.is_final() }),
                // The result says what has become of it.
                Err(_) => Err(self.result(id).await.err().unwrap_or_else(|| {
                    no_plot(id, name, "the job has just ended; ask again", Vec::new())
                })),
            };
        };
        let answered = answered(&row, &result)?;
        let files = self.store.measurement_files(&row.measurement_id).await?;
        let numerics = Arc::clone(&self.numerics);
        let (id, name) = (id.to_owned(), name.to_owned());
        let drawing = tokio::task::spawn_blocking(move || {
            let compared = compare(numerics.as_ref(), &files, &answered);
            drawn(&answered, &compared, &convergence, &name, theme)
                .map_err(|(reason, available)| no_plot(&id, &name, &reason, available))
        });
        match drawing.await {
            Ok(drawn) => Ok(Plot { svg: drawn?, settled: true }),
            Err(panicked) => std::panic::resume_unwind(panicked.into_panic()),
        }
    }
}

impl Answered {
    /// Nothing but a base model.
    fn of(base: Identification) -> Self {
        Self { base, discrepancy: None, causes: Vec::new(), extended: None }
    }
}

fn answered(row: &JobRow, result: &str) -> Result<Answered, ServiceError> {
    let answered = match row.kind.as_str() {
        "identify" => serde_json::from_str(result).map(Answered::of),
        _ => serde_json::from_str(result),
    };
    answered.map_err(|source| ServiceError::Corrupt { what: "result", source })
}

fn compare(numerics: &dyn Numerics, files: &[FileRow], answered: &Answered) -> Compared {
    let measurement = match numerics.read(&sources(files)) {
        Ok(measurement) => measurement,
        Err(error) => return Compared { base: Err(error.to_string()), extended: None },
    };
    let base = numerics.compare(&measurement, &answered.base).map_err(|error| error.to_string());
    let extended = answered.extended.as_ref();
    let extended = extended.and_then(|extended| numerics.compare(&measurement, extended).ok());
    Compared { base, extended }
}

/// The figure, or why there is none and which there are.
fn drawn(
    answered: &Answered,
    compared: &Compared,
    convergence: &[ConvergenceRow],
    name: &str,
    theme: Theme,
) -> Result<String, (String, Vec<&'static str>)> {
    let name_of_extended = with_causes(&answered.causes);
    let extended = compared.extended.as_ref();
    let subject = Subject {
        identification: Some(&answered.base),
        comparison: compared.base.as_ref().ok(),
        discrepancy: answered.discrepancy.as_ref(),
        extended: extended.map(|comparison| Extended { name: &name_of_extended, comparison }),
        convergence,
    };
    figures::draw(name, &subject, theme).map_err(|nothing| {
        let error = compared.base.as_ref().err();
        let cause = error.map(|error| format!(" ({error})")).unwrap_or_default();
        (format!("{nothing}{cause}"), figures::available(&subject))
    })
}

fn no_plot(id: &str, name: &str, reason: &str, available: Vec<&'static str>) -> ServiceError {
    let (id, name, reason) = (id.to_owned(), name.to_owned(), reason.to_owned());
    ServiceError::NoPlot { id, name, reason, available }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::sample;

    #[test]
    fn a_diagnosis_is_drawn_with_its_base_model_and_discrepancy() {
        let base = sample::identification();
        let result = serde_json::json!({
            "verdict": "unexplained", "base": base, "extended": null,
            "discrepancy": sample::discrepancy(),
        });
        let answered: Answered = serde_json::from_value(result).unwrap();
        let compared = Compared { base: Ok(sample::comparison()), extended: None };
        let svg = drawn(&answered, &compared, &[], "residuals", Theme::Auto).unwrap();
        assert!(svg.contains("It grows with the run."));
    }

    #[test]
    fn a_model_with_its_cause_is_drawn_beside_the_base_model() {
        let result = serde_json::to_value(sample::explained()).unwrap();
        let answered: Answered = serde_json::from_value(result).unwrap();
        let comparison = sample::comparison();
        let compared = Compared { base: Ok(comparison.clone()), extended: Some(comparison) };
        let svg = drawn(&answered, &compared, &[], "bode", Theme::Auto).unwrap();
        assert!(svg.contains("simulated with static_friction") && svg.contains("base model"));
    }

    #[test]
    fn a_figure_that_lacks_its_data_says_why_and_which_there_are() {
        let answered = Answered::of(sample::identification());
        let compared = Compared { base: Err("the files are gone".into()), extended: None };
        let (reason, available) =
            drawn(&answered, &compared, &[], "bode", Theme::Auto).unwrap_err();
        assert!(reason.contains("the files are gone"), "{reason}");
        assert_eq!(available, ["friction"]);
    }
}
