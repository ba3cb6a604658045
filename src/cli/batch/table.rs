//! A batch as it is printed.

use std::collections::BTreeMap;
use std::fmt::Write;

use serde::Deserialize;

/// A batch as the server shows it.
#[derive(Debug, Deserialize)]
pub(super) struct Seen {
    pub(super) id: String,
    pub(super) jobs: i64,
    state: String,
    counts: BTreeMap<String, i64>,
    verdicts: BTreeMap<String, i64>,
    causes: BTreeMap<String, i64>,
    failures: Vec<Reason>,
}

#[derive(Debug, Deserialize)]
struct Reason {
    reason: String,
    jobs: i64,
}

/// What came of one measurement.
#[derive(Debug, Default, Deserialize)]
pub(super) struct Row {
    measurement_id: String,
    file: Option<String>,
    state: String,
    verdict: Option<String>,
    tested: Option<bool>,
    cause: Option<String>,
    confidence: Option<f64>,
    problem: Option<String>,
}

/// States of jobs in the order in which they are told.
const STATES: [&str; 6] = ["succeeded", "failed", "cancelled", "deleted", "running", "queued"];

impl Seen {
    pub(super) fn has_ended(&self) -> bool {
        self.state == "ended"
    }

    fn count(&self, state: &str) -> i64 {
        self.counts.get(state).copied().unwrap_or_default()
    }

    /// Jobs that have ended, or are gone.
    pub(super) fn ended(&self) -> i64 {
        self.jobs - self.count("running") - self.count("queued")
    }

    /// How far it has come, in a line.
    pub(super) fn progress(&self) -> String {
        let mut line = format!("{} of {} ended", self.ended(), self.jobs);
        let some = STATES.into_iter().filter(|state| self.count(state) > 0);
        let some: Vec<String> =
            some.map(|state| format!("{} {state}", self.count(state))).collect();
        if !some.is_empty() {
            let _ = write!(line, ": {}", some.join(", "));
        }
        line
    }
}

/// The table, and below it the summary.
pub(super) fn text(seen: &Seen, rows: &[Row]) -> String {
    let titles = ["file", "state", "verdict", "cause", "confidence", "problem"];
    let mut cells = vec![titles.map(str::to_owned)];
    cells.extend(rows.iter().map(|row| {
        let or_nothing = |text: &Option<String>| printable(text.as_deref().unwrap_or_default());
        [
            printable(row.file.as_deref().unwrap_or(&row.measurement_id)),
            printable(&row.state),
            match row.tested {
                Some(false) => "not tested".to_owned(),
                _ => or_nothing(&row.verdict),
            },
            or_nothing(&row.cause),
            row.confidence.map(confidence).unwrap_or_default(),
            or_nothing(&row.problem),
        ]
    }));
    let widths = [0, 1, 2, 3, 4].map(|column| {
        cells.iter().map(|row| row[column].chars().count()).max().unwrap_or_default()
    });
    let mut text = String::new();
    for row in &cells {
        let padded = row.iter().zip(widths).map(|(cell, width)| format!("{cell:width$}  "));
        let line = padded.collect::<String>() + &row[5];
        let _ = writeln!(text, "{}", line.trim_end());
    }
    let _ = writeln!(text, "\n{}", seen.progress());
    let verdicts: BTreeMap<String, i64> =
        seen.verdicts.iter().map(|(name, count)| (name.replace('_', " "), *count)).collect();
    for (what, among) in [("verdicts", &verdicts), ("first causes", &seen.causes)] {
        if !among.is_empty() {
            let mut most: Vec<_> = among.iter().collect();
            most.sort_by_key(|(_, count)| -**count);
            let most: Vec<String> =
                most.iter().map(|(name, count)| format!("{count} {}", printable(name))).collect();
            let _ = writeln!(text, "{what}: {}", most.join(", "));
        }
    }
    for Reason { reason, jobs } in &seen.failures {
        let _ = writeln!(text, "{jobs} failed: {}", printable(reason));
    }
    text
}

/// A probability: nothing is certain.
fn confidence(share: f64) -> String {
    if share > 0.999 {
        "> 99.9 %".into()
    } else {
        format!("{:.1} %", (1000.0 * share).floor() / 10.0)
    }
}

/// Text of strangers without what a terminal would obey.
fn printable(text: &str) -> String {
    text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect()
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn a_table_says_what_came_of_each_and_of_all() {
        let seen: Seen = serde_json::from_value(json!({
            "id": "a", "name": null, "jobs": 4, "state": "ended",
            "counts": {"queued": 0, "running": 0, "succeeded": 3, "failed": 1},
            "verdicts": {"adequate": 1, "explained": 1, "not_tested": 1}, "causes": {"backlash": 1},
            "failures": [{"reason": "too few experiments", "jobs": 1}],
        }))
        .unwrap();
        let rows: Vec<Row> = serde_json::from_value(json!([
            {"measurement_id": "1", "file": "x axis.csv", "state": "succeeded",
             "verdict": "explained", "cause": "backlash", "confidence": 0.9876},
            {"measurement_id": "2", "file": "y.csv", "state": "succeeded", "verdict": "adequate",
             "tested": true},
            {"measurement_id": "4", "file": "few.csv", "state": "succeeded", "verdict": "adequate",
             "tested": false},
            {"measurement_id": "3", "file": "z\u{1b}[2J.csv", "state": "failed",
             "problem": "too few experiments"},
        ]))
        .unwrap();
        let expected = "\
file        state      verdict     cause     confidence  problem
x axis.csv  succeeded  explained   backlash  98.7 %
y.csv       succeeded  adequate
few.csv     succeeded  not tested
z [2J.csv   failed                                       too few experiments

4 of 4 ended: 3 succeeded, 1 failed
verdicts: 1 adequate, 1 explained, 1 not tested
first causes: 1 backlash
1 failed: too few experiments
";
        assert_eq!(text(&seen, &rows), expected);
    }
}
