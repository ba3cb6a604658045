//! `servoscope serve`

use std::net::SocketAddr;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

use tokio::net::TcpListener;
use tracing::info;

use crate::config::{ServeConfig, ServeSettings};
use crate::service::{BuiltIn, Service, Signals};
use crate::store::{Sqlite, Store};
use crate::{http, worker};

use super::Failure;
use super::interrupt::Terminations;

/// Time that requests under way have to end once the process is asked to.
const DRAIN: Duration = Duration::from_secs(3);
/// Time that the worker has to hand its jobs back.
const HAND_BACK: Duration = Duration::from_secs(1);

/// Arguments of `serve`.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    /// Address to listen on; port 0 takes a free one.
    #[arg(long, value_name = "ADDRESS", default_value = "127.0.0.1:8080")]
    listen: SocketAddr,
    /// Allows an address that other machines can reach. The service asks nobody
    /// who they are: something in front of it must.
    #[arg(long)]
    insecure_listen: bool,
    /// Directory of the database; made if it is not there.
    #[arg(long, value_name = "DIR")]
    data_dir: PathBuf,
    /// Largest upload, mebibytes.
    #[arg(long, value_name = "MIB", default_value_t = 64)]
    max_upload_mib: usize,
    /// Jobs that run at once [default: one a core].
    #[arg(long, value_name = "N")]
    workers: Option<usize>,
}

/// Serves until the process is asked to stop.
pub(super) fn run(args: Args) -> Result<(), Failure> {
    let config = ServeConfig::check(ServeSettings {
        listen: args.listen,
        insecure_listen: args.insecure_listen,
        data_dir: args.data_dir,
        max_upload_mib: args.max_upload_mib,
        workers: args.workers,
    })
    .map_err(Failure::input)?;
    let runtime = tokio::runtime::Runtime::new().map_err(Failure::other)?;
    let served = runtime.block_on(serve(config));
    // A file still being read must not delay the end.
    runtime.shutdown_background();
    served
}

async fn serve(config: ServeConfig) -> Result<(), Failure> {
    let mut terminations = Terminations::new().map_err(Failure::other)?;
    let store: Arc<dyn Store> =
        Arc::new(Sqlite::open(&config.data_dir).await.map_err(Failure::other)?);
    let listener = TcpListener::bind(config.listen)
        .await
        .map_err(|error| Failure::Other(format!("cannot listen on {}: {error}", config.listen)))?;
    let address = listener.local_addr().map_err(Failure::other)?;

    let signals = Arc::new(Signals::default());
    let service = Service::new(Arc::clone(&store), Arc::new(BuiltIn), Arc::clone(&signals));
    let settings = worker::Settings::new(config.workers.get());
    let worker = worker::start(store, service.clone(), Arc::clone(&signals), settings);
    let stopping = Arc::clone(&signals);
    tokio::spawn(async move {
        terminations.next().await;
        info!("asked to stop");
        stopping.stop();
    });

    // On standard output, for whoever asked for a free port.
    println!("listening on http://{address}");
    let app = http::app(service, config.max_upload_bytes);
    let served = http::serve(listener, app, Arc::clone(&signals), DRAIN).await;
    signals.stop();
    if tokio::time::timeout(HAND_BACK, worker).await.is_err() {
        info!("a job was not handed back; it is queued again when its lease expires");
    }
    served.map_err(Failure::other)
}
