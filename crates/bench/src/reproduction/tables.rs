//! Tables II and III and the times of Figure 14 as Markdown, with the paper's columns next to ours.

mod closeness;
#[cfg(test)]
mod fixtures;

use servoscope_core::answers::Method;

use super::figure_of_merit::{ALONE, ANSWER, REFINED, Which, each, median, median_and_worst};
use super::markdown::{markdown, percent, written};
use super::published::{COLUMNS, Row, seconds, table};
use super::runs::{Reproduction, Run};
use super::system::System;
pub use closeness::as_close_as_published;
pub(super) use closeness::closeness_table;

/// Number of meaningful decimals at a noise level.
fn decimals(level: Option<u32>) -> usize {
    match level {
        None => 5,
        Some(_) => 4,
    }
}

/// Table II or III with its printed columns and, next to them, the results of `abc-ann` without
/// noise.
pub(super) fn paper_table(reproduction: &Reproduction, system: System) -> String {
    let runs = reproduction.of(system, None, Method::AbcAnn);
    let rows = table(system);
    let mut header = vec!["noise-free".to_owned(), "target, printed".into(), "computed".into()];
    header.extend(COLUMNS.map(|(name, _)| format!("{name}, printed")));
    header.extend(["colony alone: median", "worst", "abc-ann: median", "worst"].map(str::to_owned));
    let count = rows.len().to_string();
    let mut lines = vec![vec![count.clone(); header.len()]];
    lines[0][0] = "N_T".into();
    for (r, (row, target)) in rows.iter().zip(system.targets()).enumerate() {
        let mark = footnote_mark(rows, r);
        let complex = row.target.ends_with('i');
        let mut line = vec![format!("{}{mark}", row.name), row.target.into()];
        line.push(written(target, decimals(None), complex));
        line.extend(row.columns.map(str::to_owned));
        for which in [ALONE, REFINED] {
            let values = each(&runs, which, |outcome| outcome.rows[r]);
            match median_and_worst(&values, target) {
                Some((median, worst)) => {
                    line.extend([median, worst].map(|v| written(v, decimals(None), complex)));
                }
                None => line.extend(["–".to_owned(), "–".to_owned()]),
            }
        }
        lines.push(line);
    }
    markdown(&header, &lines) + &footnotes(rows)
}

fn footnote_mark(rows: &[Row], row: usize) -> String {
    match rows[row].misprint {
        Some(_) => {
            let number = rows[..=row].iter().filter(|row| row.misprint.is_some()).count();
            ["¹", "²", "³", "⁴"].get(number - 1).unwrap_or(&"*").to_string()
        }
        None => String::new(),
    }
}

fn footnotes(rows: &[Row]) -> String {
    let mut text = "\n".to_owned();
    for (r, row) in rows.iter().enumerate() {
        if let Some(misprint) = row.misprint {
            text += &format!("{} As printed: {misprint}.\n\n", footnote_mark(rows, r));
        }
    }
    text
}

/// Results of all methods side by side at one noise level: the median and, in brackets, the worst.
pub(super) fn methods_table(
    reproduction: &Reproduction,
    system: System,
    level: Option<u32>,
    which: Which,
) -> String {
    let methods = &reproduction.plan.methods;
    let mut header = vec![String::new(), "computed".into()];
    header.extend(methods.iter().map(|method| method.name().to_owned()));
    let targets = system.targets();
    let lines = table(system).iter().enumerate().map(|(r, row)| {
        let complex = row.target.ends_with('i');
        let digits = decimals(level);
        let mut line = vec![row.name.to_owned(), written(targets[r], digits, complex)];
        line.extend(methods.iter().map(|method| {
            let runs = reproduction.of(system, level, *method);
            let values = each(&runs, which, |outcome| outcome.rows[r]);
            median_and_worst(&values, targets[r]).map_or("–".to_owned(), |(median, worst)| {
                let [median, worst] = [median, worst].map(|v| written(v, digits, complex));
                format!("{median} ({worst})")
            })
        }));
        line
    });
    markdown(&header, &lines.collect::<Vec<_>>())
}

