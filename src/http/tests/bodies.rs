//! Bodies that are too large, packed, cut short or no form.

use crate::service::Upload;
use crate::store::FileRow;

use super::*;

/// 20 000 times `a`, in 55 bytes.
const GZIP_OF_TWICE_THE_LIMIT: &[u8] = b"\x1f\x8b\x08\x00\x00\x00\x00\x00\x02\x03\xed\xc1\x31\x01\x00\x00\x00\xc2\xa0\xac\xeb\x5f\xc2\x1a\x1e\x40\x01\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\xf0\x60\x31\x87\xbd\xca\x20\x4e\x00\x00";

/// The three letters `any`.
const GZIP_OF_ANY: &[u8] =
    b"\x1f\x8b\x08\x00\x00\x00\x00\x00\x02\x03\x4b\xcc\xab\x04\x00\xb4\xf7\xf3\x64\x03\x00\x00\x00";

/// A form with one file of the three letters `any`.
const FORM: &str = "--x\r\ncontent-disposition: form-data; name=\"a\"; filename=\"a.csv\"\r\n\
                    content-type: text/csv\r\n\r\nany\r\n--x--\r\n";

#[test]
fn a_body_too_large_is_refused_as_sent_and_as_unpacked() {
    let server = Server::start();
    let headers = [("content-type", "text/csv")];
    let answer = server.post("/v1/measurements", &headers, &[b'a'; LIMIT + 1]);
    assert!(string(&problem(answer, 413), "detail").contains("10000 bytes"));
    let headers = [("content-type", "text/csv"), ("content-encoding", "gzip")];
    let answer = server.post("/v1/measurements", &headers, GZIP_OF_TWICE_THE_LIMIT);
    problem(answer, 413);
    json_of(server.post("/v1/measurements", &headers, GZIP_OF_ANY), 201);
}

#[test]
fn a_body_that_is_not_the_gzip_it_claims_to_be_is_the_callers_fault() {
    let server = Server::start();
    let mut corrupted = GZIP_OF_ANY.to_vec();
    corrupted[12] ^= 0xff;
    let cut = &GZIP_OF_ANY[..GZIP_OF_ANY.len() - 6];
    let kinds = ["text/csv", "application/json", "multipart/form-data; boundary=x"];
    for path in ["/v1/measurements", "/v1/jobs", "/v1/validations"] {
        for kind in kinds {
            for body in [&corrupted[..], cut, b"no gzip at all"] {
                let headers = [("content-type", kind), ("content-encoding", "gzip")];
                let answer = server.post(path, &headers, body);
                let status = answer.status().as_u16();
                assert!(status == 400 || status == 415, "{path} {kind}: {status}");
                problem(answer, status);
            }
        }
    }
}

#[test]
fn all_members_of_a_gzip_are_read_on_every_route_and_its_name_in_any_case() {
    let server = Server::start();
    let pack = |text: &str| {
        let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::default());
        std::io::Write::write_all(&mut encoder, text.as_bytes()).unwrap();
        encoder.finish().unwrap()
    };
    let halves = |text: &str| {
        let (first, second) = text.split_at(text.len() / 2);
        [pack(first), pack(second)].concat()
    };
    for name in ["gzip", "GZIP", "x-gzip"] {
        for (kind, text) in [("text/csv", "any"), ("multipart/form-data; boundary=x", FORM)] {
            let headers = [("content-type", kind), ("content-encoding", name)];
            let whole = server.post("/v1/measurements", &[headers[0]], text.as_bytes());
            let sha256 = json_of(whole, 201)["sha256"].clone();
            let packed = server.post("/v1/measurements", &headers, &halves(text));
            assert_eq!(json_of(packed, 201)["sha256"], sha256);
            let garbage = [&halves(text)[..], b"garbage"].concat();
            problem(server.post("/v1/measurements", &headers, &garbage), 400);
        }
        let headers = [("content-type", "application/json"), ("content-encoding", name)];
        for path in ["/v1/jobs", "/v1/validations"] {
            let answer = problem(server.post(path, &headers, &halves("{\"none\": 1}")), 422);
            assert!(answer.to_string().contains("none"), "{answer}");
        }
    }
}

#[test]
fn a_form_that_is_cut_short_or_has_another_boundary_is_the_callers_fault() {
    let server = Server::start();
    let post = |boundary: &str, body: &str| {
        let kind = format!("multipart/form-data{boundary}");
        server.post("/v1/measurements", &[("content-type", kind.as_str())], body.as_bytes())
    };
    json_of(post("; boundary=x", FORM), 201);
    for (boundary, body) in [
        ("; boundary=x", &FORM[..FORM.len() - 10]),
        ("; boundary=x", &FORM[..20]),
        ("; boundary=y", FORM),
        ("", FORM),
        ("; boundary=x", ""),
    ] {
        problem(post(boundary, body), 400);
    }
    let huge = FORM.replace("any", &"a".repeat(LIMIT));
    problem(post("; boundary=x", &huge), 413);
}

