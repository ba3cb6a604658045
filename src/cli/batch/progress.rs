//! Watching a batch until it ends, and what an interrupt means.

use std::io::{IsTerminal, Write};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};

use crate::cli::Failure;
use crate::cli::interrupt::Terminations;

use super::remote::{self, Remote};
use super::request::{Request, segment};
use super::table::Seen;

/// How often the server is asked.
const LOOK_AGAIN: Duration = Duration::from_secs(1);

/// How often a line is printed where there is no terminal.
const LINE: Duration = Duration::from_secs(10);

/// How watching ended.
pub(super) enum Watched {
    /// With the batch.
    Ended(Box<Seen>),
    /// Before it: the batch goes on.
    Left,
}

/// Shows how far a batch has come until it ends. After an interrupt somebody at a terminal is asked
/// whether it goes on; without one it does.
///
/// # Errors
/// Where the server does not answer, or knows of no such batch.
pub(super) async fn watch(
    remote: &Remote,
    id: &str,
    terminations: &mut Terminations,
) -> Result<Watched, Failure> {
    let path = format!("/v1/batches/{}", segment(id));
    let mut shown = Shown::on(remote);
    loop {
        let look = async {
            let seen: Seen = remote::read(remote.json(&Request::get(path.as_str())).await?)?;
            shown.update(&seen);
            if !seen.has_ended() {
                tokio::time::sleep(LOOK_AGAIN).await;
            }
            Ok::<_, Failure>(seen)
        };
        let interrupted = tokio::select! {
            seen = look => {
                let seen = seen?;
                if seen.has_ended() {
                    shown.bar.finish_and_clear();
                    return Ok(Watched::Ended(Box::new(seen)));
                }
                false
            }
            () = terminations.next() => true,
        };
        if interrupted {
            shown.bar.finish_and_clear();
            if leaves_it(terminations).await {
                return Ok(Watched::Left);
            }
            remote.json(&Request::post(format!("{path}/cancel"))).await?;
            eprintln!("cancelled; what runs ends at its next evaluation");
            shown = Shown::on(remote);
        }
    }
}

/// Whether the batch is to go on by itself.
async fn leaves_it(terminations: &mut Terminations) -> bool {
    if !std::io::stdin().is_terminal() || !std::io::stderr().is_terminal() {
        return true;
    }
    eprint!("\nLeave the batch running on the server? [Y/n] ");
    let _ = std::io::stderr().flush();
    let answer = tokio::task::spawn_blocking(|| {
        let mut line = String::new();
        std::io::stdin().read_line(&mut line).map(|_| line)
    });
    tokio::select! {
        answer = answer => !matches!(answer, Ok(Ok(line)) if is_no(&line)),
        // A second interrupt is no answer.
        () = terminations.next() => true,
    }
}

fn is_no(line: &str) -> bool {
    matches!(line.trim().to_ascii_lowercase().as_str(), "n" | "no")
}

/// One line that is written anew on a terminal, and a line now and then elsewhere.
struct Shown {
    bar: ProgressBar,
    printed: Option<(Instant, String)>,
}

impl Shown {
    fn on(remote: &Remote) -> Self {
        let style = ProgressStyle::with_template("[{bar:40}] {msg}");
        let bar = remote.bar(1);
        bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
        Self { bar, printed: None }
    }

    fn update(&mut self, seen: &Seen) {
        let line = seen.progress();
        self.bar.set_length(seen.jobs.unsigned_abs());
        self.bar.set_position(seen.ended().unsigned_abs());
        self.bar.set_message(line.clone());
        if !self.bar.is_hidden() {
            return;
        }
        let due = match &self.printed {
            None => true,
            Some((at, before)) => *before != line && (at.elapsed() >= LINE || seen.has_ended()),
        };
        if due {
            eprintln!("{line}");
            self.printed = Some((Instant::now(), line));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_a_no_cancels_a_batch() {
        assert!(is_no("n\n") && is_no(" No \n"));
        assert!(!is_no("\n") && !is_no("y\n") && !is_no("never mind\n"));
    }
}
