//! Serving until the process is asked to stop.

use std::convert::Infallible;
use std::error::Error as _;
use std::io::{self, ErrorKind};
use std::net::IpAddr;
use std::pin::pin;
use std::sync::Arc;
use std::time::Duration;

use axum::Router;
use axum::body::Body;
use axum::extract::Request;
use axum::http::Response;
use hyper::body::Incoming;
use hyper::server::conn::http1;
use hyper::service::service_fn;
use hyper_util::rt::{TokioIo, TokioTimer};
use tokio::net::{TcpListener, TcpStream};
use tokio::task::JoinSet;
use tokio_io_timeout::TimeoutStream;
use tower_service::Service as _;
use tracing::{debug, warn};

use crate::service::{Closed, ConnectionCounts, Signals};

use super::answer::Answer;
use super::connections::{Connections, Place};
use super::shares::Shares;

/// The largest head of a request, bytes.
const HEAD_BYTES: usize = 64 << 10;

/// How long nothing is accepted after the process had no file left for a connection.
const NO_FILE_LEFT: Duration = Duration::from_millis(100);

/// How connections are kept.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Keeping {
    /// So many at once.
    pub connections: usize,
    /// How long one may be open without a whole head of a request.
    pub idle: Duration,
    /// How long a client may take nothing of an answer.
    pub unread: Duration,
    /// How long requests under way have to end once the process stops.
    pub drain: Duration,
}

impl Keeping {
    /// The usual times.
    pub fn new(connections: usize) -> Self {
        Self {
            connections,
            // Longer than browsers and clients pause between two requests.
            idle: Duration::from_secs(75),
            unread: Duration::from_secs(30),
            drain: Duration::from_secs(3),
        }
    }
}

/// Marks a request of a connection that is beyond the limit.
#[derive(Debug, Clone, Copy)]
pub(super) struct Reserved;

/// The address at the other end of a request's connection.
#[derive(Debug, Clone, Copy)]
pub(super) struct Peer(pub(super) IpAddr);

/// Answers requests until `signals` say that the process stops, and counts the connections.
pub async fn serve(
    listener: TcpListener,
    app: Router,
    keeping: Keeping,
    signals: Arc<Signals>,
    counts: ConnectionCounts,
) {
    let connections = Connections::new(keeping.connections);
    let shares = Shares::new(keeping.connections);
    let mut open = JoinSet::new();
    let mut stopped = pin!(signals.stopped());
    loop {
        // Ended ones are forgotten, so that the set does not grow.
        while open.try_join_next().is_some() {}
        let accepted = tokio::select! {
            () = &mut stopped => break,
            accepted = listener.accept() => accepted,
        };
        let (stream, peer) = match accepted {
            Ok((stream, peer)) => (stream, Peer(peer.ip().to_canonical())),
            // The client has gone again.
            Err(error) if error.kind() == ErrorKind::ConnectionAborted => continue,
            Err(error) => {
                warn!(%error, "no connection can be accepted");
                tokio::time::sleep(NO_FILE_LEFT).await;
                continue;
            }
        };
        let place = tokio::select! {
            () = &mut stopped => break,
            place = connections.admit() => place,
        };
        let (app, signals, counts) = (app.clone(), Arc::clone(&signals), counts.clone());
        let of = (peer, Arc::clone(&shares));
        open.spawn(async move {
            let _open = counts.opened(place.reserved);
            if let Some(why) = answer(stream, of, app, keeping, place, signals).await {
                counts.closed(why);
            }
        });
    }
    drop(listener);
    let all = async { while open.join_next().await.is_some() {} };
    let _ = tokio::time::timeout(keeping.drain, all).await;
}

/// Answers the requests of one connection until it ends or has to make room; gives the reason where
/// it was the server that closed it.
async fn answer(
    stream: TcpStream,
    (peer, shares): (Peer, Arc<Shares>),
    app: Router,
    keeping: Keeping,
    place: Place,
    signals: Arc<Signals>,
) -> Option<Closed> {
    // Short answers must not wait for more to be sent with them; an error costs no more than that.
    let _ = stream.set_nodelay(true);
    let mut stream = TimeoutStream::new(stream);
    stream.set_write_timeout(Some(keeping.unread));
    let place = Arc::new(place);
    let requests_of = Arc::clone(&place);
    let service = service_fn(move |request: hyper::Request<Incoming>| {
        let busy = requests_of.busy();
        let mut request: Request = request.map(Body::new);
        request.extensions_mut().insert(peer);
        request.extensions_mut().insert(Arc::clone(&shares));
        if requests_of.reserved {
            request.extensions_mut().insert(Reserved);
        }
        // A router is always ready.
        let answer = app.clone().call(request);
        async move {
            let answer: Result<Response<Body>, Infallible> = answer.await;
            // Its connection is busy until all of it is sent.
            answer.map(|answer| answer.map(|body| Answer::new(body, busy)))
        }
    });
    let connection = http1::Builder::new()
        .timer(TokioTimer::new())
        // Runs from the end of one answer to the whole head of the next request.
        .header_read_timeout(keeping.idle)
        .max_buf_size(HEAD_BYTES)
        .serve_connection(TokioIo::new(Box::pin(stream)), service);
    let mut connection = pin!(connection);
    let mut stopped = pin!(signals.stopped());
    let mut stopping = false;
    loop {
        tokio::select! {
            ended = &mut connection => {
                let error = ended.err()?;
                debug!(%error, "a connection ended badly");
                return timed_out(&error);
            }
            () = place.needed() => return Some(Closed::Room),
            () = &mut stopped, if !stopping => {
                stopping = true;
                connection.as_mut().graceful_shutdown();
            }
        }
    }
}

/// Why a connection was closed that ended with an error, where a time was over.
fn timed_out(error: &hyper::Error) -> Option<Closed> {
    if error.is_timeout() {
        return Some(Closed::Idle);
    }
    let source = error.source().and_then(|source| source.downcast_ref::<io::Error>())?;
    (source.kind() == ErrorKind::TimedOut).then_some(Closed::Unread)
}
