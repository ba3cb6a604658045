//! The table of an ablation.

use std::fmt::Write as _;

use servoscope_core::answers::Verdict;

use super::{Ablation, Trial};
use crate::naming::judge::{Answer, Estimated, Outcome};
use crate::naming::rate::Rate;

impl Ablation {
    /// A Markdown table of the trials of all draws, those of a draw as `ablate` returns them.
    pub fn table(&self, draws: &[Vec<Trial>]) -> String {
        let columns = ["setting", "right", "first", "explained", "other", "held", "processor s"];
        let mut text =
            format!("| {} |\n|{}\n", columns.join(" | "), " --- |".repeat(columns.len()));
        let labels = self.variants.iter().map(|variant| variant.label.as_str());
        let labels: Vec<&str> = ["unchanged"].into_iter().chain(labels).chain(["again"]).collect();
        let scores: Vec<Score> = (0..labels.len()).map(|i| Score::of(draws, i)).collect();
        let [once, again] = [0, labels.len() - 1].map(|i| scores[i].seconds);
        for (label, score) in labels.iter().zip(&scores) {
            let _ = writeln!(text, "| {label} | {} |", score.cells(0.5 * (once + again)));
        }
        text.push('\n');
        for (i, label) in labels.iter().enumerate() {
            let differs = |trials: &&Vec<Trial>| said(&trials[i]) != said(&trials[0]);
            let misses_more = |trials: &&Vec<Trial>| missed(&trials[i]) > missed(&trials[0]);
            let keys = draws.iter().filter(|draw| differs(draw) || misses_more(draw));
            let keys: Vec<&str> = keys.map(|trials| trials[0].outcome.key.as_str()).collect();
            if !keys.is_empty() {
                let _ = writeln!(
                    text,
                    "- {label}: another answer, or fewer intervals that hold: {}",
                    keys.join(", ")
                );
            }
        }
        text
    }
}

/// Statistics of all draws, with one value of a setting.
struct Score {
    right: Rate,
    /// Draws with a hidden effect that is named first.
    first: Rate,
    /// Draws with a hidden effect whose verdict is that the causes explain the data.
    explained: Rate,
    /// Draws whose causes or verdict differ from those with unchanged settings.
    other: u32,
    /// 95 % intervals that contain the true value.
    held: Rate,
    seconds: f64,
}

impl Score {
    fn of(draws: &[Vec<Trial>], variant: usize) -> Self {
        let trials = || draws.iter().map(|trials| &trials[variant]);
        let outcomes = || trials().map(|trial| &trial.outcome);
        let hidden = || outcomes().filter(|outcome| !outcome.hidden.is_empty());
        let is_other = |trials: &&Vec<Trial>| said(&trials[variant]) != said(&trials[0]);
        Self {
            right: Rate::count(outcomes().map(Outcome::is_right)),
            first: Rate::count(hidden().map(Outcome::named_first)),
            explained: Rate::count(hidden().map(Outcome::is_explained)),
            other: draws.iter().filter(is_other).count() as u32,
            held: held(trials()),
            seconds: trials().map(|trial| trial.processor_seconds).sum(),
        }
    }

    fn cells(&self, usual_seconds: f64) -> String {
        let Self { right, first, explained, other, held, seconds } = self;
        let share = |rate: &Rate| format!("{}/{}", rate.hits, rate.of);
        let more = 100.0 * (seconds / usual_seconds - 1.0);
        format!(
            "{} | {} | {} | {other} | {} | {seconds:.1} ({more:+.1} %)",
            share(right),
            share(first),
            share(explained),
            share(held)
        )
    }
}

/// 95 % intervals that contain the true value.
fn held<'t>(trials: impl IntoIterator<Item = &'t Trial>) -> Rate {
    let answers = trials.into_iter().filter_map(|trial| trial.outcome.answer.as_ref().ok());
    let estimates = answers.flat_map(|Answer { effect_parameters, plant_parameters, .. }| {
        effect_parameters.iter().chain(plant_parameters)
    });
    Rate::count(estimates.filter_map(Estimated::held))
}

/// Number of 95 % intervals that do not contain the true value.
fn missed(trial: &Trial) -> u32 {
    let Rate { hits, of } = held([trial]);
    of - hits
}

/// The verdict, and the causes, strongest first.
fn said(trial: &Trial) -> (Option<Verdict>, Vec<&str>) {
    let causes = trial.outcome.causes().iter().map(|cause| cause.effect.as_str());
    (trial.outcome.verdict(), causes.collect())
}

#[cfg(test)]
mod tests {
    use servoscope_core::identify::SearchSettings;

    use super::*;
    use crate::naming::fixtures::outcome;

    fn trial(causes: &[(&str, f64, &[&str])], processor_seconds: f64) -> Trial {
        let outcome = outcome("single-60-spring-o0-0", &["spring"], causes, Verdict::Explained);
        Trial { outcome, processor_seconds }
    }

    #[test]
    fn the_table_compares_each_value_with_the_unchanged_runs_and_names_draws_that_differ() {
        let right: &[(&str, f64, &[&str])] = &[("spring", 0.99, &[])];
        let trials = vec![
            trial(right, 1.9),
            trial(&[("cogging", 0.9, &[])], 1.0),
            trial(right, 3.0),
            trial(right, 2.1),
        ];
        let wanted = ["rival_share=0.25", "rival_share=0.1+glance_steps=2"];
        let wanted = wanted.map(str::to_owned);
        let ablation = Ablation::new(SearchSettings::default(), &wanted).unwrap();
        let table = ablation.table(&[trials]);
        let (rows, below) = table.split_once("\n\n").unwrap();
        let rows: Vec<&str> = rows.lines().skip(2).collect();
        let cells = rows[1].split(" | ").collect::<Vec<_>>();
        assert_eq!(cells[..4], ["| `rival_share`: 0.5 → 0.25", "0/1", "0/1", "1/1"]);
        assert_eq!((cells[4], cells[6]), ("1", "1.0 (-50.0 %) |"));
        let both = "| `rival_share`: 0.5 → 0.1, `glance_steps`: 4 → 2 | 1/1 | 1/1 | 1/1 | 0 |";
        assert!(rows[2].starts_with(both), "{}", rows[2]);
        assert!(rows[0].starts_with("| unchanged") && rows[0].contains("1.9 (-5.0 %)"));
        assert!(below.contains("0.25: another answer") && below.contains("single-60-spring-o0-0"));
        assert_eq!(below.lines().count(), 1, "{below}");
        let columns = |row: &str| row.matches(" | ").count();
        assert!(rows.iter().all(|row| columns(row) == columns(rows[0])), "{table}");
    }
}
