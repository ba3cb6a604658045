//! Everything that the compose file and the files beside it name, held against the repository.

use std::collections::BTreeSet;
use std::path::Path;

use serde_json::Value;

use crate::process::{repository, servoscope};

/// A file of settings of the containers, as JSON.
fn yaml(path: &str) -> Value {
    let text = std::fs::read_to_string(repository(path)).unwrap();
    yaml_serde::from_str(&text).unwrap_or_else(|error| panic!("{path}: {error}"))
}

fn compose() -> Value {
    yaml("deploy/compose.yaml")
}

fn service(name: &str) -> Value {
    let service = compose()["services"][name].clone();
    assert!(service.is_object(), "there is no {name}");
    service
}

fn words(list: &Value) -> Vec<String> {
    let words = list.as_array().into_iter().flatten();
    words.map(|word| word.as_str().unwrap().to_owned()).collect()
}

fn keys(object: &Value) -> Vec<String> {
    object.as_object().into_iter().flatten().map(|(key, _)| key.clone()).collect()
}

/// Lines of the Dockerfile that begin with a word, without it.
fn dockerfile(word: &str) -> Vec<String> {
    let text = std::fs::read_to_string(repository("Dockerfile")).unwrap();
    let lines = text.lines().filter_map(|line| line.strip_prefix(word));
    lines.map(|line| line.trim().to_owned()).collect()
}

/// A path in the folder of the compose file, without what leads back out of it.
fn beside(path: &str) -> std::path::PathBuf {
    repository("deploy").join(Path::new(path))
}

#[test]
fn the_program_takes_every_command_and_variable() {
    let settings = servoscope::config::Settings::default().entries();
    let settings: BTreeSet<String> = settings
        .into_iter()
        .map(|(name, _)| format!("SERVOSCOPE_{}", name.to_uppercase()))
        .collect();
    for name in ["server", "worker"] {
        let service = service(name);
        assert_eq!(service["image"], "servoscope");
        let command = words(&service["command"]);
        let mut arguments: Vec<&str> = command.iter().map(String::as_str).collect();
        arguments.push("--help");
        assert!(servoscope(&arguments).status.success(), "{command:?}");
        for variable in keys(&service["environment"]) {
            assert!(variable == "PGPASSWORD" || settings.contains(&variable), "{variable}");
        }
        let database = service["environment"]["SERVOSCOPE_DATABASE"].as_str().unwrap();
        let postgres = &self::service("postgres")["environment"];
        let [user, name] = ["POSTGRES_USER", "POSTGRES_DB"].map(|one| postgres[one].as_str());
        let expected = format!("postgres://{}@postgres/{}", user.unwrap(), name.unwrap());
        assert_eq!(database, expected);
        assert_eq!(service["environment"]["PGPASSWORD"], postgres["POSTGRES_PASSWORD"]);
        assert_eq!(service["depends_on"]["postgres"]["condition"], "service_healthy");
    }
    assert!(service("postgres")["healthcheck"]["test"].is_array());
    assert_eq!(service("worker")["deploy"]["replicas"], 2);
    assert_eq!(
        service("worker")["healthcheck"]["disable"],
        true,
        "that of the image asks another port"
    );
    assert_eq!(service("server")["environment"]["SERVOSCOPE_WORKERS"], "0");
}