#[test]
fn bodies_that_take_all_memory_together_are_refused_until_some_are_gone() {
    use std::io::Write;

    // Of so many connections one address may have more busy than there is memory for.
    let server = Server::start_keeping(Vec::new(), Keeping::new(1000));
    let head = "POST /v1/measurements HTTP/1.1\r\nhost: localhost\r\ncontent-type: text/csv\r\n\
                content-length: 9000\r\n\r\n";
    // A piece of memory is larger than the largest body here: each takes one of 64.
    let upload = || {
        let host = server.address.trim_start_matches("http://");
        let mut stream = std::net::TcpStream::connect(host).unwrap();
        stream.write_all(head.as_bytes()).unwrap();
        stream.write_all(&[b'x'; 8000]).unwrap();
        stream
    };
    let mut held: Vec<_> = (0..64).map(|_| upload()).collect();
    let status_becomes = |wanted: u16, before_each: &mut dyn FnMut()| {
        let deadline = Instant::now() + Duration::from_secs(30);
        loop {
            before_each();
            let answer = server.post("/v1/measurements", &[("content-type", "text/csv")], b"any");
            if answer.status() == wanted || Instant::now() > deadline {
                return answer;
            }
            std::thread::sleep(Duration::from_millis(20));
        }
    };
    // What is tried may take the piece of one that is then refused: others come in its place.
    let refused = status_becomes(503, &mut || held.extend([upload(), upload()]));
    assert_eq!(header(&refused, "retry-after"), "5");
    assert!(string(&problem(refused, 503), "detail").contains("memory"));
    drop(held);
    json_of(status_becomes(201, &mut || ()), 201);
}

#[test]
fn a_name_that_is_too_long_is_refused_wherever_it_comes_in() {
    let server = Server::start();
    let long = "x".repeat(1001);
    let form = [("content-type", "multipart/form-data; boundary=x")];
    let named = |from: &str, to: &str| FORM.replace(from, to);
    let part = format!("name=\"{long}\"");
    let mapping =
        format!("--x\r\ncontent-disposition: form-data; name=\"mapping\"\r\n\r\n{long}\r\n{FORM}");
    for path in ["/v1/measurements", "/v1/preview"] {
        for (body, member, words) in [
            (named("a.csv", &long), "files", "the name of file 1 has 1001 bytes"),
            (named("text/csv", &format!("text/{long}")), "files", "the content type of file 1"),
            (named("name=\"a\"; filename=\"a.csv\"", &part), "files", "the name of file 1"),
            (mapping.clone(), "mapping", "1001 bytes, more than 1000"),
        ] {
            let refused = problem(server.post(path, &form, body.as_bytes()), 422);
            assert_eq!(refused["member"], member, "{path}: {refused}");
            assert!(string(&refused, "detail").contains(words), "{path}: {refused}");
        }
        let query = format!("{path}?name={long}");
        let refused = problem(server.post(&query, &[("content-type", "text/csv")], b"any"), 422);
        assert_eq!(refused["member"], "name", "{path}: {refused}");
    }
    assert_eq!(json_of(server.get("/v1/measurements"), 200)["items"], json!([]));

    let longest = "x".repeat(1000);
    let query = format!("/v1/measurements?name={longest}");
    let stored = json_of(server.post(&query, &[("content-type", "text/csv")], b"any"), 201);
    assert_eq!((&stored["name"], &stored["files"]), (&json!(longest), &json!(["upload.csv"])));
}

#[test]
fn a_page_of_a_list_is_small_also_where_the_names_of_files_are_not() {
    let server = Server::start();
    for upload in 0..40 {
        let file = |number: usize| FileRow {
            name: format!("{upload:0>500}{number:0>500}"),
            content_type: "text/csv".into(),
            bytes: b"any".to_vec(),
        };
        let files = (0..64).map(file).collect();
        let upload = Upload { files, ..Upload::default() };
        server.runtime.block_on(server.service.add_measurement(upload, None)).unwrap();
    }
    let (mut query, mut seen) = (String::from("?limit=200"), 0);
    loop {
        let mut answer = server.get(&format!("/v1/measurements{query}"));
        let text = answer.body_mut().read_to_string().unwrap();
        assert!(text.len() < 3 << 20, "{} bytes", text.len());
        let page: Value = serde_json::from_str(&text).unwrap();
        seen += page["items"].as_array().unwrap().len();
        let Some(next) = page["next"].as_str() else { break };
        query = format!("?limit=200&cursor={next}");
    }
    assert_eq!((seen, query.contains("cursor")), (40, true));
}
