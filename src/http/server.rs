//! Serving until the process is asked to stop.

use std::sync::Arc;
use std::time::Duration;

use axum::Router;
use tokio::net::TcpListener;

use crate::service::Signals;

/// Answers requests until `signals` say that the process stops; requests under
/// way then have `drain` to end.
///
/// # Errors
/// When the listener fails.
pub async fn serve(
    listener: TcpListener,
    app: Router,
    signals: Arc<Signals>,
    drain: Duration,
) -> std::io::Result<()> {
    let stopping = Arc::clone(&signals);
    let server =
        axum::serve(listener, app).with_graceful_shutdown(async move { stopping.stopped().await });
    tokio::select! {
        served = server => served,
        () = async {
            signals.stopped().await;
            tokio::time::sleep(drain).await;
        } => Ok(()),
    }
}