#[test]
fn ports_and_images_are_those_of_the_dockerfile_and_of_each_other() {
    let [port] = dockerfile("EXPOSE").try_into().unwrap();
    let server = service("server");
    assert_eq!(words(&server["ports"]), [format!("{port}:{port}")]);
    let listens = words(&server["command"]).pop().unwrap();
    assert_eq!(listens, format!("0.0.0.0:{port}"));
    let build = &server["build"];
    let built = beside(build["context"].as_str().unwrap());
    assert!(built.join(build["dockerfile"].as_str().unwrap()).is_file());

    let scraped = &yaml("deploy/prometheus.yaml")["scrape_configs"][0];
    assert_eq!(scraped["job_name"], "servoscope", "the alarms name it");
    assert_eq!(words(&scraped["static_configs"][0]["targets"]), [format!("server:{port}")]);
    let workers = &scraped["dns_sd_configs"][0];
    assert_eq!(words(&workers["names"]), ["worker"]);
    let listens = words(&service("worker")["command"]).pop().unwrap();
    assert_eq!(listens, format!("0.0.0.0:{}", workers["port"]));
    let sources = yaml("deploy/grafana/datasources.yaml");
    let [prometheus, infinity] = [&sources["datasources"][0], &sources["datasources"][1]];
    let (_, asked) = prometheus["url"].as_str().unwrap().rsplit_once(':').unwrap();
    assert_eq!(words(&service("prometheus")["ports"]), [format!("127.0.0.1:{asked}:{asked}")]);
    assert_eq!(words(&infinity["jsonData"]["allowedHosts"]), [format!("http://server:{port}")]);
    let types: Vec<&str> =
        [prometheus, infinity].iter().map(|source| source["type"].as_str().unwrap()).collect();
    for dashboard in ["service", "results"] {
        let dashboard = yaml(&format!("docs/grafana/{dashboard}.json"));
        for variable in dashboard["templating"]["list"].as_array().unwrap() {
            let is_source = variable["type"] == "datasource";
            assert!(!is_source || types.contains(&variable["query"].as_str().unwrap()));
        }
    }
    let plugins = &service("grafana")["environment"]["GF_PLUGINS_PREINSTALL"];
    assert_eq!(plugins, &infinity["type"]);
    // Every image has a version but the one that is built here.
    for name in keys(&compose()["services"]) {
        let service = service(&name);
        let image = service["image"].as_str().unwrap();
        assert!(image == "servoscope" || image.contains(':'), "{image}");
    }
}

#[test]
fn every_file_that_is_mounted_is_there_and_is_the_one_that_is_named() {
    let compose = compose();
    let named = |what: &str| -> BTreeSet<String> { keys(&compose[what]).into_iter().collect() };
    let (volumes, secrets) = (named("volumes"), named("secrets"));
    let (mut mounted, mut used) = (BTreeSet::new(), BTreeSet::new());
    for name in keys(&compose["services"]) {
        let service = &compose["services"][&name];
        for volume in words(&service["volumes"]) {
            let mut parts = volume.split(':');
            let (from, to) = (parts.next().unwrap(), parts.next().unwrap());
            if from.starts_with('.') {
                assert!(beside(from).exists(), "{from} is not there");
                assert_eq!(parts.next(), Some("ro"), "{volume}");
                mounted.insert(to.to_owned());
            } else {
                assert!(volumes.contains(from), "{from} is no volume");
            }
        }
        used.extend(words(&service["secrets"]));
    }
    assert_eq!(used, secrets);
    let ignored = std::fs::read_to_string(repository(".gitignore")).unwrap();
    assert!(["deploy/.env", "deploy/secrets"].iter().all(|one| ignored.lines().any(|l| l == *one)));

    let prometheus = yaml("deploy/prometheus.yaml");
    let config = words(&service("prometheus")["command"]).pop().unwrap();
    assert!(mounted.contains(config.strip_prefix("--config.file=").unwrap()));
    assert!(words(&prometheus["rule_files"]).iter().all(|rules| mounted.contains(rules)));
    let provider = &yaml("deploy/grafana/dashboards.yaml")["providers"][0];
    assert!(mounted.contains(provider["options"]["path"].as_str().unwrap()));
    let secret = |name: &str| format!("/run/secrets/{name}");
    let given = |name: &str| words(&service(name)["secrets"]).into_iter().map(|one| secret(&one));
    let credentials = &prometheus["scrape_configs"][0]["authorization"]["credentials_file"];
    assert!(given("prometheus").any(|one| credentials == &one));
    let sources = yaml("deploy/grafana/datasources.yaml");
    let token = &sources["datasources"][1]["secureJsonData"]["bearerToken"];
    assert!(given("grafana").any(|one| token == &format!("$__file{{{one}}}")));
    let key = &service("server")["environment"]["SERVOSCOPE_ADMIN_KEY_FILE"];
    assert!(given("server").any(|one| key == &one));
}
