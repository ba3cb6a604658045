//! A measurement looked at before anything is computed of it.

use super::*;

#[test]
fn a_measurement_says_what_it_can_show_and_again_without_computing() {
    let server = Server::start();
    let id = server.measurement();
    let path = format!("/v1/measurements/{id}/inspection");
    let found = json_of(server.get(&path), 200);
    assert!(found["doubts"].is_array() && found["detectability"]["effects"].is_array(), "{found}");
    assert_eq!(json_of(server.get(&path), 200), found);
    problem(server.get("/v1/measurements/nobody/inspection"), 404);
}

#[test]
fn a_measurement_is_drawn() {
    let server = Server::start();
    let id = server.measurement();
    let path = format!("/v1/measurements/{id}/measured.svg");
    let mut figure = server.get(&path);
    assert_eq!(header(&figure, "content-type"), "image/svg+xml");
    let tag = header(&figure, "etag").to_owned();
    assert!(figure.body_mut().read_to_string().unwrap().contains("Gain"));
    let again = server.agent.get(format!("{}{path}", server.address));
    assert_eq!(again.header("if-none-match", tag.as_str()).call().unwrap().status(), 304);
}
