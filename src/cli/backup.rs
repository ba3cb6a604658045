//! `servoscope backup`: everything that a server keeps as one file.

use std::fs::{File, OpenOptions};
use std::io::{self, BufWriter};
use std::os::unix::fs::OpenOptionsExt as _;
use std::path::{Path, PathBuf};

use crate::store::{BackupError, Rows, Store, Writer};

use super::Failure;
use super::place::Folder;

/// Arguments of `backup`.
#[derive(Debug, clap::Args)]
#[group(skip)]
pub(super) struct Args {
    /// File to write; one of this name is replaced once the new one is whole.
    #[arg(value_name = "FILE")]
    backup: PathBuf,
    #[command(flatten)]
    folder: Folder,
}

/// Writes a backup.
pub(super) fn run(args: &Args) -> Result<(), Failure> {
    let runtime = tokio::runtime::Runtime::new().map_err(Failure::other)?;
    runtime.block_on(async {
        let place = args.folder.place()?;
        let store = place.open_existing().await?;
        let rows = written(&args.backup, store.as_ref()).await?;
        eprintln!("{} holds what is in {place}: {rows}", args.backup.display());
        Ok(())
    })
}

/// Writes a file beside the one that was asked for, and puts it in its place at the end.
async fn written(path: &Path, store: &dyn Store) -> Result<Rows, Failure> {
    let part = part(path);
    // It has the secrets of webhooks: it is for its owner alone.
    let file = OpenOptions::new().write(true).create(true).truncate(true).mode(0o600).open(&part);
    let file = file.map_err(|error| Failure::unwritten(&part, &error))?;
    let written = match save(file, store).await {
        Ok(rows) => put(&part, path).map(|()| rows).map_err(BackupError::File),
        Err(error) => Err(error),
    };
    written.map_err(|error| {
        // What is left of it is of no use; that it cannot be removed changes nothing.
        let _ = std::fs::remove_file(&part);
        match error {
            BackupError::File(error) => Failure::unwritten(path, &error),
            error => Failure::other(error),
        }
    })
}

/// The name of a backup that is not whole yet.
fn part(path: &Path) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push(".part");
    name.into()
}

async fn save(file: File, store: &dyn Store) -> Result<Rows, BackupError> {
    let mut file = BufWriter::new(file);
    let mut writer = Writer::new(&mut file)?;
    store.back_up(&mut writer).await?;
    let rows = writer.finish()?;
    file.get_ref().sync_all().map_err(BackupError::File)?;
    Ok(rows)
}

fn put(part: &Path, path: &Path) -> io::Result<()> {
    std::fs::rename(part, path)?;
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
    File::open(folder.unwrap_or(Path::new(".")))?.sync_all()
}
