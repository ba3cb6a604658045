//! `servoscope serve`

use std::sync::Arc;

use axum::http::HeaderValue;
use tokio::net::TcpListener;
use tracing::info;

use crate::config::ServeConfig;
use crate::notify::{Allowed, Webhooks};
use crate::service::{BuiltIn, Outlets, Quotas, Service, Signals};
use crate::{http, worker};

use super::interrupt::Terminations;
use super::place::Place;
use super::worker::{hand_back, seconds, settings, stop_when_asked};
use super::{Failure, config, demo, logging};

/// Bytes of a mebibyte.
const MIB: usize = 1 << 20;

/// Arguments of `serve`.
#[derive(Debug, clap::Args)]
#[group(skip)]
pub(super) struct Args {
    /// Diagnoses a bundled measurement, prints the answer and where to look at it.
    #[arg(long)]
    demo: bool,
    #[command(flatten)]
    config: config::Args,
}

/// Serves until the process is asked to stop.
pub(super) fn run(args: &Args, verbose: u8) -> Result<(), Failure> {
    let config = ServeConfig::check(args.config.settings()?).map_err(Failure::input)?;
    // What is printed for a stranger is not to drown in requests.
    let level = if args.demo { "warn" } else { "info" };
    logging::start(level, verbose, config.log_format);
    let runtime = tokio::runtime::Runtime::new().map_err(Failure::other)?;
    let served = runtime.block_on(serve(config, args.demo));
    // A file still being read must not delay the end.
    runtime.shutdown_background();
    served
}

async fn serve(config: ServeConfig, demo: bool) -> Result<(), Failure> {
    let terminations = Terminations::new().map_err(Failure::other)?;
    let place = Place::of(&config);
    let _held = place.hold()?;
    let store = place.open().await?;
    let signals = Arc::new(Signals::default());
    let service = Service::new(Arc::clone(&store), Arc::new(BuiltIn), Arc::clone(&signals));
    lock(&service, &config).await?;
    let listener = TcpListener::bind(config.listen)
        .await
        .map_err(|error| Failure::Other(format!("cannot listen on {}: {error}", config.listen)))?;
    let address = listener.local_addr().map_err(Failure::other)?;

    let outlets = Outlets {
        webhooks: Webhooks::new(Allowed::new(config.webhook_allow.clone())),
        broker: config.broker().map_err(Failure::input)?,
    };
    let quotas = Quotas {
        measurements: config.key_measurements,
        mib: config.key_mib,
        jobs: config.key_jobs,
        compute_minutes: config.key_compute_minutes,
        requests_per_minute: Some(config.key_requests_per_minute),
    };
    let most_cost = seconds(config.job_cost_minutes * 60);
    let service = service.telling(outlets).accepting(most_cost).within(quotas);
    let worker =
        worker::start(Arc::clone(&store), service.clone(), Arc::clone(&signals), settings(&config));
    tokio::spawn(worker::relay(Arc::clone(&store), Arc::clone(&signals)));
    tokio::spawn(worker::tell(Arc::clone(&store), service.clone(), Arc::clone(&signals)));
    if let Some(days) = config.keep_days {
        let age = seconds(days * 24 * 3600);
        tokio::spawn(worker::forget(store, Arc::clone(&signals), age));
    }
    stop_when_asked(terminations, Arc::clone(&signals));

    // On standard output, for whoever asked for a free port.
    println!("listening on http://{address}");
    if demo {
        let service = service.clone();
        tokio::spawn(async move {
            if let Err(error) = demo::show(&service, &format!("http://{address}")).await {
                eprintln!("servoscope: the demonstration failed: {error}");
            }
        });
    }
    let origins = config.cors_origins.iter().map(|origin| HeaderValue::from_str(origin));
    let limits = http::Limits {
        sent_bytes: config.max_upload_mib * MIB,
        unpacked_bytes: config.max_unpacked_mib * MIB,
        bodies_bytes: config.max_bodies_mib * MIB,
        pace: http::Pace::default(),
        callers: http::Callers {
            any_host: !config.listen.ip().is_loopback() && config.hosts.is_empty(),
            hosts: config.hosts.clone(),
            origins: origins.collect::<Result<_, _>>().map_err(Failure::input)?,
        },
        keys_always: reached(&config).is_some(),
    };
    let counts = service.metrics().connections().clone();
    let app = http::app(service, limits);
    let keeping = http::Keeping::new(config.max_connections);
    http::serve(listener, app, keeping, Arc::clone(&signals), counts).await;
    signals.stop();
    hand_back(worker).await;
    Ok(())
}

/// Stores the first admin key, where one is given, and sees to it that other machines meet a lock.
async fn lock(service: &Service, config: &ServeConfig) -> Result<(), Failure> {
    if let Some(key) = config.first_admin_key().map_err(Failure::input)?
        && service.import_admin_key(key.reveal()).await?
    {
        info!("the first admin key was stored");
    }
    let place = Place::of(config);
    match reached(config) {
        Some(Reached { how, else_do }) => needs_key(service, &place, &how, else_do).await,
        None => Ok(()),
    }
}

/// How other machines reach a server, and what to do if they are not to.
struct Reached {
    how: String,
    else_do: &'static str,
}

/// Whether other machines reach a server: by its address, or by a name that something in front of it
/// passes on.
fn reached(config: &ServeConfig) -> Option<Reached> {
    let listen = config.listen;
    if !listen.ip().is_loopback() {
        let how = format!("other machines can reach {listen}");
        return Some(Reached { how, else_do: "listen on 127.0.0.1" });
    }
    let mut names = config.hosts.iter().filter(|name| !name.is_empty());
    let name = names.find(|name| !http::is_of_loopback(name))?;
    let how = format!("with `--host {name}` other machines can reach the server through a proxy");
    Some(Reached { how, else_do: "leave that name out" })
}

/// Refuses to begin where other machines would meet no lock.
///
/// # Errors
/// [`Failure::Input`] while no valid key is stored, with how to make one, or what else to do.
pub(super) async fn needs_key(
    service: &Service,
    place: &Place,
    how: &str,
    else_do: &str,
) -> Result<(), Failure> {
    if service.has_valid_key().await? {
        return Ok(());
    }
    let flag = place.flag();
    Err(Failure::Input(format!(
        "{how}, and {place} has no valid key that would keep strangers out; make one with \
         `servoscope keys add --name first --scope admin {flag}`, or give one to `servoscope serve` \
         in the variable SERVOSCOPE_ADMIN_KEY or in a file that SERVOSCOPE_ADMIN_KEY_FILE names, or \
         {else_do}"
    )))
}
