//! Callers who ask when their schedule says.

use std::thread;
use std::time::{Duration, Instant};

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, Exp};

use super::server;
use super::watched::Watched;

/// What callers are to do.
pub struct Plan {
    /// Questions a second, of all together.
    pub rate: f64,
    /// Callers, each with a connection of its own.
    pub connections: u64,
    /// How long they ask.
    pub duration: Duration,
}

/// What became of their questions.
pub struct Outcome {
    /// Time from the moment for which a question was scheduled to its answer's end,
    /// ascending.
    latencies: Vec<Duration>,
    /// Answers other than 200.
    pub refused: u64,
    /// From the first moment to the last answer.
    pub took: Duration,
}

impl Outcome {
    /// Answers a second.
    pub fn rate(&self) -> f64 {
        self.latencies.len() as f64 / self.took.as_secs_f64()
    }

    /// The time that this share of the answers did not exceed.
    pub fn latency(&self, share: f64) -> Duration {
        let rank = (share * self.latencies.len() as f64).ceil() as usize;
        self.latencies[rank.clamp(1, self.latencies.len()) - 1]
    }
}

/// Asks until the plan is carried out, every question of it, however late.
pub fn run(address: &str, plan: &Plan, watched: &Watched) -> Outcome {
    // Every caller has connected by then.
    let begin = Instant::now() + Duration::from_secs(1);
    let told: Vec<(Vec<Duration>, u64)> = thread::scope(|scope| {
        let callers: Vec<_> = (0..plan.connections)
            .map(|caller| scope.spawn(move || ask(address, plan, watched, begin, caller)))
            .collect();
        callers.into_iter().map(|caller| caller.join().expect("no caller panics")).collect()
    });
    let took = begin.elapsed();
    let refused = told.iter().map(|(_, refused)| refused).sum();
    let mut latencies: Vec<Duration> = told.into_iter().flat_map(|(times, _)| times).collect();
    latencies.sort_unstable();
    Outcome { latencies, refused, took }
}

/// The questions of one caller, at random moments (a Poisson process).
fn ask(
    address: &str,
    plan: &Plan,
    watched: &Watched,
    begin: Instant,
    caller: u64,
) -> (Vec<Duration>, u64) {
    let mut random = ChaCha8Rng::seed_from_u64(caller);
    let gap = Exp::new(plan.rate / plan.connections as f64).expect("a positive rate");
    let agent = server::agent();
    agent.get(format!("{address}/livez")).call().expect("it lives");
    let mut scheduled = begin;
    let (mut latencies, mut refused) = (Vec::new(), 0);
    for turn in caller.. {
        scheduled += Duration::from_secs_f64(gap.sample(&mut random));
        if scheduled > begin + plan.duration {
            break;
        }
        thread::sleep(scheduled.saturating_duration_since(Instant::now()));
        let (job, id) = watched.pick(turn);
        let answer = agent.get(format!("{address}/v1/jobs/{id}")).call();
        let told = answer.ok().and_then(|answer| answer.into_body().read_to_string().ok());
        latencies.push(scheduled.elapsed());
        match told {
            Some(text) => watched.told(job, text),
            None => refused += 1,
        }
    }
    (latencies, refused)
}
