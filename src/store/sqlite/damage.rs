//! Whether the file of a database is whole, before anything is done with it.
//!
//! SQLite itself notices that pages are missing when it needs them, and goes on with the others: a
//! server would start, and fail at some of its requests. The formats are those of
//! <https://www.sqlite.org/fileformat2.html>.

use std::collections::BTreeSet;
use std::fs::File;
use std::io::{self, ErrorKind, Read as _, Seek as _, SeekFrom};
use std::path::Path;

use crate::store::StoreError;

/// What a database begins with.
const MAGIC: &[u8] = b"SQLite format 3\0";

/// Bytes of what a database and its log begin with, and of what precedes each page in the log.
const HEADER: usize = 100;
const LOG_HEADER: usize = 32;
const FRAME_HEADER: usize = 24;

/// Looks at a database and its log. One that is not there or empty is to be made.
///
/// Only before the process has a connection to it: closing a file lets go of every lock that the
/// process has on it, those of SQLite among them.
pub(super) fn check(file: &Path) -> Result<(), StoreError> {
    // While another process moves pages from the log, a single look may miss some in both.
    match (look(file)?, look(file)?) {
        (Some(_), Some(damage)) => Err(StoreError::Damaged(damage)),
        _ => Ok(()),
    }
}

/// What is wrong, as far as one look shows it.
fn look(file: &Path) -> io::Result<Option<String>> {
    let mut database = match File::open(file) {
        Ok(database) => database,
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(None),
        Err(error) => return Err(error),
    };
    let mut header = [0; HEADER];
    let read = database.read_exact(&mut header);
    let bytes = database.metadata()?.len();
    if bytes == 0 {
        return Ok(None);
    }
    if read.is_err() || !header.starts_with(MAGIC) {
        return Ok(Some("it has been overwritten or cut off".into()));
    }
    let page_bytes = match u64::from(u16::from_be_bytes([header[16], header[17]])) {
        1 => 1 << 16,
        size => size.max(512),
    };
    let pages = number(&header[28..]);
    let there = bytes / page_bytes;
    // A page that is not in the file yet is in the log.
    let logged = logged(&file.with_extension("sqlite3-wal"), page_bytes)?;
    let missing = (there + 1..=u64::from(pages)).filter(|page| !logged.contains(page)).count();
    Ok((missing > 0).then(|| format!("{missing} of its {pages} pages are cut off")))
}

/// Pages in the log that belong to its present run.
fn logged(file: &Path, page_bytes: u64) -> io::Result<BTreeSet<u64>> {
    let mut pages = BTreeSet::new();
    let mut log = match File::open(file) {
        Ok(log) => io::BufReader::new(log),
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(pages),
        Err(error) => return Err(error),
    };
    let (mut header, mut frame) = ([0; LOG_HEADER], [0; FRAME_HEADER]);
    if log.read_exact(&mut header).is_err() {
        return Ok(pages);
    }
    while log.read_exact(&mut frame).is_ok() && frame[8..16] == header[16..24] {
        pages.insert(u64::from(number(&frame)));
        log.seek(SeekFrom::Current(page_bytes as i64))?;
    }
    Ok(pages)
}

/// The number that four bytes are.
fn number(bytes: &[u8]) -> u32 {
    bytes[..4].iter().fold(0, |number, byte| number << 8 | u32::from(*byte))
}
