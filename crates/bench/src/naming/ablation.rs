//! Ablation: the same draws, diagnosed with other values of the settings of the search.
//!
//! A draw is made once and diagnosed with every value in turn, on one thread. So other load on the
//! machine affects all values alike.

mod table;

use rustix::time::{ClockId, clock_gettime};
use serde_json::Number;
use servoscope_core::diagnose::diagnose;
use servoscope_core::identify::{IdentifyRequest, SearchSettings};
use servoscope_core::observer::Observer;

use super::build_case::build_case;
use super::case::Case;
use super::judge::{Outcome, Seconds};
use super::run::{Settings, Unmade, for_all, request};
use super::search_setting::{SettingChange, search_settings};

/// Settings that are changed together.
#[derive(Debug, Clone, PartialEq)]
struct Variant {
    /// Each setting as it was and as it becomes, in Markdown.
    label: String,
    search: SearchSettings,
}

/// The variants of the settings with which each draw is diagnosed.
#[derive(Debug, Clone, PartialEq)]
pub struct Ablation {
    /// All settings, unchanged.
    base: SearchSettings,
    variants: Vec<Variant>,
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
    /// The variants of `base` that `wanted` asks for. A name, or the beginning of one, stands for
    /// half and twice the value of each setting whose name begins so. `NAME=VALUE` stands for that
    /// value, and several of them joined by `+` for all these changes together.
    ///
    /// # Errors
    /// A message, if there is no such setting, or if it cannot have that value.
    pub fn new(base: SearchSettings, wanted: &[String]) -> Result<Self, String> {
        let settings = search_settings(&base);
        let mut variants = Vec::new();
        for wanted in wanted {
            if wanted.contains('=') {
                let changes: Result<Vec<_>, _> = wanted.split('+').map(str::parse).collect();
                variants.push(Variant::new(&base, &settings, &changes?)?);
                continue;
            }
            let named = settings.iter().filter(|setting| setting.0.starts_with(wanted.as_str()));
            let changes = named.flat_map(|(name, value)| {
                [SettingChange::half(name, value), SettingChange::double(name, value)]
            });
            let halved_and_doubled: Vec<_> = changes.collect();
            if halved_and_doubled.is_empty() {
                return Err(format!("the name of no setting begins with `{wanted}`"));
            }
            for change in halved_and_doubled {
                variants.push(Variant::new(&base, &settings, &[change])?);
            }
        }
        Ok(Self { base, variants })
    }

    /// The settings with which a draw is diagnosed, in turn: unchanged, those of each variant, and
    /// unchanged again. The two unchanged runs show how much times vary by themselves.
    fn searches(&self) -> impl Iterator<Item = SearchSettings> {
        let varied = self.variants.iter().map(|variant| variant.search);
        [self.base].into_iter().chain(varied).chain([self.base])
    }
}

impl Variant {
    fn new(
        base: &SearchSettings,
        settings: &[(String, Number)],
        changes: &[SettingChange],
    ) -> Result<Self, String> {
        let mut search = *base;
        let mut labels = Vec::new();
        for change in changes {
            search = change.apply(&search)?;
            let SettingChange { name, value } = change;
            let before = settings.iter().find(|setting| setting.0 == *name);
            let before = before.map(|setting| setting.1.to_string()).unwrap_or_default();
            labels.push(format!("`{name}`: {before} → {value}"));
        }
        Ok(Self { label: labels.join(", "), search })
    }
}

/// Diagnoses every draw with each variant of the settings; returns the trials of each draw. When
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
    let trial = |search: SearchSettings| {
        let began = thread_seconds();
        let request = IdentifyRequest { search, ..request };
        let answer = diagnose(&made.measurement, &request, observer);
        let processor_seconds = thread_seconds() - began;
        let answer = answer.as_ref().map_err(ToString::to_string);
        let outcome = Outcome::new(case, &made, answer, Seconds::default());
        Trial { outcome, processor_seconds }
    };
    Ok(ablation.searches().map(trial).collect())
}

/// Processor time used by this thread, s.
fn thread_seconds() -> f64 {
    let time = clock_gettime(ClockId::ThreadCPUTime);
    time.tv_sec as f64 + 1e-9 * time.tv_nsec as f64
}

#[cfg(test)]
mod tests {
    use servoscope_core::observer::Silent;

    use super::super::sizing::Sizing;
    use super::*;

    fn ablation(names: &[&str]) -> Result<Ablation, String> {
        let names: Vec<String> = names.iter().map(|name| (*name).to_owned()).collect();
        Ablation::new(SearchSettings::default(), &names)
    }

    #[test]
    fn each_named_setting_is_halved_and_doubled_between_two_unchanged_runs() {
        let searches = |wanted: &[&str]| -> Vec<(usize, f64)> {
            let ablation = ablation(wanted).unwrap();
            ablation.searches().map(|search| (search.glance_steps, search.rival_share)).collect()
        };
        let found = searches(&["glance_steps", "rival"]);
        assert_eq!(found, [(4, 0.5), (2, 0.5), (8, 0.5), (4, 0.25), (4, 1.0), (4, 0.5)]);
        let found = searches(&["glance_steps=1+rival_share=0.1", "glance_steps=9"]);
        assert_eq!(found, [(4, 0.5), (1, 0.1), (9, 0.5), (4, 0.5)]);
        assert!(ablation(&["rivalry"]).unwrap_err().contains("rivalry"));
        assert!(ablation(&["rivalry=1"]).unwrap_err().contains("rival_share"));
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
