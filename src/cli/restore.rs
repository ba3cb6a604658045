//! `servoscope restore`: an empty folder or database filled from a backup.

use std::fs::File;
use std::path::PathBuf;

use crate::store::{BackupError, Reader};

use super::Failure;
use super::place::Folder;

/// Arguments of `restore`.
#[derive(Debug, clap::Args)]
#[group(skip)]
pub(super) struct Args {
    /// File that `servoscope backup` has written.
    #[arg(value_name = "FILE")]
    backup: PathBuf,
    #[command(flatten)]
    folder: Folder,
}

/// Restores a backup.
pub(super) fn run(args: &Args) -> Result<(), Failure> {
    let path = &args.backup;
    let file = File::open(path).map_err(|error| Failure::unread(path, &error))?;
    let unusable = |error| match error {
        BackupError::File(error) => Failure::unread(path, &error),
        error => Failure::Input(format!("{}: {error}", path.display())),
    };
    let mut reader = Reader::new(file).map_err(unusable)?;
    let runtime = tokio::runtime::Runtime::new().map_err(Failure::other)?;
    runtime.block_on(async {
        let place = args.folder.place()?;
        let _held = place.hold()?;
        let store = place.open().await?;
        store.restore(&mut reader).await.map_err(|error| match error {
            BackupError::Store(_) => Failure::Other(format!("cannot fill {place}: {error}")),
            BackupError::NotEmpty(_) => Failure::Input(format!("{place}: {error}")),
            error => unusable(error),
        })?;
        eprintln!("{place} holds what is in {}: {}", path.display(), reader.rows());
        Ok(())
    })
}
