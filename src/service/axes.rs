//! What came of measurements, over the time of measuring.

mod rows;

use servoscope_core::answers::{HistoryRow, ResultRow};

use crate::report::figures::{self, Estimated, Format, Trend};
use crate::store::{AxisRow, MeasurementRow, Millis, ResultFilter};

use super::{Listed, Service, ServiceError};
use rows::{compared, parameters, result_row};

/// Most results that are read for one answer: each is a document of its own.
const MOST_RESULTS: u32 = 500;

/// Results before one that it is compared with when it is new: each of its parameters with the
/// latest of these that has it.
const LOOK_BACK: u32 = 20;

/// Most axes that are listed.
const MOST_AXES: u32 = 1000;

/// Which parameters of an axis are asked for.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct HistoryQuery {
    /// The machine.
    pub machine: String,
    /// The axis.
    pub axis: String,
    /// The only parameter wanted; `None`: every one.
    pub parameter: Option<String>,
    /// Whether the values wanted changed; `None`: every one.
    pub changed: Option<bool>,
    /// Measured at this time or later.
    pub from_ms: Option<Millis>,
    /// Measured before this time.
    pub to_ms: Option<Millis>,
}

impl Service {
    /// What came of jobs, latest measured first.
    ///
    /// # Errors
    /// [`ServiceError::Corrupt`] where this version cannot read a result.
    pub async fn results(&self, filter: &ResultFilter) -> Result<Vec<ResultRow>, ServiceError> {
        let stored = self.store.results(&self.reach, filter, MOST_RESULTS).await?;
        stored.into_iter().map(result_row).collect()
    }

    /// Axes that measurements name; of one machine, or of every one.
    ///
    /// # Errors
    /// When the database does not answer.
    pub async fn axes(&self, machine: Option<&str>) -> Result<Listed<AxisRow>, ServiceError> {
        Ok(Listed { items: self.store.axes(&self.reach, machine, MOST_AXES).await?, next: None })
    }

    /// Parameters of an axis by the time of measuring: of each measurement the
    /// result that was asked for last, of its best model.
    ///
    /// # Errors
    /// As [`Service::results`].
    pub async fn axis_history(
        &self,
        query: &HistoryQuery,
    ) -> Result<Vec<HistoryRow>, ServiceError> {
        let filter = ResultFilter {
            machine: Some(query.machine.clone()),
            axis: Some(query.axis.clone()),
            to_ms: query.to_ms,
            latest_only: true,
            ..ResultFilter::default()
        };
        let stored = self.store.results(&self.reach, &filter, MOST_RESULTS).await?;
        let mut rows = Vec::new();
        for stored in stored.into_iter().rev() {
            rows.extend(parameters(stored, query.parameter.as_deref())?);
        }
        compared(&mut rows);
        // After comparing: the first row shown may have changed, too.
        let wanted = |(at, row): &(Millis, HistoryRow)| {
            query.from_ms.is_none_or(|from| *at >= from)
                && query.changed.is_none_or(|changed| row.changed == changed)
        };
        Ok(rows.into_iter().filter(wanted).map(|(_, row)| row).collect())
    }

    /// Parameters that a job found changed: as [`Service::axis_history`] marks them, but that
    /// only the 20 measurements before are looked at. There are none where a later job on the
    /// same measurement has a result.
    ///
    /// # Errors
    /// As [`Service::results`].
    pub(super) async fn axis_changes(
        &self,
        measurement: &MeasurementRow,
        job_id: &str,
    ) -> Result<Vec<HistoryRow>, ServiceError> {
        let measured_at = measurement.measured_at.as_deref().map(str::parse::<jiff::Timestamp>);
        let at_ms = match measured_at {
            Some(Ok(time)) => time.as_millisecond(),
            _ => measurement.created_at_ms,
        };
        let filter = ResultFilter {
            machine: measurement.machine.clone(),
            axis: measurement.axis.clone(),
            // The database rounds to a millisecond.
            to_ms: Some(at_ms + 2),
            latest_only: true,
            ..ResultFilter::default()
        };
        let stored = self.store.results(&self.reach, &filter, LOOK_BACK + 1).await?;
        let mut rows = Vec::new();
        for stored in stored.into_iter().rev() {
            rows.extend(parameters(stored, None)?);
        }
        compared(&mut rows);
        let rows = rows.into_iter().map(|(_, row)| row);
        Ok(rows.filter(|row| row.changed && row.job_id == job_id).collect())
    }

    /// The same as a figure.
    ///
    /// # Errors
    /// [`ServiceError::Unknown`] where nothing is known of the axis at that time.
    pub async fn axis_figure(
        &self,
        query: &HistoryQuery,
        format: Format,
    ) -> Result<String, ServiceError> {
        let mut trends: Vec<Trend> = Vec::new();
        for row in self.axis_history(query).await? {
            let point = Estimated {
                at_s: seconds(&row.at),
                value: row.value,
                interval95: row.low95.zip(row.high95).map(|(low, high)| [low, high]),
                changed: row.changed,
            };
            match trends.iter_mut().find(|trend| trend.name == row.name) {
                Some(trend) => trend.points.push(point),
                None => trends.push(Trend { name: row.name, unit: row.unit, points: vec![point] }),
            }
        }
        let title = format!("{}, {}", query.machine, query.axis);
        figures::draw_history(&title, &trends, format)
            .map_err(|_| ServiceError::Unknown { what: "result of the axis", id: title })
    }
}

fn seconds(rfc3339: &str) -> f64 {
    rfc3339.parse::<jiff::Timestamp>().map_or(0.0, |time| time.as_millisecond() as f64 / 1000.0)
}
