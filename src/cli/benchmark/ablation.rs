//! `servoscope benchmark --settings` and `--ablation`: the settings of the search.

use std::fmt::Write as _;

use servoscope_bench::naming::{
    Ablation, Case, SettingChange, Settings, Trials, Unmade, ablate, search_settings,
};
use servoscope_core::identify::SearchSettings;

use super::Args;
use super::watch::Watch;
use crate::cli::Failure;
use crate::cli::terminal;

/// Settings that `--ablation` leaves out unless they are named: no draw is a record.
const OF_RECORDS: &str = "records.";

/// The default settings with these changes.
pub(super) fn changed(changes: &[SettingChange]) -> SearchSettings {
    // Each change was checked when it was parsed, and settings do not depend on each other.
    let apply = |search, change: &SettingChange| change.apply(&search).unwrap_or(search);
    changes.iter().fold(SearchSettings::default(), apply)
}

/// All settings with their values, one a line.
pub(super) fn listing(search: &SearchSettings) -> String {
    let mut text = String::new();
    for (name, value) in search_settings(search) {
        let _ = writeln!(text, "{name}={value}");
    }
    text
}

/// Diagnoses every draw with each variant of the settings, and prints the table.
pub(super) fn run(cases: &[Case], args: &Args, names: &[String]) -> Result<(), Failure> {
    let settings = args.settings();
    let all = || {
        let names = search_settings(&settings.search).into_iter().map(|setting| setting.0);
        names.filter(|name| !name.starts_with(OF_RECORDS)).collect()
    };
    let names = if names.is_empty() { all() } else { names.to_vec() };
    let ablation = Ablation::new(settings.search, &names).map_err(Failure::Input)?;
    let watch = Watch::new(cases.len());
    let done = |case: &Case, trials: &Trials| {
        let first = trials.as_ref().map_err(Clone::clone);
        watch.done(case, &first.map(|trials| trials[0].outcome.clone()));
    };
    let results = ablate(cases, &settings, &ablation, &watch, &done).map_err(Failure::other)?;
    watch.bar.finish_and_clear();
    let text = text(cases, &settings, &ablation, results);
    terminal::print_raw(text.as_bytes())
}

fn text(cases: &[Case], settings: &Settings, ablation: &Ablation, results: Vec<Trials>) -> String {
    let (mut draws, mut unmade) = (Vec::new(), String::new());
    for result in results {
        match result {
            Ok(trials) => draws.push(trials),
            Err(Unmade { key, reason }) => {
                let _ = writeln!(unmade, "\n{key} was not made: {reason}");
            }
        }
    }
    let (made, of, seed) = (draws.len(), cases.len(), settings.seed);
    format!("{made} draws of {of}, seed {seed}\n\n{}{unmade}", ablation.table(&draws))
}

#[cfg(test)]
mod tests {
    use super::super::tests::asked;
    use super::*;

    #[test]
    fn a_setting_that_does_not_exist_is_an_error_that_lists_those_that_do() {
        let error = asked("--setting rivals=2").unwrap_err();
        assert!(error.contains("`rivals` is no setting") && error.contains("rival_share"));
        let listed = listing(&asked("--setting rival_share=0.25").unwrap().settings().search);
        assert!(listed.contains("rival_share=0.25\n") && listed.contains("glance_steps=4\n"));
    }

    #[test]
    fn an_ablation_is_of_all_settings_or_of_those_that_are_named() {
        let named = |line: &str| asked(line).unwrap().ablation;
        assert_eq!(named("--jobs 1"), None);
        assert_eq!(named("--ablation"), Some(Vec::new()));
        let two = Some(vec!["rival_share".to_owned(), "glance=2+rival=1".to_owned()]);
        assert_eq!(named("--ablation rival_share glance=2+rival=1 --jobs 1"), two);
        assert_eq!(named("--ablation rival_share,glance=2+rival=1"), two);
    }
}
