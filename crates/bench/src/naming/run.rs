//! Runs many draws in parallel.

use std::sync::Mutex;
use std::sync::PoisonError;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

use rand::RngExt;
use servoscope_core::answers::{Diagnosis, IdentifyOptions, PlantRequest};
use servoscope_core::diagnose::diagnose;
use servoscope_core::identify::{IdentifyRequest, SearchSettings};
use servoscope_core::observer::Observer;

use super::build_case::{MakeError, build_case};
use super::case::{Case, Kind};
use super::fresh::fresh;
use super::judge::{Answer, Outcome, Seconds};
use super::separation::separate;
use super::sizing::Sizing;

/// How draws are run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// Base seed of all random numbers.
    pub seed: u64,
    /// How a hidden effect is scaled to its excess.
    pub sizing: Sizing,
    /// Whether the diagnosis must choose the actuator's order from the data.
    pub order_from_data: bool,
    /// Settings of the diagnosis' search. Draws are made with the default ones.
    pub search: SearchSettings,
    /// Whether to try the proposed next experiment of single draws.
    pub separate: bool,
    /// Whether to find the nearest rival of a single hidden effect, and what the machine's own model
    /// leaves of a fault of its measurement.
    pub nearest: bool,
    /// Number of draws run in parallel; they share `threads` equally.
    pub jobs: usize,
    /// Number of threads of all draws together.
    pub threads: usize,
}

/// A draw that was run.
#[derive(Debug, Clone, PartialEq)]
pub struct Run {
    /// The judged answer.
    pub outcome: Outcome,
    /// The whole diagnosis; `None` if it failed.
    pub diagnosis: Option<Diagnosis>,
}

/// A draw that could not be made, and why.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize)]
pub struct Unmade {
    /// The key of the draw.
    pub key: String,
    /// The reason.
    pub reason: String,
}

/// Makes one draw, diagnoses it and judges the answer.
///
/// # Errors
/// If the draw cannot be made, or one of the additional checks fails.
pub fn run_case(case: &Case, settings: &Settings, observer: &dyn Observer) -> Result<Run, Unmade> {
    let began = Instant::now();
    let made = build_case(case, settings.seed, settings.sizing, observer)
        .map_err(|error| Unmade { key: case.to_string(), reason: error.to_string() })?;
    let data = began.elapsed().as_secs_f64();
    let request = request(case, settings);
    let began = Instant::now();
    let answer = diagnose(&made.measurement, &request, observer);
    let seconds = Seconds { data, job: began.elapsed().as_secs_f64() };
    let judged = answer.as_ref().map_err(ToString::to_string);
    let mut outcome = Outcome::new(case, &made, judged, seconds);
    let unmade = |error: MakeError| Unmade { key: case.to_string(), reason: error.to_string() };
    if let Some(mistake) = &made.mistake {
        let answer = diagnose(&mistake.sound, &request, observer);
        let answer = answer.map(|diagnosis| Answer::of(&diagnosis, &made));
        outcome.sound = Some(answer.map_err(|error| error.to_string()));
    }
    let is_table = !case.kind.is_recorded() && made.mistake.is_none();
    if let Some(answer) = answer.as_ref().ok().filter(|_| is_table) {
        // A third random stream.
        let rng = &mut case.rng(settings.seed.rotate_left(8));
        outcome.fresh = fresh(&made, answer, rng).map_err(unmade)?;
    }
    if let Some(answer) =
        answer.as_ref().ok().filter(|_| settings.separate && case.kind == Kind::Single)
    {
        // A fourth random stream.
        let rng = &mut case.rng(settings.seed.swap_bytes());
        outcome.separation = separate(&made, answer, &request, rng, observer).map_err(unmade)?;
    }
    if settings.nearest && matches!(case.kind, Kind::Single | Kind::Analyser) {
        outcome.nearest = made.nearest_rival().map_err(unmade)?;
    }
    if settings.nearest
        && let Some(found) = &mut outcome.mismeasurement
    {
        found.left_by_own_model = made.left_of_fault().map_err(unmade)?;
    }
    Ok(Run { outcome, diagnosis: answer.ok() })
}

/// The request with which a draw is diagnosed.
pub(super) fn request(case: &Case, settings: &Settings) -> IdentifyRequest {
    let given = PlantRequest { actuator_order: case.order };
    // A different stream than that of the draw. 32 bits, so that the seed is easy to type.
    let seed = u64::from(case.rng(!settings.seed).random::<u32>());
    IdentifyRequest {
        plant: (!settings.order_from_data).then_some(given),
        options: IdentifyOptions { seed, ..IdentifyOptions::default() },
        search: settings.search,
        ..IdentifyRequest::default()
    }
}

