//! `servoscope batch`: a folder of measurements, computed by a server.

mod folder;
mod progress;
mod remote;
mod request;
mod table;

use std::path::PathBuf;

use clap::builder::PossibleValuesParser;
use serde_json::{Value, json};
use servoscope_core::answers::Method;
use sha2::{Digest, Sha256};

use crate::config::SecretText;
use crate::service::{MAX_BATCH, hexadecimal};
use crate::store::Priority;

use super::choice::one_of;
use super::interrupt::Terminations;
use super::{Failure, computation, given, terminal};
use folder::Stored;
use progress::Watched;
use remote::{Refusal, Remote, Sent};
use request::{Request, segment};
use table::{Row, Seen};

/// Rows of a page that is asked for.
const PAGE: usize = 200;

/// Arguments of `batch`.
#[derive(Debug, clap::Args)]
#[group(skip)]
pub(super) struct Args {
    /// Folder whose files are uploaded, each as a measurement of its own.
    #[arg(value_name = "DIR", required_unless_present = "resume", conflicts_with = "resume")]
    folder: Option<PathBuf>,
    /// Address of the server, such as `https://servo.example`.
    #[arg(long, value_name = "URL", env = "SERVOSCOPE_SERVER", required = true)]
    server: String,
    /// Key for the server, with the scopes upload, run and read [default: none].
    #[arg(long, value_name = "KEY", env = "SERVOSCOPE_KEY", hide_env_values = true)]
    key: Option<SecretText>,
    /// Takes up an earlier batch again and shows its progress.
    #[arg(long, value_name = "ID")]
    resume: Option<String>,
    /// Name of the batch, for people [default: the name of the folder].
    #[arg(long, value_name = "NAME")]
    name: Option<String>,
    /// What is computed of each measurement.
    #[arg(long, value_name = "KIND", default_value = "diagnose", value_parser = ["identify", "diagnose"])]
    kind: String,
    /// Order of the actuator [default: chosen from the data].
    #[arg(long, value_name = "N", value_parser = one_of::<u8>(["0", "1", "2"]))]
    actuator_order: Option<u8>,
    /// How parameters are estimated [default: abc-ann].
    #[arg(long, value_name = "NAME")]
    #[arg(value_parser = PossibleValuesParser::new(Method::all().map(Method::name)))]
    method: Option<String>,
    /// Priority among your waiting jobs [default: normal].
    #[arg(long, value_name = "NAME", value_parser = Priority::ALL.map(Priority::name))]
    priority: Option<String>,
    /// Further options as a JSON object, such as '{"seed": 7}': the `options` of a job over HTTP
    /// [default: {}].
    #[arg(long, value_name = "JSON")]
    options: Option<String>,
    // A group with a heading of its own comes last: what follows it would stand under it.
    #[command(flatten)]
    given: given::Args,
}

/// Uploads a folder, computes it on the server and prints what came of it.
pub(super) fn run(args: &Args) -> Result<(), Failure> {
    let runtime = tokio::runtime::Runtime::new().map_err(Failure::other)?;
    let done = runtime.block_on(done(args));
    // A question that is still open must not delay the end.
    runtime.shutdown_background();
    done
}

async fn done(args: &Args) -> Result<(), Failure> {
    let mut terminations = Terminations::new().map_err(Failure::other)?;
    let remote = Remote::new(&args.server, args.key.as_ref())?;
    remote.greet().await?;
    let id = match &args.resume {
        Some(id) => id.clone(),
        None => {
            let made = tokio::select! {
                made = made(args, &remote) => made?,
                () = terminations.next() => {
                    return Err(Failure::other(
                        "interrupted; run the same command again to continue",
                    ));
                }
            };
            eprintln!("batch {} of {} measurements", made.id, made.jobs);
            made.id
        }
    };
    let seen = match progress::watch(&remote, &id, &mut terminations).await? {
        Watched::Ended(seen) => *seen,
        Watched::Left => {
            return Err(Failure::Other(format!(
                "batch {id} goes on without this terminal; `servoscope batch --resume {id} --server \
                 {}` shows it again",
                remote.address()
            )));
        }
    };
    let rows = rows(&remote, &id).await?;
    terminal::print(&table::text(&seen, &rows))
}

