//! A plan of experiments, as text for a terminal and as a table.

use servoscope_core::answers::{Plan, PlannedSweep};

use super::number::significant;
use super::summary::wrapped;
use super::tables;
use super::text::section;
use super::written::lines;

/// Experiments that are shown; the table has all of them.
const SHOWN: usize = 8;

/// Writes what a plan shows, how it compares with sweeps, and how it begins, in at most 40 lines.
/// Sentences are broken into lines of at most `width` columns; tables are not.
pub fn plan(plan: &Plan, width: usize) -> String {
    let measured = format!(
        "{} experiments in {} s of {} s should identify {} of {} effects of typical size (with a \
         probability of 90 % or more)",
        plan.experiments.len(),
        significant(plan.duration_s, 3),
        significant(plan.request.budget_s, 3),
        plan.nameable,
        plan.effects.len()
    );
    let mut said = vec![measured];
    said.extend(plan.sweeps.iter().map(sweep));
    let mut begins =
        lines(&tables::planned(&plan.experiments[..plan.experiments.len().min(SHOWN)]));
    if plan.experiments.len() > SHOWN {
        let more = plan.experiments.len() - SHOWN;
        begins.push(format!("… and {more} more: --table FILE.csv or --json has them all"));
    }
    let sections = [
        section("Plan", said.iter().flat_map(|text| wrapped(text, width - 2)).collect()),
        section("What it identifies", lines(&tables::nameable(plan))),
        section("Experiments in their order", begins),
    ];
    let notes = plan.notes.iter().flat_map(|note| wrapped(&format!("- {note}"), width));
    sections.concat() + &notes.map(|line| line + "\n").collect::<String>()
}

fn sweep(sweep: &PlannedSweep) -> String {
    let magnitudes = match sweep.magnitudes.len() {
        1 => "at one magnitude".to_owned(),
        count => format!("at {count} magnitudes"),
    };
    format!(
        "a logarithmic sweep {magnitudes}, of {} points in {} s, should identify {}",
        sweep.experiments.len(),
        significant(sweep.duration_s, 3),
        sweep.nameable
    )
}

/// The experiments as CSV, in their order.
pub fn plan_csv(plan: &Plan) -> String {
    let head =
        "run,magnitude,omega_rad_s,settle_periods,measured_periods,repeats,duration_s,serves\n";
    let rows = plan.experiments.iter().map(|experiment| {
        format!(
            "{},{},{},{},{},{},{},{}\n",
            experiment.run,
            experiment.magnitude,
            experiment.omega_rad_s,
            experiment.settle_periods,
            experiment.measured_periods,
            experiment.repeats,
            experiment.duration_s,
            experiment.serves.as_deref().unwrap_or_default()
        )
    });
    std::iter::once(head.to_owned()).chain(rows).collect()
}

#[cfg(test)]
mod tests {
    use servoscope_core::answers::sample;

    use super::*;

    #[test]
    fn a_long_plan_fits_on_forty_lines_and_its_table_has_every_experiment() {
        let plan = sample::plan();
        assert!(plan.experiments.len() > SHOWN);
        let text = super::plan(&plan, 100);
        assert!(text.lines().count() <= 40, "{text}");
        assert!(text.contains("and 4 more") && text.contains("at 3 magnitudes"), "{text}");
        let table = plan_csv(&plan);
        assert_eq!(table.lines().count(), plan.experiments.len() + 1);
        assert!(table.lines().nth(1).unwrap().starts_with("0,1,10,"), "{table}");
    }
}