/// Runs draws in parallel; the results are in the order of the cases. When the observer cancels,
/// draws that are not finished are left out. `done` is called with every result, from any thread.
///
/// Each draw has its own threads, so that its computing time does not depend on the others.
///
/// # Errors
/// If the threads cannot be started.
pub fn run_all(
    cases: &[Case],
    settings: &Settings,
    observer: &dyn Observer,
    done: &(dyn Fn(&Case, &Result<Outcome, Unmade>) + Sync),
) -> Result<Vec<Result<Outcome, Unmade>>, rayon::ThreadPoolBuildError> {
    let run = |case: &Case| run_case(case, settings, observer).map(|run| run.outcome);
    for_all(cases, settings, observer, run, done)
}

/// Does the same with every case, several at once: see [`run_all`].
pub(super) fn for_all<T: Send>(
    cases: &[Case],
    settings: &Settings,
    observer: &dyn Observer,
    run: impl Fn(&Case) -> T + Sync,
    done: &(dyn Fn(&Case, &T) + Sync),
) -> Result<Vec<T>, rayon::ThreadPoolBuildError> {
    let next = AtomicUsize::new(0);
    let results = Mutex::new(Vec::new());
    let work = || loop {
        let index = next.fetch_add(1, Ordering::Relaxed);
        let Some(case) = cases.get(index) else { return };
        if observer.cancelled() {
            return;
        }
        let result = run(case);
        if observer.cancelled() {
            return;
        }
        done(case, &result);
        results.lock().unwrap_or_else(PoisonError::into_inner).push((index, result));
    };
    let jobs = settings.jobs.clamp(1, cases.len().max(1));
    let threads = (settings.threads / jobs).max(1);
    let pools = (0..jobs)
        .map(|_| rayon::ThreadPoolBuilder::new().num_threads(threads).build())
        .collect::<Result<Vec<_>, _>>()?;
    std::thread::scope(|scope| {
        for pool in &pools {
            scope.spawn(|| pool.install(work));
        }
    });
    let mut results = results.into_inner().unwrap_or_else(PoisonError::into_inner);
    results.sort_by_key(|(index, _)| *index);
    Ok(results.into_iter().map(|(_, result)| result).collect())
}

#[cfg(test)]
mod tests {
    use servoscope_core::observer::Silent;

    use super::*;

    fn settings(jobs: usize) -> Settings {
        Settings {
            seed: 7,
            sizing: Sizing::Amount,
            order_from_data: false,
            search: SearchSettings::default(),
            separate: false,
            nearest: true,
            jobs,
            threads: jobs,
        }
    }

    fn cases() -> Vec<Case> {
        ["clean-60-o0-0", "single-50-actuator_dead_zone-o0-0", "clean-60-o0-4"]
            .map(|key| key.parse().unwrap())
            .into()
    }

    fn timeless(results: Vec<Result<Outcome, Unmade>>) -> Vec<Outcome> {
        let timeless = |outcome: Outcome| Outcome { seconds: Seconds::default(), ..outcome };
        results.into_iter().map(|result| timeless(result.unwrap())).collect()
    }

    #[test]
    fn results_are_the_same_one_at_a_time_and_in_the_order_of_the_cases() {
        let cases = cases();
        let at_once = run_all(&cases, &settings(2), &Silent, &|_, _| {}).unwrap();
        let in_turn = run_all(&cases, &settings(1), &Silent, &|_, _| {}).unwrap();
        let in_turn = timeless(in_turn);
        assert_eq!(timeless(at_once), in_turn);
        let nearest = in_turn.iter().map(|outcome| outcome.nearest.is_some());
        assert_eq!(nearest.collect::<Vec<_>>(), [false, true, false], "of a hidden effect alone");
        let keys: Vec<&str> = in_turn.iter().map(|outcome| outcome.key.as_str()).collect();
        assert_eq!(keys, cases.iter().map(Case::to_string).collect::<Vec<_>>());
    }

    #[test]
    fn a_cancelled_run_returns_what_is_done() {
        struct Impatient(AtomicUsize);
        impl Observer for Impatient {
            fn cancelled(&self) -> bool {
                self.0.load(Ordering::Relaxed) > 0
            }
        }
        let observer = Impatient(AtomicUsize::new(0));
        let after_first = |_: &Case, _: &Result<Outcome, Unmade>| {
            observer.0.fetch_add(1, Ordering::Relaxed);
        };
        let results = run_all(&cases(), &settings(1), &observer, &after_first).unwrap();
        assert_eq!(results.len(), 1);
    }
}
