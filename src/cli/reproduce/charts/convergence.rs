//! Convergence of every method, over simulations of the whole measurement.

use servoscope_bench::reproduction::system::System;
use servoscope_bench::reproduction::{Chart, Reproduction};
use servoscope_core::answers::ConvergenceRow;

use crate::report::figures::Theme;
use crate::report::figures::chart::{self, Plot, Stroke};

use super::line;

/// Convergence of all methods on one axis.
pub(super) fn convergence_chart(
    name: &'static str,
    reproduction: &Reproduction,
    system: System,
) -> Chart {
    // With noise the cost has a floor that means something.
    let levels = &reproduction.plan.levels;
    let level = levels.iter().copied().flatten().next();
    let histories = reproduction.plan.methods.iter().filter_map(|method| {
        let run = reproduction.of(system, level, *method).into_iter().next()?;
        Some((method.name(), progress(&run.history))).filter(|(_, points)| points.len() > 1)
    });
    // Neighbours in the order of colours are alike: every other one is dashed.
    let strokes = [Stroke::Solid, Stroke::Dashed].into_iter().cycle();
    let lines = histories.zip(strokes).map(|((name, points), stroke)| line(name, points, stroke));
    let plots = [Plot {
        x: "Simulations of the whole measurement (–)".into(),
        y: "Least cost so far (–)".into(),
        logarithmic: [true, true],
        floor: None,
        lines: lines.collect(),
    }];
    let title = format!("{}: convergence of every method", system.name());
    let noise = level.map_or("without noise".to_owned(), |db| format!("at {db} dB"));
    let says = format!(
        "Seed {}, {noise}; a network's training counts, and its answer stands at its end.",
        reproduction.plan.seeds.start()
    );
    let svg = chart::lines(name, &title, &says, &plots, Theme::Auto);
    Chart { name, title, svg }
}

/// Least cost over all evaluations so far; the rows of a network are losses, not costs.
fn progress(rows: &[ConvergenceRow]) -> Vec<[f64; 2]> {
    let mut points: Vec<[f64; 2]> = Vec::new();
    let (mut before, mut stage, mut used) = (0, "", 0);
    let mut best = f64::INFINITY;
    for row in rows {
        if row.stage != stage {
            before += used;
            stage = &row.stage;
        }
        used = row.evaluations;
        if stage != "network" && row.best < f64::MAX {
            best = best.min(row.best);
            points.push([(before + used).max(1) as f64, best]);
        }
    }
    points
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn progress_adds_up_over_stages_and_leaves_losses_out() {
        let row = |stage: &str, evaluations, best| ConvergenceRow {
            stage: stage.into(),
            cycle: 0,
            evaluations,
            best,
            mean: None,
            elapsed_s: 0.0,
        };
        let rows = [
            row("closed_form", 1, 9.0),
            row("network", 800, 0.1),
            row("network", 800, 0.05),
            row("colony", 10, 20.0),
            row("colony", 30, 5.0),
            row("refinement", 2, 4.0),
        ];
        let found = progress(&rows);
        assert_eq!(found, [[1.0, 9.0], [811.0, 9.0], [831.0, 5.0], [833.0, 4.0]]);
    }
}