/// Errors, success rates, evaluations and times of every method at one noise level.
pub(super) fn effort_table(
    reproduction: &Reproduction,
    system: System,
    level: Option<u32>,
) -> String {
    let header = [
        "method",
        "error of search: median",
        "worst",
        "error of answer: median",
        "worst",
        "success",
        "of search alone",
        "evaluations: search",
        "budget",
        "all",
        "seconds: search",
        "all",
        "search ended",
    ];
    let lines = reproduction.plan.methods.iter().map(|method| {
        let runs = reproduction.of(system, level, *method);
        let worst = |errors: &[f64]| errors.iter().copied().fold(f64::NAN, f64::max);
        let errors = |which| each(&runs, which, |outcome| outcome.error);
        let (alone, answer) = (errors(ALONE), errors(ANSWER));
        let counted = |which: Which, of: fn(&super::Outcome) -> f64, digits: usize| {
            format!("{:.digits$}", median(&each(&runs, which, of)))
        };
        let successes = |which: Which| {
            let count = runs.iter().filter(|run| which(run).is_some_and(|o| o.success)).count();
            format!("{count} of {}", runs.len())
        };
        vec![
            method.name().to_owned(),
            percent(median(&alone)),
            percent(worst(&alone)),
            percent(median(&answer)),
            percent(worst(&answer)),
            successes(ANSWER),
            successes(ALONE),
            counted(ALONE, |o| o.evaluations as f64, 0),
            runs.iter().find_map(|run| run.budget).map_or("–".into(), |b| b.to_string()),
            counted(ANSWER, |o| o.evaluations as f64, 0),
            counted(ALONE, |o| o.seconds, 3),
            counted(ANSWER, |o| o.seconds, 3),
            commonest(&runs),
        ]
    });
    markdown(&header.map(str::to_owned), &lines.collect::<Vec<_>>())
}

fn commonest(runs: &[&Run]) -> String {
    let count = |reason: &str| runs.iter().filter(|run| run.stop_reason == reason).count();
    let reasons = runs.iter().map(|run| run.stop_reason.as_str());
    reasons.max_by_key(|reason| count(reason)).unwrap_or("–").to_owned()
}

/// The eight published times, the times measured here, and their ratio.
pub(super) fn times_table(reproduction: &Reproduction) -> String {
    let header =
        ["system", "column", "published, s", "method", "here, median, s", "worst, s", "ratio"];
    let mut lines = Vec::new();
    for &system in &reproduction.plan.systems {
        for ((column, method), published) in COLUMNS[1..].iter().zip(seconds(system)) {
            let runs = reproduction.of(system, None, *method);
            let ours = each(&runs, ANSWER, |outcome| outcome.seconds);
            if ours.is_empty() {
                continue;
            }
            let worst = ours.iter().copied().fold(0.0, f64::max);
            lines.push(vec![
                system.name().to_owned(),
                (*column).to_owned(),
                format!("{published:.3}"),
                method.name().to_owned(),
                format!("{:.3}", median(&ours)),
                format!("{worst:.3}"),
                format!("{:.0}", published / median(&ours)),
            ]);
        }
    }
    markdown(&header.map(str::to_owned), &lines)
}

#[cfg(test)]
mod tests {
    use super::fixtures::run;
    use super::*;

    #[test]
    fn a_table_keeps_the_misprints_and_says_what_they_are() {
        let runs = System::ALL.map(|system| run(system, system.targets())).to_vec();
        let plan = super::super::Plan { methods: vec![Method::AbcAnn], ..Default::default() };
        let reproduction = Reproduction { plan, runs };
        let text = paper_table(&reproduction, System::G2);
        assert!(text.contains("2.501-31.5032i") && text.contains("-2.50000+31.52380i"), "{text}");
        assert!(text.contains("root 2²") && text.contains("² As printed: of a real system"));
        let times = times_table(&reproduction);
        assert!(times.contains("62.852") && times.contains("126"), "{times}");
        let widths: Vec<usize> = times.lines().map(|line| line.chars().count()).collect();
        assert!(widths.windows(2).all(|pair| pair[0] == pair[1]), "{times}");
    }
}
