//! `servoscope keys`: who may do what, on the data of a server, also while it runs.

use std::sync::Arc;

use jiff::{Timestamp, ToSpan as _};

use crate::service::{BuiltIn, Key, NewKey, Quotas, Scope, Service, Signals, Token};

use super::choice::one_of;
use super::place::{Folder, Place};
use super::{Failure, terminal};

/// Subcommands of `keys`.
#[derive(Debug, clap::Subcommand)]
pub(super) enum Command {
    /// Makes a key and prints it, this once.
    Add(Add),
    /// Lists every key: what it may do, and when it was made, used and ended.
    List(Folder),
    /// Revokes a key for good; what it made stays.
    Revoke(One),
    /// Gives a key another secret and prints the new key, this once; its data and scopes stay.
    Rotate(One),
    /// Gives a key quotas in place of the settings of the server; what is not named stays.
    Limit(Limit),
    /// Prints a new key that is stored nowhere, as for the environment of a container.
    Generate,
}

/// Arguments of `keys add`.
#[derive(Debug, clap::Args)]
#[group(skip)]
pub(super) struct Add {
    /// Its name, for people: who or what will hold it.
    #[arg(long, value_name = "NAME")]
    name: String,
    /// What it may do; repeated, or separated by commas.
    #[arg(long = "scope", value_name = "SCOPE", value_delimiter = ',', required = true)]
    #[arg(value_parser = one_of::<Scope>(Scope::ALL.map(Scope::name)))]
    scopes: Vec<Scope>,
    /// Days after which it expires [default: never].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    days: Option<u16>,
    #[command(flatten)]
    limits: Limits,
    #[command(flatten)]
    folder: Folder,
}

/// What a key may have.
#[derive(Debug, clap::Args)]
#[group(skip)]
#[command(next_help_heading = "What the key may have")]
struct Limits {
    /// Measurements that it keeps; a number, or `server` for what the server gives every key
    /// [default: as it was; of a new key `server`].
    #[arg(long, value_name = "N", value_parser = most)]
    measurements: Option<Most>,
    /// Mebibytes of measurements that it keeps, or `server` [default: as it was; of a new key
    /// `server`].
    #[arg(long, value_name = "MIB", value_parser = most)]
    mib: Option<Most>,
    /// Jobs of it that wait or run, or `server` [default: as it was; of a new key
    /// `server`].
    #[arg(long, value_name = "N", value_parser = most)]
    jobs: Option<Most>,
    /// Minutes that its jobs run within 24 hours, or `server` [default: as it was; of a new key
    /// `server`].
    #[arg(long, value_name = "MINUTES", value_parser = most)]
    compute_minutes: Option<Most>,
    /// Requests that it sends a minute, or `server` [default: as it was; of a new key
    /// `server`].
    #[arg(long, value_name = "N", value_parser = most)]
    requests_per_minute: Option<Most>,
}

/// A quota, or that of the server.
#[derive(Debug, Clone, Copy)]
struct Most(Option<usize>);

fn most(text: &str) -> Result<Most, String> {
    match text {
        "server" => Ok(Most(None)),
        number => {
            let most = number.parse().map(|most| Most(Some(most)));
            most.map_err(|_| "it is neither a number nor `server`".to_owned())
        }
    }
}

impl Limits {
    /// Quotas with those that are named in place of what they were.
    fn over(&self, old: Quotas) -> Quotas {
        let of = |named: Option<Most>, old| named.map_or(old, |Most(most)| most);
        Quotas {
            measurements: of(self.measurements, old.measurements),
            mib: of(self.mib, old.mib),
            jobs: of(self.jobs, old.jobs),
            compute_minutes: of(self.compute_minutes, old.compute_minutes),
            requests_per_minute: of(self.requests_per_minute, old.requests_per_minute),
        }
    }
}

/// Arguments of `keys limit`.
#[derive(Debug, clap::Args)]
#[group(skip)]
pub(super) struct Limit {
    #[command(flatten)]
    one: One,
    #[command(flatten)]
    limits: Limits,
}

/// Arguments of commands for one key.
#[derive(Debug, clap::Args)]
#[group(skip)]
pub(super) struct One {
    /// Id of the key, as `keys list` shows it.
    id: String,
    #[command(flatten)]
    folder: Folder,
}

/// The service on what is stored somewhere.
async fn service(place: &Place) -> Result<Service, Failure> {
    place.must_exist()?;
    service_or_new(place).await
}

