//! What came of measurements, over the time of measuring.

use std::collections::HashMap;

use servoscope_core::answers::{Answer, Diagnosis, HistoryRow, JobKind, ResultRow};

use crate::report::figures::{self, Estimated, Format, Trend};
use crate::report::page::parameter_name;
use crate::store::{AxisRow, MeasurementRow, Millis, ResultFilter, StoredResult};

use super::jobs::answer;
use super::{Listed, Service, ServiceError};

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

fn result_row(stored: StoredResult) -> Result<ResultRow, ServiceError> {
    let answer = answer(&stored.result)?;
    let gain = answer.diagnosis().and_then(|diagnosis| diagnosis.gain.as_ref());
    let fit = &answer.model().fit;
    Ok(ResultRow {
        at: rfc3339(stored.at_ms),
        job_id: stored.job_id,
        measurement_id: stored.measurement_id,
        name: stored.name,
        machine: stored.machine,
        axis: stored.axis,
        kind: answer.diagnosis().map_or(JobKind::Identify, |_| JobKind::Diagnose),
        verdict: answer.verdict(),
        causes: causes(&answer),
        confidence: answer.causes().first().map(|cause| cause.confidence),
        ratio: gain.map(|gain| gain.ratio),
        ratio_low95: gain.map(|gain| gain.interval95[0]),
        ratio_high95: gain.map(|gain| gain.interval95[1]),
        base_nrmse: answer.base().fit.nrmse,
        nrmse: fit.nrmse,
        chi2_per_dof: fit.chi2_per_dof,
        adequate: fit.adequate,
        tested: answer.diagnosis().map(Diagnosis::is_tested),
    })
}

fn parameters(
    stored: StoredResult,
    wanted: Option<&str>,
) -> Result<Vec<(Millis, HistoryRow)>, ServiceError> {
    let answer = answer(&stored.result)?;
    let row = |(name, estimate): (&String, &servoscope_core::answers::ParameterEstimate)| {
        let row = HistoryRow {
            at: rfc3339(stored.at_ms),
            parameter: name.clone(),
            name: parameter_name(name),
            value: estimate.value?,
            std: estimate.std,
            low95: estimate.interval95.map(|[low, _]| low),
            high95: estimate.interval95.map(|[_, high]| high),
            unit: estimate.unit.clone(),
            change: None,
            changed: false,
            causes: causes(&answer),
            machine: stored.machine.clone(),
            axis: stored.axis.clone(),
            measurement_id: stored.measurement_id.clone(),
            job_id: stored.job_id.clone(),
        };
        Some((stored.at_ms, row))
    };
    let estimates = answer.model().parameters.iter();
    Ok(estimates
        .filter(|(name, _)| wanted.is_none_or(|wanted| wanted == *name))
        .filter_map(row)
        .collect())
}

/// Compares each value with the one before of its parameter. The difference of two
/// independent estimates has the root of the sum of both variances: it is compared
/// with the half-widths of both 95 % intervals, added likewise.
fn compared(rows: &mut [(Millis, HistoryRow)]) {
    let half_width =
        |row: &HistoryRow| row.low95.zip(row.high95).map(|(low, high)| 0.5 * (high - low));
    let mut latest: HashMap<String, usize> = HashMap::new();
    for i in 0..rows.len() {
        let row = &rows[i].1;
        let before = latest.insert(row.parameter.clone(), i).map(|before| &rows[before].1);
        let Some(before) = before.filter(|before| before.unit == row.unit) else { continue };
        let change = row.value - before.value;
        let joint = half_width(row).zip(half_width(before)).map(|(a, b)| a.hypot(b));
        let changed = joint.is_some_and(|joint| change.abs() > joint);
        let row = &mut rows[i].1;
        (row.change, row.changed) = (Some(change), changed);
    }
}

fn causes(answer: &Answer) -> Option<String> {
    let ids: Vec<&str> = answer.causes().iter().map(|cause| cause.effect.as_str()).collect();
    (!ids.is_empty()).then(|| ids.join(" "))
}

fn rfc3339(millis: Millis) -> String {
    jiff::Timestamp::from_millisecond(millis).map(|time| time.to_string()).unwrap_or_default()
}

fn seconds(rfc3339: &str) -> f64 {
    rfc3339.parse::<jiff::Timestamp>().map_or(0.0, |time| time.as_millisecond() as f64 / 1000.0)
}

#[cfg(test)]
mod tests {
    use servoscope_core::answers::sample;

    use super::*;

    fn stored(at_ms: Millis, answer: &Answer) -> StoredResult {
        StoredResult {
            job_id: format!("job {at_ms}"),
            result: serde_json::to_string(answer).unwrap(),
            measurement_id: format!("measurement {at_ms}"),
            name: None,
            machine: Some("press 4".into()),
            axis: Some("x".into()),
            at_ms,
        }
    }

    /// The sample's pole, moved by so many half-widths of its interval.
    fn moved(half_widths: f64) -> Answer {
        let mut answer = sample::identification();
        let pole = &mut answer.parameters["pole"];
        let [low, high] = pole.interval95.unwrap();
        let by = half_widths * 0.5 * (high - low);
        pole.value = pole.value.map(|value| value + by);
        pole.interval95 = Some([low + by, high + by]);
        answer.into()
    }

    #[test]
    fn a_change_is_marked_where_it_goes_beyond_the_joint_interval() {
        // Two intervals of one width: √2 half-widths.
        let mut rows = Vec::new();
        for (at, half_widths) in [(0, 0.0), (1, 1.35), (2, -0.1)] {
            rows.extend(parameters(stored(at, &moved(half_widths)), Some("pole")).unwrap());
        }
        compared(&mut rows);
        let marks: Vec<bool> = rows.iter().map(|(_, row)| row.changed).collect();
        assert_eq!(marks, [false, false, true]);
        assert!(rows[0].1.change.is_none() && rows[2].1.change.is_some());
        assert_eq!(rows[2].1.at, "1970-01-01T00:00:00.002Z");
    }

    #[test]
    fn values_of_another_unit_are_not_compared() {
        let mut rows = parameters(stored(0, &moved(0.0)), Some("pole")).unwrap();
        rows.extend(parameters(stored(1, &moved(9.0)), Some("pole")).unwrap());
        rows[1].1.unit = "Hz".into();
        compared(&mut rows);
        assert!(rows[1].1.change.is_none() && !rows[1].1.changed);
    }

    #[test]
    fn a_result_says_whether_the_data_were_enough_for_a_test() {
        let mut diagnosis = sample::explained();
        let tested = |diagnosis: &Diagnosis| {
            result_row(stored(0, &diagnosis.clone().into())).unwrap().tested
        };
        assert_eq!(tested(&diagnosis), Some(true));
        for test in &mut diagnosis.discrepancy.tests {
            test.p_value = None;
        }
        assert_eq!(tested(&diagnosis), Some(false));
    }

    #[test]
    fn a_result_is_one_row_with_its_causes_and_gain() {
        let row = result_row(stored(0, &sample::explained().into())).unwrap();
        assert_eq!(row.causes.as_deref(), Some("static_friction"));
        assert_eq!(row.kind, JobKind::Diagnose);
        assert!(row.nrmse < row.base_nrmse && row.confidence.is_some());
        let row = result_row(stored(0, &sample::identification().into())).unwrap();
        assert_eq!((row.kind, row.verdict, row.causes), (JobKind::Identify, None, None));
        assert_eq!(row.tested, None);
    }
}
