//! Watches the progress of a diagnosis: how steadily the fraction moves, how good the estimates of
//! the time left are, and how soon a cancellation is obeyed.
//!
//! `cargo run --release -p servoscope-core --example progress FILE [CANCEL_AFTER_S]`

use std::sync::Mutex;
use std::time::Instant;

use servoscope_core::answers::Progress;
use servoscope_core::diagnose::diagnose;
use servoscope_core::identify::IdentifyRequest;
use servoscope_core::measurement::formats::{Source, read};
use servoscope_core::observer::Observer;

/// Estimates are judged at every tenth of a second.
const STEP_S: f64 = 0.1;

/// A difference from the truth that counts as right, seconds: near the end no factor matters.
const NEGLIGIBLE_S: f64 = 2.0;

/// Keeps every report with its time, and cancels after a while.
struct Log {
    began: Instant,
    cancel_after_s: f64,
    reports: Mutex<Vec<(f64, Progress)>>,
}

impl Observer for Log {
    fn elapsed_s(&self) -> f64 {
        self.began.elapsed().as_secs_f64()
    }

    fn progress(&self, progress: Progress) {
        self.reports.lock().unwrap().push((self.elapsed_s(), progress));
    }

    fn cancelled(&self) -> bool {
        self.elapsed_s() > self.cancel_after_s
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let path = std::env::args().nth(1).ok_or("give the file of a measurement")?;
    let cancel_after_s = std::env::args().nth(2).map_or(Ok(f64::INFINITY), |text| text.parse())?;
    let bytes = std::fs::read(&path)?;
    let measurement = read(&[Source { name: &path, bytes: &bytes }])?;
    let log = Log { began: Instant::now(), cancel_after_s, reports: Mutex::default() };
    let answer = diagnose(&measurement, &IdentifyRequest::default(), &log);
    let took_s = log.elapsed_s();
    let reports = log.reports.into_inner()?;
    let mut stage = "";
    for (at, progress) in &reports {
        if progress.stage != stage {
            stage = &progress.stage;
            println!("{at:6.1} s {:5.1} %  {stage}", 100.0 * progress.fraction);
        }
    }
    if answer.is_err() {
        println!("ended {:.3} s after it was cancelled", took_s - cancel_after_s);
        return Ok(());
    }
    println!("{took_s:6.1} s in all");
    let (stood_s, at) = longest_standstill(&reports, took_s);
    println!("the fraction stood still for {stood_s:.1} s at most, from {at:.1} s on");
    let (shown, right) = judged(&reports, took_s);
    println!("the time left was shown for {:.0} % of the time", 100.0 * shown);
    println!("and within a factor of two of the truth for {:.0} % of that", 100.0 * right);
    Ok(())
}

/// The longest time without a larger fraction, and when it began, seconds.
fn longest_standstill(reports: &[(f64, Progress)], took_s: f64) -> (f64, f64) {
    let (mut since, mut fraction, mut longest) = (0.0, -1.0, (0.0, 0.0));
    let reached = reports.iter().map(|(at, progress)| (*at, progress.fraction));
    for (at, reached) in reached.chain([(took_s, f64::INFINITY)]) {
        if reached > fraction {
            longest = if at - since > longest.0 { (at - since, since) } else { longest };
            (since, fraction) = (at, reached);
        }
    }
    longest
}

/// The share of the time for which an estimate was shown, and the share of that for which it was
/// within a factor of two of the truth.
fn judged(reports: &[(f64, Progress)], took_s: f64) -> (f64, f64) {
    let (mut times, mut shown, mut right) = (0.0, 0.0, 0.0);
    let mut next = 0;
    for step in 0..(took_s / STEP_S) as usize {
        let now = step as f64 * STEP_S;
        next += reports[next..].iter().take_while(|(at, _)| *at <= now).count();
        times += 1.0;
        let latest = next.checked_sub(1).and_then(|latest| reports[latest].1.remaining_s);
        let Some(estimate) = latest else { continue };
        let left = took_s - now;
        shown += 1.0;
        let near = (estimate - left).abs() <= NEGLIGIBLE_S;
        right += f64::from(near || (0.5 * left..=2.0 * left).contains(&estimate));
    }
    (shown / f64::max(times, 1.0), right / f64::max(shown, 1.0))
}