/// Uploads what can be read and makes the batch.
async fn made(args: &Args, remote: &Remote) -> Result<Seen, Failure> {
    let folder = args.folder.clone().unwrap_or_default();
    // Looked at before anything is uploaded.
    if let Some(text) = &args.options {
        computation::options(text)?;
    }
    let files = folder::files(&folder)?;
    if files.len() > MAX_BATCH {
        return Err(Failure::Input(format!(
            "{} has {} files, and a batch has at most {MAX_BATCH} measurements; move some to \
             another folder",
            folder.display(),
            files.len()
        )));
    }
    let named = folder.canonicalize().unwrap_or(folder.clone());
    let named = named.file_name().map(|name| name.to_string_lossy().into_owned());
    let given = args.given.pairs()?;
    let mut stored = folder::upload(remote, &files, &given).await?;
    let mut body = json!({"name": args.name.clone().or(named), "kind": args.kind});
    if let Some(actuator_order) = args.actuator_order {
        body["plant"] = json!({"actuator_order": actuator_order});
    }
    if let Some(method) = &args.method {
        body["method"] = json!(method);
    }
    if let Some(priority) = &args.priority {
        body["priority"] = json!(priority);
    }
    if let Some(text) = &args.options {
        body["options"] = serde_json::from_str(text).map_err(Failure::input)?;
    }
    loop {
        if stored.is_empty() {
            return Err(Failure::Input(format!(
                "{}: no file in it can be computed",
                folder.display()
            )));
        }
        body["measurement_ids"] = stored.iter().map(|one| one.measurement_id.as_str()).collect();
        let refusal = match remote.json(&submission(&body)).await {
            Ok(made) => return remote::read(made),
            Err(Sent::Refused(refusal)) => refusal,
            Err(other) => return Err(other.into()),
        };
        // One that cannot be computed keeps no other from being computed.
        let Some(place) = unusable(&refusal, stored.len()) else {
            return Err(Sent::Refused(refusal).into());
        };
        let Stored { file, .. } = stored.remove(place);
        let why = refusal.detail.split_once(": ").map_or(refusal.detail.as_str(), |(_, why)| why);
        eprintln!("{file}: left out: {why}");
    }
}

/// The request for a batch. Its key is made of what it says: asked again, it is the same batch.
fn submission(body: &Value) -> Request {
    let text = body.to_string();
    let key = format!("batch-{}", hexadecimal(&Sha256::digest(&text)));
    Request::post("/v1/batches").json(text).keyed(key)
}

/// The place of the one measurement that a refusal is about.
fn unusable(refusal: &Refusal, count: usize) -> Option<usize> {
    let member = refusal.member.as_deref()?.strip_prefix("measurement_ids[")?;
    let place = member.strip_suffix(']')?.parse().ok()?;
    (place < count).then_some(place)
}

/// What came of each measurement.
async fn rows(remote: &Remote, id: &str) -> Result<Vec<Row>, Failure> {
    #[derive(serde::Deserialize)]
    struct List {
        items: Vec<Row>,
        next: Option<String>,
    }
    let mut all = Vec::new();
    let mut cursor = String::new();
    loop {
        let path = format!("/v1/batches/{}/results?limit={PAGE}{cursor}", segment(id));
        let List { items, next } = remote::read(remote.json(&Request::get(path)).await?)?;
        all.extend(items);
        match next {
            Some(next) => cursor = format!("&cursor={next}"),
            None => return Ok(all),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_refusal_of_one_measurement_is_told_from_one_of_all() {
        let refusal = |member: Option<&str>| Refusal {
            detail: String::new(),
            status: 422,
            member: member.map(str::to_owned),
        };
        assert_eq!(unusable(&refusal(Some("measurement_ids[3]")), 4), Some(3));
        assert_eq!(unusable(&refusal(Some("measurement_ids[4]")), 4), None);
        assert_eq!(unusable(&refusal(Some("measurement_ids")), 4), None);
        assert_eq!(unusable(&refusal(Some("options.seed")), 4), None);
        assert_eq!(unusable(&refusal(None), 4), None);
    }
}
