//! `servoscope worker`: runs jobs of servers that share its database.

use std::sync::Arc;
use std::time::Duration;

use tokio::task::JoinHandle;
use tracing::info;

use crate::config::ServeConfig;
use crate::service::{BuiltIn, Service, Signals};
use crate::worker;

use super::interrupt::Terminations;
use super::place::Place;
use super::{Failure, config, logging};

/// Time that the worker has to hand its jobs back.
const HAND_BACK: Duration = Duration::from_secs(1);

/// Takes jobs until the process is asked to stop.
pub(super) fn run(args: &config::Args, verbose: u8) -> Result<(), Failure> {
    let config = ServeConfig::check(args.settings()?).map_err(Failure::input)?;
    if config.workers == 0 {
        return Err(Failure::input("workers: 0 leaves a worker nothing to do; give it 1 or more"));
    }
    logging::start("info", verbose, config.log_format);
    let runtime = tokio::runtime::Runtime::new().map_err(Failure::other)?;
    let worked = runtime.block_on(work(&config));
    runtime.shutdown_background();
    worked
}

async fn work(config: &ServeConfig) -> Result<(), Failure> {
    let terminations = Terminations::new().map_err(Failure::other)?;
    let place = Place::of(config);
    let store = place.open().await?;
    let signals = Arc::new(Signals::default());
    let service = Service::new(Arc::clone(&store), Arc::new(BuiltIn), Arc::clone(&signals));
    let worker = worker::start(Arc::clone(&store), service, Arc::clone(&signals), settings(config));
    tokio::spawn(worker::relay(store, Arc::clone(&signals)));
    stop_when_asked(terminations, Arc::clone(&signals));
    println!("taking jobs from {place}");
    signals.stopped().await;
    hand_back(worker).await;
    Ok(())
}

/// How jobs are run.
pub(super) fn settings(config: &ServeConfig) -> worker::Settings {
    worker::Settings {
        lease: seconds(config.lease_seconds),
        limit: seconds(config.job_minutes * 60),
        wait: seconds(config.retry_seconds),
        ..worker::Settings::new(config.workers)
    }
}

/// Stops whatever waits for `signals` once the process is asked to end.
pub(super) fn stop_when_asked(mut terminations: Terminations, signals: Arc<Signals>) {
    tokio::spawn(async move {
        terminations.next().await;
        info!("asked to stop");
        signals.stop();
    });
}

/// Waits until the jobs in hand are back in the queue.
pub(super) async fn hand_back(worker: JoinHandle<()>) {
    if tokio::time::timeout(HAND_BACK, worker).await.is_err() {
        info!("a job was not handed back; it is queued again when its lease expires");
    }
}

pub(super) fn seconds(count: usize) -> Duration {
    Duration::from_secs(count as u64)
}
