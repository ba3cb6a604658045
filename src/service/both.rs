//! The figure of two jobs.

use std::sync::Arc;

use servoscope_core::answers::Answer;

use crate::report::figures::{self, Format};
use crate::store::FileRow;

use super::measurements::sources;
use super::plots::no_plot;
use super::{Compared, Plot, Service, ServiceError};

/// What the name of the figure begins with; the id of the other job follows.
pub(super) const AGAINST: &str = "bode-against-";

impl Service {
    /// Draws the frequency responses of a job, on the left, and of another in one diagram.
    ///
    /// # Errors
    /// [`ServiceError::NoPlot`] where the two cannot be compared; otherwise as [`Service::result`],
    /// for either job.
    pub(super) async fn plot_against(
        &self,
        id: &str,
        other: &str,
        format: Format,
    ) -> Result<Plot, ServiceError> {
        let answers = [self.answer(id).await?, self.answer(other).await?];
        let [left, right] = [self.job(id).await?.row, self.job(other).await?.row];
        let place = self.place().await?;
        let files = [
            self.files_of(&left.measurement_id).await?,
            self.files_of(&right.measurement_id).await?,
        ];
        let numerics = Arc::clone(&self.numerics);
        let (id, name) = (id.to_owned(), format!("{AGAINST}{other}"));
        let drawing = place.compute(move || {
            let compared = |files: &[FileRow], answer: &Answer| {
                let measurement = numerics.read(&sources(files)).map_err(|error| error.to_string());
                Compared::of(numerics.as_ref(), measurement.as_ref().map_err(Clone::clone), answer)
            };
            let [left, right] = [0, 1].map(|side| compared(&files[side], &answers[side]));
            let left = left.subject(&answers[0], &[]);
            figures::draw_both([&left, &right.subject(&answers[1], &[])], format).map_err(
                |nothing| no_plot(&id, &name, &nothing.to_string(), figures::available(&left)),
            )
        });
        Ok(Plot { svg: drawing.await?, settled: true })
    }
}