/// The same, made where it is not there yet.
async fn service_or_new(place: &Place) -> Result<Service, Failure> {
    let store = place.open().await?;
    Ok(Service::new(store, Arc::new(BuiltIn), Arc::new(Signals::default())))
}

/// Does what was asked of the keys.
pub(super) fn run(command: Command) -> Result<(), Failure> {
    let runtime = tokio::runtime::Runtime::new().map_err(Failure::other)?;
    runtime.block_on(done(command))
}

async fn done(command: Command) -> Result<(), Failure> {
    match command {
        Command::Add(Add { name, scopes, days, limits, folder }) => {
            let now = Timestamp::now();
            let end = days.map(|days| now.checked_add((24 * i64::from(days)).hours()));
            let end = end.transpose().map_err(Failure::input)?;
            let expires_at_ms = end.map(Timestamp::as_millisecond);
            let service = service_or_new(&folder.place()?).await?;
            let quotas = limits.over(Quotas::default());
            let added = service.add_key(NewKey { name, scopes, expires_at_ms, quotas }).await?;
            made(&added, &folder.place()?)
        }
        Command::List(folder) => listed(&service(&folder.place()?).await?.keys().await?),
        Command::Revoke(One { id, folder }) => {
            Ok(service(&folder.place()?).await?.revoke_key(&id).await?)
        }
        Command::Rotate(One { id, folder }) => {
            let rotated = service(&folder.place()?).await?.rotate_key(&id).await?;
            made(&rotated, &folder.place()?)
        }
        Command::Limit(Limit { one: One { id, folder }, limits }) => {
            let service = service(&folder.place()?).await?;
            let quotas = limits.over(service.key(&id).await?.quotas);
            let key = service.limit_key(&id, &quotas).await?;
            terminal::print(&format!("key {id} ({}): {}\n", key.name, quotas_of(&key)))
        }
        Command::Generate => {
            let token = Token::generate();
            let token = token.ok_or_else(|| Failure::other("the system has no random numbers"))?;
            terminal::print(&format!("{}\n", token.text()))
        }
    }
}

/// The key alone on standard output, for a program; what it is beside it, for a person.
fn made((key, token): &(Key, Token), place: &Place) -> Result<(), Failure> {
    let Key { id, name, .. } = key;
    let end = key.expires_at_ms.map_or("never".to_owned(), time);
    eprintln!("key {id} ({name}) in {place}: {}; expires: {end}", scopes(key));
    eprintln!("It is shown only once:");
    terminal::print(&format!("{}\n", token.text()))
}

fn listed(keys: &[Key]) -> Result<(), Failure> {
    let titles = ["id", "state", "made", "expires", "last used", "scopes", "quotas", "name"];
    let mut rows = vec![titles.map(str::to_owned)];
    rows.extend(keys.iter().map(|key| {
        let state = match (key.valid, key.revoked_at_ms) {
            (true, _) => "valid",
            (false, Some(_)) => "revoked",
            (false, None) => "expired",
        };
        let or = |at: Option<i64>, none: &str| at.map_or(none.to_owned(), time);
        [
            key.id.clone(),
            state.to_owned(),
            time(key.created_at_ms),
            or(key.expires_at_ms, "never"),
            or(key.used_at_ms, "never"),
            scopes(key),
            quotas_of(key),
            key.name.clone(),
        ]
    }));
    let widths: Vec<usize> = (0..titles.len())
        .map(|i| rows.iter().map(|row| row[i].chars().count()).max().unwrap_or_default())
        .collect();
    let line = |row: &[String; 8]| {
        let cells = row.iter().zip(&widths).map(|(cell, width)| format!("{cell:width$}"));
        format!("{}\n", cells.collect::<Vec<_>>().join("  ").trim_end())
    };
    terminal::print(&rows.iter().map(line).collect::<String>())
}

fn scopes(key: &Key) -> String {
    key.scopes.iter().map(|scope| scope.name()).collect::<Vec<_>>().join(",")
}

/// The quotas of its own.
fn quotas_of(key: &Key) -> String {
    let set = key.quotas.entries().into_iter().filter_map(|(name, most)| Some((name, most?)));
    let set: Vec<_> = set.map(|(name, most)| format!("{name}={most}")).collect();
    if set.is_empty() { "server".into() } else { set.join(",") }
}

/// To the minute, UTC.
fn time(millis: i64) -> String {
    let time = Timestamp::from_millisecond(millis).map(|time| time.to_string());
    let time = time.unwrap_or_default();
    format!("{}Z", time.get(..16).unwrap_or_default())
}
