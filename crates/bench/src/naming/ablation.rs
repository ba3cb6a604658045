//! Ablation: the same draws, diagnosed with each setting of the search halved and doubled.
//!
//! A draw is made once and diagnosed with every value in turn, on one thread. So other load on the
//! machine affects all values alike.

use std::fmt::Write as _;

use rustix::time::{ClockId, clock_gettime};
use serde_json::Number;
use servoscope_core::answers::Verdict;
use servoscope_core::diagnose::diagnose;
use servoscope_core::identify::{IdentifyRequest, SearchSettings};
use servoscope_core::observer::Observer;

use super::build_case::build_case;
use super::case::Case;
use super::judge::{Answer, Estimated, Outcome, Seconds};
use super::rate::Rate;
use super::run::{Settings, Unmade, for_all, request};
use super::search_setting::{SettingChange, search_settings};

/// A setting, its value, and half and twice that value.
#[derive(Debug, Clone, PartialEq)]
struct Compared {
    name: String,
    default: Number,
    tried: [SettingChange; 2],
}

/// The settings that are halved and doubled.
#[derive(Debug, Clone, PartialEq)]
pub struct Ablation {
    /// All settings, unchanged.
    base: SearchSettings,
    compared: Vec<Compared>,
}

/// One diagnosis of a draw.
#[derive(Debug, Clone, PartialEq)]
pub struct Trial {
    /// The answer, compared with the truth.
    pub outcome: Outcome,
    /// Processor time of the diagnosis, s.
    pub processor_seconds: f64,
}

/// All diagnoses of a draw, in turn; the reason, if the draw could not be made.
pub type Trials = Result<Vec<Trial>, Unmade>;

impl Ablation {
    /// Halves and doubles the settings of `base` whose names begin with one of `names`.
    ///
    /// # Errors
    /// A message, if no setting has a name that begins with one of them.
    pub fn new(base: SearchSettings, names: &[String]) -> Result<Self, String> {
        let settings = search_settings(&base);
        let begins = |name: &str, with: &String| name.starts_with(with.as_str());
        if let Some(with) = names.iter().find(|with| !settings.iter().any(|s| begins(&s.0, with))) {
            return Err(format!("the name of no setting begins with `{with}`"));
        }
        let wanted = settings.into_iter().filter(|s| names.iter().any(|with| begins(&s.0, with)));
        let compared = wanted.map(|(name, default)| {
            let tried =
                [SettingChange::half(&name, &default), SettingChange::double(&name, &default)];
            Compared { name, default, tried }
        });
        Ok(Self { base, compared: compared.collect() })
    }

    /// The settings with which a draw is diagnosed, in turn: unchanged, each halved and doubled,
    /// and unchanged again. The two unchanged runs show how much times vary by themselves.
    fn variants(&self) -> Result<Vec<SearchSettings>, String> {
        let changes = self.compared.iter().flat_map(|compared| &compared.tried);
        let changed = changes.map(|change| change.apply(&self.base));
        [Ok(self.base)].into_iter().chain(changed).chain([Ok(self.base)]).collect()
    }

    /// A Markdown table of the trials of all draws, those of a draw as `ablate` returns them.
    pub fn table(&self, draws: &[Vec<Trial>]) -> String {
        let heads = "right | first | explained | other | held | processor s";
        let mut text = format!(
            "| setting | default | half | {heads} | double | {heads} |\n\
             | --- | --- | {0} | {0} |\n",
            ["---"; 7].join(" | ")
        );
        let last = 2 * self.compared.len() + 1;
        let score = |variant: usize| Score::of(draws, variant);
        let [once, again] = [score(0), score(last)];
        let seconds = 0.5 * (once.seconds + again.seconds);
        let unchanged = [&once, &again].map(|score| score.cells(seconds));
        let _ =
            writeln!(text, "| unchanged | | once | {} | again | {} |", unchanged[0], unchanged[1]);
        for (i, Compared { name, default, tried: [half, double] }) in
            self.compared.iter().enumerate()
        {
            let cells = [1, 2].map(|n| score(2 * i + n).cells(seconds));
            let (half, double) = (&half.value, &double.value);
            let _ = writeln!(
                text,
                "| `{name}` | {default} | {half} | {} | {double} | {} |",
                cells[0], cells[1]
            );
        }
        text
    }
}

/// Diagnoses every draw with each setting halved and doubled; returns the trials of each draw. When
/// the observer cancels, draws that are not finished are left out. `done` is called with every
/// result, from any thread.
///
/// # Errors
/// If the threads cannot be started.
pub fn ablate(
    cases: &[Case],
    settings: &Settings,
    ablation: &Ablation,
    observer: &dyn Observer,
    done: &(dyn Fn(&Case, &Trials) + Sync),
) -> Result<Vec<Trials>, rayon::ThreadPoolBuildError> {
    // One thread a draw: processor time is measured per thread.
    let settings = Settings { threads: settings.jobs, ..*settings };
    let run = |case: &Case| trials(case, &settings, ablation, observer);
    for_all(cases, &settings, observer, run, done)
}

