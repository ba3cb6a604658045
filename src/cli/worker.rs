//! `servoscope worker`: runs jobs of servers that share its database.

use std::net::SocketAddr;
use std::sync::Arc;
use std::time::Duration;

use tokio::net::TcpListener;
use tokio::task::JoinHandle;
use tracing::info;

use crate::config::ServeConfig;
use crate::service::{BuiltIn, Service, Signals};
use crate::{http, worker};

use super::interrupt::Terminations;
use super::place::Place;
use super::serve::needs_key;
use super::{Failure, config, logging};

/// Time that the worker has to hand its jobs back.
const HAND_BACK: Duration = Duration::from_secs(1);

/// Connections for whoever watches.
const WATCHERS: usize = 16;

/// Arguments of `worker`.
#[derive(Debug, clap::Args)]
#[group(skip)]
pub(super) struct Args {
    /// Address at which `/metrics`, `/livez` and `/readyz` of this process answer; port 0 takes a
    /// free one. Where other machines can reach it, `/metrics` needs a key with the scope `metrics`,
    /// and a valid key must be stored at the start [default: none].
    #[arg(long, value_name = "ADDRESS", env = "SERVOSCOPE_METRICS")]
    metrics: Option<SocketAddr>,
    #[command(flatten)]
    config: config::Args,
}

/// Takes jobs until the process is asked to stop.
pub(super) fn run(args: &Args, verbose: u8) -> Result<(), Failure> {
    let config = ServeConfig::check(args.config.settings()?).map_err(Failure::input)?;
    if config.workers == 0 {
        return Err(Failure::input("workers: 0 leaves a worker nothing to do; give it 1 or more"));
    }
    logging::start("info", verbose, config.log_format);
    let runtime = tokio::runtime::Runtime::new().map_err(Failure::other)?;
    let worked = runtime.block_on(work(&config, args.metrics));
    runtime.shutdown_background();
    worked
}

async fn work(config: &ServeConfig, metrics: Option<SocketAddr>) -> Result<(), Failure> {
    let terminations = Terminations::new().map_err(Failure::other)?;
    let place = Place::of(config);
    let store = place.open().await?;
    let signals = Arc::new(Signals::default());
    let service = Service::new(Arc::clone(&store), Arc::new(BuiltIn), Arc::clone(&signals));
    if let Some(address) = metrics.filter(|address| !address.ip().is_loopback()) {
        let how = format!("other machines can reach {address}");
        needs_key(&service, &place, &how, "give `--metrics` an address of the loopback").await?;
    }
    let watched = match metrics {
        Some(address) => Some(watch(address, service.clone(), Arc::clone(&signals)).await?),
        None => None,
    };
    let worker = worker::start(Arc::clone(&store), service, Arc::clone(&signals), settings(config));
    tokio::spawn(worker::relay(store, Arc::clone(&signals)));
    stop_when_asked(terminations, Arc::clone(&signals));
    println!("taking jobs from {place}");
    if let Some(address) = watched {
        println!("metrics at http://{address}/metrics");
    }
    signals.stopped().await;
    hand_back(worker).await;
    Ok(())
}

/// Answers whoever watches, until the process stops; at which address.
async fn watch(
    address: SocketAddr,
    service: Service,
    signals: Arc<Signals>,
) -> Result<SocketAddr, Failure> {
    let listener = TcpListener::bind(address)
        .await
        .map_err(|error| Failure::Other(format!("cannot listen on {address}: {error}")))?;
    let address = listener.local_addr().map_err(Failure::other)?;
    let counts = service.metrics().connections().clone();
    let app = http::watched(service, !address.ip().is_loopback());
    tokio::spawn(http::serve(listener, app, http::Keeping::new(WATCHERS), signals, counts));
    Ok(address)
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
