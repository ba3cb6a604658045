//! Standard output: its width, its colours, and what happens when nobody reads it any more.

use std::io::{ErrorKind, Write};

use super::Failure;

/// Columns where there is no terminal.
const COLUMNS: usize = 100;

/// Columns of the terminal; of lines that go elsewhere, 100.
pub(super) fn width() -> usize {
    let size = rustix::termios::tcgetwinsize(std::io::stdout());
    let columns = size.map_or(0, |size| usize::from(size.ws_col));
    if columns == 0 { COLUMNS } else { columns }
}

/// Prints a text that may have escape sequences for colours: they are taken out where standard
/// output is no terminal, or `NO_COLOR` is set. Whoever reads through a pipe may stop at any line.
///
/// # Errors
/// [`Failure::Other`] where the text cannot be written.
pub(super) fn print(text: &str) -> Result<(), Failure> {
    done(anstream::stdout().write_all(text.as_bytes()))
}

/// The same for bytes as they are.
pub(super) fn print_raw(bytes: &[u8]) -> Result<(), Failure> {
    let mut out = std::io::stdout();
    done(out.write_all(bytes).and_then(|()| out.flush()))
}

fn done(written: std::io::Result<()>) -> Result<(), Failure> {
    match written {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => Err(Failure::other(error)),
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_closed_pipe_is_no_error_and_a_full_disk_is_one() {
        assert!(done(Err(ErrorKind::BrokenPipe.into())).is_ok());
        assert!(done(Err(ErrorKind::StorageFull.into())).is_err());
    }
}