fn trials(
    case: &Case,
    settings: &Settings,
    ablation: &Ablation,
    observer: &dyn Observer,
) -> Trials {
    let unmade = |reason: String| Unmade { key: case.to_string(), reason };
    let made = build_case(case, settings.seed, settings.sizing, observer)
        .map_err(|error| unmade(error.to_string()))?;
    let request = request(case, settings);
    let variants = ablation.variants().map_err(unmade)?;
    let trial = |search: SearchSettings| {
        let began = thread_seconds();
        let request = IdentifyRequest { search, ..request };
        let answer = diagnose(&made.measurement, &request, observer);
        let processor_seconds = thread_seconds() - began;
        let answer = answer.as_ref().map_err(ToString::to_string);
        let outcome = Outcome::new(case, &made, answer, Seconds::default());
        Trial { outcome, processor_seconds }
    };
    Ok(variants.into_iter().map(trial).collect())
}

/// Processor time used by this thread, s.
fn thread_seconds() -> f64 {
    let time = clock_gettime(ClockId::ThreadCPUTime);
    time.tv_sec as f64 + 1e-9 * time.tv_nsec as f64
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
        let answers = outcomes().filter_map(|outcome| outcome.answer.as_ref().ok());
        let estimates =
            answers.flat_map(|Answer { effect_parameters, plant_parameters, .. }| {
                effect_parameters.iter().chain(plant_parameters)
            });
        let is_other = |trials: &&Vec<Trial>| said(&trials[variant]) != said(&trials[0]);
        Self {
            right: Rate::count(outcomes().map(Outcome::is_right)),
            first: Rate::count(hidden().map(Outcome::named_first)),
            explained: Rate::count(hidden().map(Outcome::is_explained)),
            other: draws.iter().filter(is_other).count() as u32,
            held: Rate::count(estimates.filter_map(Estimated::held)),
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

/// The verdict, and the causes, strongest first.
fn said(trial: &Trial) -> (Option<Verdict>, Vec<&str>) {
    let causes = trial.outcome.causes().iter().map(|cause| cause.effect.as_str());
    (trial.outcome.verdict(), causes.collect())
}

#[cfg(test)]
mod tests {
    use servoscope_core::observer::Silent;

    use super::super::fixtures::outcome;
    use super::super::sizing::Sizing;
    use super::*;

    fn ablation(names: &[&str]) -> Result<Ablation, String> {
        let names: Vec<String> = names.iter().map(|name| (*name).to_owned()).collect();
        Ablation::new(SearchSettings::default(), &names)
    }

    fn trial(causes: &[(&str, f64, &[&str])], processor_seconds: f64) -> Trial {
        let outcome = outcome("single-60-spring-o0-0", &["spring"], causes, Verdict::Explained);
        Trial { outcome, processor_seconds }
    }

    #[test]
    fn each_selected_setting_is_halved_and_doubled_between_two_unchanged_runs() {
        let variants = ablation(&["glance_steps", "rival"]).unwrap().variants().unwrap();
        let found: Vec<(usize, f64)> =
            variants.iter().map(|search| (search.glance_steps, search.rival_share)).collect();
        assert_eq!(found, [(4, 0.5), (2, 0.5), (8, 0.5), (4, 0.25), (4, 1.0), (4, 0.5)]);
        assert!(ablation(&["rivalry"]).unwrap_err().contains("rivalry"));
    }

    #[test]
    fn the_table_compares_each_value_with_the_unchanged_runs() {
        let right: &[(&str, f64, &[&str])] = &[("spring", 0.99, &[])];
        let trials = vec![
            trial(right, 1.9),
            trial(&[("cogging", 0.9, &[])], 1.0),
            trial(right, 3.0),
            trial(right, 2.1),
        ];
        let table = ablation(&["rival_share"]).unwrap().table(&[trials]);
        let rows: Vec<&str> = table.lines().skip(2).collect();
        let cells = rows[1].split(" | ").collect::<Vec<_>>();
        assert_eq!(cells[..6], ["| `rival_share`", "0.5", "0.25", "0/1", "0/1", "1/1"]);
        assert_eq!((cells[6], cells[8]), ("1", "1.0 (-50.0 %)"));
        assert_eq!(cells[9..14], ["1.0", "1/1", "1/1", "1/1", "0"]);
        assert!(rows[0].contains("1.9 (-5.0 %) | again"), "{}", rows[0]);
        let columns = |row: &str| row.matches('|').count();
        assert!(table.lines().all(|row| columns(row) == columns(rows[0])), "{table}");
    }

    #[test]
    fn the_two_unchanged_runs_of_a_draw_give_the_same_answer_and_their_time_is_measured() {
        let settings = Settings {
            seed: 7,
            sizing: Sizing::Amount,
            order_from_data: false,
            search: SearchSettings::default(),
            separate: false,
            nearest: false,
            jobs: 1,
            threads: 1,
        };
        let cases = ["clean-60-o0-0".parse().unwrap()];
        let ablation = ablation(&[]).unwrap();
        let draws = ablate(&cases, &settings, &ablation, &Silent, &|_, _| {}).unwrap();
        let trials = draws[0].as_ref().unwrap();
        assert_eq!(trials.len(), 2);
        assert!(trials.iter().all(|trial| trial.processor_seconds > 0.0));
        assert_eq!(trials[0].outcome, trials[1].outcome);
    }
}
