//! The jobs that callers ask about: those that run and the next ones.

use std::collections::BTreeMap;
use std::sync::{Mutex, MutexGuard};

use serde_json::Value;

/// Jobs that are asked about at the same time: twice as many as run on two cores,
/// so that each is seen to wait, to run, to come further and to end.
const WINDOW: usize = 4;

/// A queue as its callers see it.
pub struct Watched {
    state: Mutex<State>,
}

struct State {
    jobs: Vec<String>,
    /// What was last said of each job in the window, by its position.
    window: BTreeMap<usize, String>,
    next: usize,
    seen: Seen,
}

/// What answers said.
#[derive(Debug, Clone, Copy, Default)]
pub struct Seen {
    /// Answers that differ from the one before about the same job.
    pub changed: u64,
    /// Answers about jobs that wait.
    pub queued: u64,
    /// Answers about jobs that run.
    pub running: u64,
    /// Answers about jobs that have ended.
    pub ended: u64,
}

impl Watched {
    /// Watches jobs in the order in which they run.
    pub fn new(jobs: Vec<String>) -> Self {
        let window = (0..WINDOW.min(jobs.len())).map(|job| (job, String::new())).collect();
        let state = State { jobs, window, next: WINDOW, seen: Seen::default() };
        Self { state: Mutex::new(state) }
    }

    /// The job that the `turn`-th question is about: its position and its id.
    pub fn pick(&self, turn: u64) -> (usize, String) {
        let state = self.state();
        let turn = turn as usize % state.window.len();
        let job = *state.window.keys().nth(turn).expect("more jobs than end in a run");
        (job, state.jobs[job].clone())
    }

    /// Takes note of an answer; a job that has ended makes room for the next one.
    pub fn told(&self, job: usize, answer: String) {
        let said: Value = serde_json::from_str(&answer).expect("JSON");
        let mut state = self.state();
        let seen = &mut state.seen;
        let ended = match said["status"].as_str() {
            Some("queued") => {
                seen.queued += 1;
                false
            }
            Some("running") => {
                seen.running += 1;
                false
            }
            Some("succeeded") => {
                seen.ended += 1;
                true
            }
            _ => panic!("{answer}"),
        };
        // Another answer may have told its end in the meantime.
        let Some(before) = state.window.get_mut(&job) else { return };
        if *before != answer {
            *before = answer;
            state.seen.changed += 1;
        }
        if ended {
            state.window.remove(&job);
            if state.next < state.jobs.len() {
                let next = state.next;
                state.window.insert(next, String::new());
                state.next += 1;
            }
        }
    }

    /// What answers have said.
    pub fn seen(&self) -> Seen {
        self.state().seen
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().expect("no caller panics")
    }
}
