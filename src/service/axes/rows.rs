//! Results and histories of parameters as rows of a table.

use std::collections::HashMap;

use servoscope_core::answers::{
    Answer, Diagnosis, HistoryRow, JobKind, ParameterEstimate, ResultRow,
};

use crate::report::page::parameter_name;
use crate::store::{Millis, StoredResult};

use crate::service::ServiceError;
use crate::service::jobs::answer;

pub(super) fn result_row(stored: StoredResult) -> Result<ResultRow, ServiceError> {
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

/// Parameters of the best model, each with when it was measured.
pub(super) fn parameters(
    stored: StoredResult,
    wanted: Option<&str>,
) -> Result<Vec<(Millis, HistoryRow)>, ServiceError> {
    let answer = answer(&stored.result)?;
    let row = |(name, estimate): (&String, &ParameterEstimate)| {
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
pub(super) fn compared(rows: &mut [(Millis, HistoryRow)]) {
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
