//! Requests to a running server: the first byte chooses the operation, the others are its body, or
//! its query. None is answered with a fault of the server's, and each error is a problem document.
//!
//! A plan is checked and refused: it is computed while its request waits, and costs more than a job may here.
#![no_main]

use std::sync::{Arc, LazyLock};
use std::time::Duration;

use libfuzzer_sys::fuzz_target;
use servoscope::http::{self, Callers, Keeping, Limits, Pace};
use servoscope::service::{BuiltIn, Service, Signals, Token};
use servoscope::store::Sqlite;
use tokio::net::TcpListener;
use tokio::runtime::Runtime;
use ureq::http::{Request, Response};
use ureq::{Agent, Body};

/// What stands for the id of the measurement that the server has.
const PLACE: &str = "MEASUREMENT";

/// What a job may cost: enough for the one measurement, and less than any plan.
const MOST_COST: Duration = Duration::from_secs(2);

const JSON: &str = "application/json";
const FORM: &str = "multipart/form-data; boundary=X";

/// Method, path, and type of the body; where there is none, the bytes are the query.
const OPERATIONS: [(&str, &str, &str); 27] = [
    ("POST", "/v1/jobs", JSON),
    ("POST", "/v1/batches", JSON),
    ("POST", "/v1/webhooks", JSON),
    ("PUT", "/v1/mappings/rig", JSON),
    ("POST", "/v1/keys", JSON),
    ("PUT", "/v1/keys/0123456789abcdef/quotas", JSON),
    ("PATCH", "/v1/measurements/MEASUREMENT", JSON),
    ("POST", "/v1/validations", JSON),
    ("POST", "/v1/session", JSON),
    ("POST", "/v1/measurements", JSON),
    ("POST", "/v1/measurements", FORM),
    ("POST", "/v1/preview", FORM),
    ("GET", "/v1/jobs", ""),
    ("GET", "/v1/measurements", ""),
    ("GET", "/v1/batches", ""),
    ("GET", "/v1/axes", ""),
    ("GET", "/v1/results.json", ""),
    ("GET", "/v1/results.csv", ""),
    ("GET", "/v1/history.json", ""),
    ("GET", "/v1/history.csv", ""),
    ("GET", "/v1/history.svg", ""),
    ("GET", "/v1/measurements/MEASUREMENT", ""),
    ("GET", "/v1/measurements/MEASUREMENT/inspection", ""),
    ("GET", "/v1/mappings", ""),
    ("POST", "/v1/plans", JSON),
    ("POST", "/v1/plans/excitation.csv", JSON),
    ("PUT", "/v1/measurements/MEASUREMENT/reading", JSON),
];

struct Server {
    address: String,
    authorization: String,
    measurement: String,
    agent: Agent,
    _runtime: Runtime,
}

static SERVER: LazyLock<Server> = LazyLock::new(|| {
    let runtime = Runtime::new().expect("threads can be started");
    let folder = std::env::temp_dir().join(format!("servoscope-fuzz-{}", std::process::id()));
    let signals = Arc::new(Signals::default());
    let token = Token::generate().expect("the system has random numbers").text();
    let address = runtime.block_on(async {
        let store = Arc::new(Sqlite::open(&folder).await.expect("an empty folder"));
        let service = Service::new(store, Arc::new(BuiltIn), Arc::clone(&signals));
        let service = service.accepting(MOST_COST);
        service.import_admin_key(&token).await.expect("it was generated");
        let limits = Limits {
            sent_bytes: 1 << 20,
            unpacked_bytes: 1 << 20,
            bodies_bytes: 1 << 26,
            pace: Pace::default(),
            callers: Callers::default(),
            keys_always: true,
        };
        let listener = TcpListener::bind("127.0.0.1:0").await.expect("a free port");
        let address = listener.local_addr().expect("it is bound");
        let counts = service.metrics().connections().clone();
        let app = http::app(service, limits);
        tokio::spawn(http::serve(listener, app, Keeping::new(100), signals, counts));
        format!("http://{address}")
    });
    let agent = Agent::config_builder().http_status_as_error(false);
    let agent = agent.timeout_global(Some(Duration::from_secs(15))).build().into();
    let authorization = format!("Bearer {token}");
    let server =
        Server { address, authorization, measurement: String::new(), agent, _runtime: runtime };
    let table = b"magnitude,omega_rad_s,harmonic,re,im\n1,2,1,0.35,-0.08\n2,2,1,1.28,-0.27\n";
    let mut stored = server.send("POST", "/v1/measurements", "text/csv", table).expect("answered");
    let stored = stored.body_mut().read_to_string().expect("a measurement");
    let id = stored.split("\"id\":\"").nth(1).and_then(|rest| rest.split('"').next());
    Server { measurement: id.expect("it has an id").to_owned(), ..server }
});

impl Server {
    fn send(
        &self,
        method: &str,
        path: &str,
        content_type: &str,
        body: &[u8],
    ) -> Result<Response<Body>, ureq::Error> {
        let request = Request::builder().method(method).uri(format!("{}{path}", self.address));
        let request = request.header("authorization", &self.authorization);
        if content_type.is_empty() {
            return self.agent.run(request.body(()).expect("its path is one"));
        }
        let request = request.header("content-type", content_type);
        self.agent.run(request.body(body.to_vec()).expect("its path is one"))
    }
}

/// Bytes as a query: what cannot stand there is written in hexadecimal.
fn query(bytes: &[u8]) -> String {
    let plain = |byte: u8| byte.is_ascii_alphanumeric() || b"%&=+-._~:".contains(&byte);
    let write = |byte: &u8| match plain(*byte) {
        true => char::from(*byte).to_string(),
        false => format!("%{byte:02X}"),
    };
    bytes.iter().map(write).collect()
}

fuzz_target!(|input: &[u8]| {
    let Some((operation, body)) = input.split_first() else { return };
    let (method, path, content_type) = OPERATIONS[usize::from(*operation) % OPERATIONS.len()];
    let server = &*SERVER;
    let mut path = path.replace(PLACE, &server.measurement);
    let mut body = body.to_vec();
    while let Some(at) = body.windows(PLACE.len()).position(|part| part == PLACE.as_bytes()) {
        body.splice(at..at + PLACE.len(), server.measurement.bytes());
    }
    if content_type.is_empty() {
        path = format!("{path}?{}", query(&body));
    }
    let answer = server.send(method, &path, content_type, &body).expect("it is answered");
    let header = |name: &str| answer.headers().get(name).and_then(|value| value.to_str().ok());
    let (status, location) = (answer.status().as_u16(), header("location").map(str::to_owned));
    assert!(status < 500, "{method} {path}: {status}");
    if status >= 400 {
        assert_eq!(header("content-type"), Some("application/problem+json"), "{method} {path}");
    }
    drop(answer.into_body().read_to_vec());
    // What was made goes again, so that every run finds the same.
    if let Some(location) = location.filter(|_| status < 300) {
        let gone = server.send("DELETE", &location, "", b"").expect("it is answered");
        assert!(gone.status().as_u16() < 500, "DELETE {location}");
    }
});
