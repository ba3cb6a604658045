//! What an operator watches, counted within this process.

use std::sync::atomic::AtomicU64;
use std::time::Duration;

use prometheus_client::encoding::EncodeLabelSet;
use prometheus_client::encoding::text::encode;
use prometheus_client::metrics::counter::Counter;
use prometheus_client::metrics::family::{Family, MetricConstructor};
use prometheus_client::metrics::gauge::Gauge;
use prometheus_client::metrics::histogram::Histogram;
use prometheus_client::metrics::info::Info;
use prometheus_client::registry::{Registry, Unit};

use crate::store::{QueueState, Status};

use super::connection_counts::ConnectionCounts;

/// Bounds of the classes of request durations, seconds.
const REQUEST_BOUNDS: [f64; 11] =
    [0.001, 0.0025, 0.005, 0.01, 0.025, 0.05, 0.1, 0.5, 2.5, 10.0, 60.0];

/// Bounds of the classes of job durations, seconds.
const JOB_BOUNDS: [f64; 11] = [0.25, 0.5, 1.0, 2.5, 5.0, 10.0, 30.0, 60.0, 300.0, 1800.0, 7200.0];

/// How a job ended.
#[derive(Debug, Clone, PartialEq, Eq, Hash, EncodeLabelSet)]
struct JobEnd {
    kind: String,
    outcome: &'static str,
}

/// Kind of job.
#[derive(Debug, Clone, PartialEq, Eq, Hash, EncodeLabelSet)]
struct Kind {
    kind: String,
}

/// A class of requests.
#[derive(Debug, Clone, PartialEq, Eq, Hash, EncodeLabelSet)]
struct Request {
    method: String,
    route: String,
    status: u16,
}

/// What an attempt to tell somebody came to.
#[derive(Debug, Clone, PartialEq, Eq, Hash, EncodeLabelSet)]
pub(super) struct Told {
    /// `webhook` or `mqtt`.
    pub(super) to: &'static str,
    /// `delivered`, `failed` (it is tried again), `given_up` or `disabled`.
    pub(super) outcome: &'static str,
}

/// Makes histograms with the same bounds.
#[derive(Debug, Clone, Copy)]
struct Bounds([f64; 11]);

impl MetricConstructor<Histogram> for Bounds {
    fn new_metric(&self) -> Histogram {
        Histogram::new(self.0)
    }
}

/// Counters, gauges and histograms of one process.
#[derive(Debug)]
pub struct Metrics {
    registry: Registry,
    jobs_ended: Family<JobEnd, Counter>,
    job_seconds: Family<Kind, Histogram, Bounds>,
    evaluations: Family<Kind, Counter>,
    leases_expired: Counter,
    requests: Family<Request, Histogram, Bounds>,
    queued: Gauge,
    running: Gauge,
    oldest_wait: Gauge<f64, AtomicU64>,
    told: Family<Told, Counter>,
    waiting: Gauge,
    connections: ConnectionCounts,
}

impl Default for Metrics {
    fn default() -> Self {
        let mut registry = Registry::with_prefix("servoscope");
        let jobs_ended = Family::default();
        let job_seconds = Family::new_with_constructor(Bounds(JOB_BOUNDS));
        let evaluations = Family::default();
        let leases_expired = Counter::default();
        let requests = Family::new_with_constructor(Bounds(REQUEST_BOUNDS));
        let (queued, running, oldest_wait) = (Gauge::default(), Gauge::default(), Gauge::default());
        let (told, waiting) = (Family::default(), Gauge::default());
        let build = Info::new([("version", env!("CARGO_PKG_VERSION"))]);
        registry.register("build", "What this is", build);
        registry.register("jobs_queued", "Jobs that wait for a worker", queued.clone());
        registry.register("jobs_running", "Jobs that a worker holds", running.clone());
        registry.register_with_unit(
            "oldest_queued_job_age",
            "How long the oldest job has waited for a worker",
            Unit::Seconds,
            oldest_wait.clone(),
        );
        registry.register("jobs_ended", "Jobs that ended in this process", jobs_ended.clone());
        registry.register_with_unit(
            "job_duration",
            "Time that jobs ran, of their last attempt",
            Unit::Seconds,
            job_seconds.clone(),
        );
        registry.register(
            "evaluations",
            "Simulations of whole measurements that jobs of this process needed",
            evaluations.clone(),
        );
        registry.register(
            "leases_expired",
            "Attempts whose worker stopped without a word",
            leases_expired.clone(),
        );
        registry.register_with_unit(
            "http_request_duration",
            "Time from a request to its answer's first byte",
            Unit::Seconds,
            requests.clone(),
        );
        registry.register(
            "messages",
            "Attempts of this process to tell somebody what happened",
            told.clone(),
        );
        registry.register(
            "messages_waiting",
            "Messages that are not delivered yet",
            waiting.clone(),
        );
        let connections = ConnectionCounts::registered(&mut registry);
        Self {
            registry,
            jobs_ended,
            job_seconds,
            evaluations,
            leases_expired,
            requests,
            queued,
            running,
            oldest_wait,
            told,
            waiting,
            connections,
        }
    }
}

