//! Tables II and III and the times of Figure 14 as Markdown, with the paper's columns next to ours.

use servoscope_core::answers::Method;
use servoscope_core::measurement::Complex;

use super::figure_of_merit::{ALONE, ANSWER, REFINED, Which, each, median, median_and_worst};
use super::published::{COLUMNS, Printed, Row, seconds, table};
use super::runs::{Reproduction, Run};
use super::system::System;

/// A Markdown table with aligned columns; the first is left-aligned, the others right-aligned.
pub(super) fn markdown(header: &[String], rows: &[Vec<String>]) -> String {
    let width = |column: usize| {
        let cells = rows.iter().filter_map(|row| row.get(column)).chain(header.get(column));
        cells.map(|cell| cell.chars().count()).max().unwrap_or(0).max(3)
    };
    let widths: Vec<usize> = (0..header.len()).map(width).collect();
    let line = |cells: &[String]| {
        let padded = cells.iter().zip(&widths).enumerate().map(|(i, (cell, width))| match i {
            0 => format!("{cell:<width$}"),
            _ => format!("{cell:>width$}"),
        });
        format!("| {} |\n", padded.collect::<Vec<_>>().join(" | "))
    };
    let rule = widths.iter().enumerate().map(|(i, width)| match i {
        0 => "-".repeat(*width),
        _ => format!("{}:", "-".repeat(width - 1)),
    });
    let rule = format!("| {} |\n", rule.collect::<Vec<_>>().join(" | "));
    line(header) + &rule + &rows.iter().map(|row| line(row)).collect::<String>()
}

/// A value in the notation of the paper, with the given number of decimals.
pub(super) fn written(value: Complex, decimals: usize, complex: bool) -> String {
    // Avoid printing −0.0.
    let re = if value.re.abs() < 0.5 * 10.0_f64.powi(-(decimals as i32)) { 0.0 } else { value.re };
    match complex {
        true => format!("{re:.decimals$}{:+.decimals$}i", value.im),
        false => format!("{re:.decimals$}"),
    }
}

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

/// A share in percent; small values have more decimals, very small ones an exponent.
pub(super) fn percent(share: f64) -> String {
    let value = 100.0 * share;
    match value {
        _ if value.is_nan() => "–".into(),
        _ if value == 0.0 => "0 %".into(),
        _ if value < 0.001 => format!("{value:.1e} %"),
        _ if value < 1.0 => format!("{value:.4} %"),
        _ => format!("{value:.2} %"),
    }
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

/// For each published column, the number of runs whose answer, rounded to the digits of that
/// column, is at least as close to the computed target as the column in every row.
pub fn as_close_as_published(system: System, runs: &[&Run]) -> [usize; 5] {
    let targets = system.targets();
    std::array::from_fn(|column| {
        let close = |run: &&&Run| {
            ANSWER(run).is_some_and(|outcome| {
                table(system).iter().zip(&targets).zip(&outcome.rows).all(
                    |((row, target), ours)| {
                        let printed = Printed::read(row.columns[column]);
                        let distance = |value: Complex| (value - target).norm();
                        // The same decimal number may differ in the last bit if read from text or
                        // rounded.
                        distance(printed.round(*ours)) <= distance(printed.value) + 1e-12
                    },
                )
            })
        };
        runs.iter().filter(close).count()
    })
}

/// The counts of [`as_close_as_published`] as a table.
pub(super) fn closeness_table(reproduction: &Reproduction) -> String {
    let mut header = vec!["abc-ann at least as close as".to_owned()];
    header.extend(COLUMNS.map(|(name, _)| name.to_owned()));
    let lines = reproduction.plan.systems.iter().map(|system| {
        let runs = reproduction.of(*system, None, Method::AbcAnn);
        let counts = as_close_as_published(*system, &runs);
        let cells = counts.map(|count| format!("{count} of {}", runs.len()));
        std::iter::once(system.name().to_owned()).chain(cells).collect()
    });
    markdown(&header, &lines.collect::<Vec<Vec<String>>>())
}

#[cfg(test)]
mod tests {
    use super::super::runs::Outcome;
    use super::super::system::reported;
    use super::*;

    fn run(system: System, rows: Vec<Complex>) -> Run {
        let outcome = Outcome {
            error: super::super::largest_error(system, &rows),
            rows,
            values: reported(&system.plant()),
            evaluations: 1000,
            seconds: 0.5,
            success: true,
        };
        Run {
            system,
            level: None,
            method: Method::AbcAnn,
            seed: 1,
            alone: Some(outcome.clone()),
            refined: Some(outcome),
            budget: Some(1010),
            stop_reason: "every cycle ended".into(),
            history: Vec::new(),
        }
    }

    #[test]
    fn the_target_itself_is_as_close_as_every_column_and_a_worse_pole_is_not() {
        for system in System::ALL {
            let exact = run(system, system.targets());
            assert_eq!(as_close_as_published(system, &[&exact]), [1; 5]);
        }
        // −10.0006 is closer than the printed −10.1 and −10.2, but not closer than −10.0004.
        let mut rows = System::G1.targets();
        rows[0].re = -10.0006;
        let off = run(System::G1, rows);
        assert_eq!(as_close_as_published(System::G1, &[&off]), [1, 1, 0, 1, 0]);
    }

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

    #[test]
    fn shares_are_written_with_digits_that_say_something() {
        let shares = [f64::NAN, 0.0, 1.2e-8, 4e-5, 0.123];
        assert_eq!(shares.map(percent), ["–", "0 %", "1.2e-6 %", "0.0040 %", "12.30 %"]);
    }
}
