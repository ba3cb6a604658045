//! What happens to a job, followed live and again.

use std::io::{BufRead, BufReader, Read};

use super::*;

/// A read event: number, name, data.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Event {
    pub(super) number: Option<u64>,
    pub(super) name: String,
    pub(super) data: Value,
}

/// Reads events until `enough` or the end of the stream.
fn events(answer: Response<Body>, enough: impl Fn(&[Event]) -> bool) -> Vec<Event> {
    assert_eq!(answer.status(), 200);
    assert_eq!(header(&answer, "content-type"), "text/event-stream");
    let mut events = Vec::new();
    let (mut number, mut name, mut data) = (None, String::new(), None);
    let reader: Box<dyn Read> = Box::new(answer.into_body().into_reader());
    for line in BufReader::new(reader).lines() {
        let line = line.expect("the stream ends in good order");
        match line.split_once(": ") {
            Some(("id", text)) => number = Some(text.parse().expect("a number")),
            Some(("event", text)) => name = text.to_owned(),
            Some(("data", text)) => data = Some(serde_json::from_str(text).expect("JSON")),
            _ if line.is_empty() && data.is_some() => {
                let data = data.take().unwrap();
                events.push(Event { number: number.take(), name: std::mem::take(&mut name), data });
                if enough(&events) {
                    break;
                }
            }
            _ => {}
        }
    }
    events
}

fn follow(server: &Server, id: &str, after: Option<u64>) -> Response<Body> {
    let request = server.agent.get(format!("{}/v1/jobs/{id}/events", server.address));
    match after {
        Some(number) => request.header("last-event-id", number.to_string()).call().unwrap(),
        None => request.call().unwrap(),
    }
}

fn numbers(events: &[Event]) -> Vec<u64> {
    events.iter().filter_map(|event| event.number).collect()
}

#[test]
fn a_job_is_followed_from_its_first_row_to_exactly_one_end() {
    let server = Server::start();
    let id = server.job(RUN_UNTIL_CANCELLED);
    let stream = follow(&server, &id, None);
    let cancelling = std::thread::scope(|scope| {
        let reading = scope.spawn(|| events(stream, |_| false));
        // The first row is stored with a heartbeat: cancelled before, there is none.
        while json_of(server.get(&format!("/v1/jobs/{id}/convergence")), 200)["rows"] == json!([]) {
            std::thread::sleep(Duration::from_millis(10));
        }
        json_of(server.post(&format!("/v1/jobs/{id}/cancel"), &[], b""), 202);
        reading.join().unwrap()
    });
    assert_eq!(numbers(&cancelling), [1, 2]);
    let row = cancelling.iter().find(|event| event.name == "convergence").unwrap();
    assert_eq!((row.number, &row.data["best"]), (Some(1), &json!(0.125)));
    let end = cancelling.last().unwrap();
    assert_eq!((end.name.as_str(), end.number), ("end", Some(2)));
    assert_eq!(end.data["status"], "cancelled");
    assert_eq!(cancelling.iter().filter(|event| event.name == "end").count(), 1);
    let running = cancelling.iter().any(|event| event.data["status"] == "running");
    assert!(running, "nothing was said while it ran: {cancelling:?}");
    let left = cancelling.iter().any(|event| event.data["progress"]["remaining_s"] == 12.5);
    assert!(left, "the time left was not said: {cancelling:?}");
}

#[test]
fn a_running_job_says_how_long_it_still_takes_and_an_ended_one_does_not() {
    let server = Server::start();
    let id = server.job(RUN_UNTIL_CANCELLED);
    let running = loop {
        let job = json_of(server.get(&format!("/v1/jobs/{id}")), 200);
        // Progress is stored with a heartbeat.
        if job["progress"] != Value::Null {
            break job;
        }
        std::thread::sleep(Duration::from_millis(10));
    };
    let progress = json!({
        "stage": "searching", "done": 1, "total": 2, "fraction": 0.5, "remaining_s": 12.5,
    });
    assert_eq!(running["progress"], progress);
    json_of(server.post(&format!("/v1/jobs/{id}/cancel"), &[], b""), 202);
    let ended = server.ended(&id);
    assert_eq!(ended["status"], "cancelled");
    assert_eq!(ended["progress"]["remaining_s"], Value::Null);
}

#[test]
fn events_are_repeated_after_the_last_one_that_was_seen() {
    let server = Server::start();
    let id = server.job(SUCCEED);
    server.ended(&id);
    let all = events(follow(&server, &id, None), |_| false);
    assert_eq!(numbers(&all), [1, 2]);
    let rest = events(follow(&server, &id, Some(1)), |_| false);
    assert_eq!(numbers(&rest), [2]);
    assert_eq!(rest[0].data["status"], "succeeded");
    assert_eq!(follow(&server, &id, Some(2)).status(), 204, "the end was seen");
    let request = server.agent.get(format!("{}/v1/jobs/{id}/events", server.address));
    problem(request.header("last-event-id", "yesterday").call().unwrap(), 400);
    problem(server.get("/v1/jobs/nobody/events"), 404);
}

#[test]
fn a_stream_closes_without_an_end_when_its_job_is_deleted_or_the_server_stops() {
    let server = Server::start();
    let id = server.job(RUN_UNTIL_CANCELLED);
    let stream = follow(&server, &id, None);
    assert_eq!(server.delete(&format!("/v1/jobs/{id}")), 204);
    assert!(events(stream, |_| false).iter().all(|event| event.name != "end"));

    let id = server.job(RUN_UNTIL_CANCELLED);
    let stream = follow(&server, &id, None);
    server.signals.stop();
    assert!(events(stream, |_| false).iter().all(|event| event.name != "end"));
}