impl Metrics {
    /// A job ended; `ran`: for how long its last attempt ran, where that is known.
    pub fn job_ended(&self, kind: &str, outcome: Status, ran: Option<Duration>) {
        let end = JobEnd { kind: kind.to_owned(), outcome: outcome.name() };
        self.jobs_ended.get_or_create(&end).inc();
        if let Some(ran) = ran {
            let kind = Kind { kind: kind.to_owned() };
            self.job_seconds.get_or_create(&kind).observe(ran.as_secs_f64());
        }
    }

    /// A job needed so many simulations of its measurement.
    pub fn evaluated(&self, kind: &str, evaluations: u64) {
        self.evaluations.get_or_create(&Kind { kind: kind.to_owned() }).inc_by(evaluations);
    }

    /// Workers stopped without a word.
    pub fn leases_expired(&self, leases: u64) {
        self.leases_expired.inc_by(leases);
    }

    /// A request was answered. `route` is the pattern, not the path, which would
    /// make a series of every job.
    pub fn answered(&self, method: &str, route: &str, status: u16, took: Duration) {
        let request = Request { method: method.to_owned(), route: route.to_owned(), status };
        self.requests.get_or_create(&request).observe(took.as_secs_f64());
    }

    /// What is counted of connections.
    pub fn connections(&self) -> &ConnectionCounts {
        &self.connections
    }

    /// Somebody was told something, or not.
    pub(super) fn told(&self, told: Told) {
        self.told.get_or_create(&told).inc();
    }

    /// Everything in the text format of OpenMetrics. `waiting`: messages not yet delivered.
    pub(super) fn text(&self, queue: QueueState, waiting: i64) -> String {
        self.waiting.set(waiting);
        self.queued.set(queue.queued);
        self.running.set(queue.running);
        self.oldest_wait.set(queue.oldest_wait_ms as f64 / 1000.0);
        let mut text = String::new();
        // Writing to a string cannot fail.
        let _ = encode(&mut text, &self.registry);
        text
    }
}

#[cfg(test)]
mod tests {
    use super::super::connection_counts::Closed;
    use super::*;

    #[test]
    fn what_was_counted_is_written_under_conventional_names() {
        let metrics = Metrics::default();
        metrics.job_ended("identify", Status::Succeeded, Some(Duration::from_millis(700)));
        metrics.job_ended("diagnose", Status::Cancelled, None);
        metrics.evaluated("identify", 1832);
        metrics.leases_expired(2);
        metrics.answered("GET", "/v1/jobs/{id}", 200, Duration::from_millis(2));
        metrics.told(Told { to: "mqtt", outcome: "failed" });
        let _open = metrics.connections().opened(false);
        drop(metrics.connections().opened(true));
        metrics.connections().closed(Closed::Room);
        let text = metrics.text(QueueState { queued: 3, running: 1, oldest_wait_ms: 1500 }, 4);
        for line in [
            "servoscope_jobs_queued 3",
            "servoscope_jobs_running 1",
            "servoscope_oldest_queued_job_age_seconds 1.5",
            "servoscope_jobs_ended_total{kind=\"identify\",outcome=\"succeeded\"} 1",
            "servoscope_jobs_ended_total{kind=\"diagnose\",outcome=\"cancelled\"} 1",
            "servoscope_job_duration_seconds_bucket{le=\"1.0\",kind=\"identify\"} 1",
            "servoscope_job_duration_seconds_bucket{le=\"0.5\",kind=\"identify\"} 0",
            "servoscope_evaluations_total{kind=\"identify\"} 1832",
            "servoscope_leases_expired_total 2",
            "servoscope_messages_total{to=\"mqtt\",outcome=\"failed\"} 1",
            "servoscope_messages_waiting 4",
            "servoscope_connections_open 1",
            "servoscope_connections_refused_total 1",
            "servoscope_connections_closed_total{why=\"room\"} 1",
            "servoscope_connections_closed_total{why=\"idle\"} 0",
        ] {
            assert!(text.lines().any(|found| found == line), "{line} is not in\n{text}");
        }
        let class = "method=\"GET\",route=\"/v1/jobs/{id}\",status=\"200\"";
        assert!(text.contains(&format!("_seconds_count{{{class}}} 1")), "{text}");
    }
}
