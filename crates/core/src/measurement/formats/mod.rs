//! File formats: parses bytes into a [`Measurement`], or reports what is wrong and where.
//!
//! The format is detected from the content. Every format contains a table of numbers, and the
//! names of its columns tell which kind it is:
//!
//! - **Harmonic table** (CSV): `magnitude`; `omega_rad_s` or `frequency_hz`; `re,im`,
//!   `amplitude,phase_deg`, `gain,phase_deg` or `gain_db,phase_deg`; and optionally `experiment`,
//!   `harmonic`, `std`, `repeat`, `run`, `u_re,u_im`. If the input was measured, `magnitude` may
//!   be missing (it is then half the peak-to-peak value of the input), and a row may contain the
//!   input alone. `std` is in response units and in the amplitude convention of the file, also
//!   next to a gain; where there are repeats, it is that of the single repeat. Instead of `std` a
//!   row may have `coherence` with `averages` (a column or metadata), or `gain_std` or
//!   `gain_db_std` with `phase_std_deg`; these do not depend on the amplitude convention. A row
//!   states its noise in one way at most, but not all rows of a table need the same.
//! - **Time record** (CSV): `time_s`, `input`, `output`, optionally `segment`.
//! - **JSON**: see [below](self#json).
//!
//! A record without a period (none is found in the input, or the file states `period_s: none`) is
//! read as one motion. It can be used for validation but not for fitting. `initial_velocity` and
//! `initial_position` give its initial state, `settle_s` the length of its beginning that is not
//! compared, and `intersample` (`linear` or `hold`) the course of its input between samples.
//!
//! A CSV file may begin with `# key: value` lines of metadata: `input`, `response`, `period_s`,
//! `settle_periods`, `reference`, `amplitude`, `averages`, `loop`, `name`, `machine`, `axis`,
//! `measured_at`, `operator`, `label.*`, and `repeats` (the value `periods` states that the repeats
//! of a table are the periods of one record). `input: torque N m` is a name and a unit; a name of
//! several words needs its unit in brackets: `motor current [A]`.
//!
//! Several files form one measurement if their units agree. Experiments are never merged across
//! files: the same magnitude and frequency in two files are two experiments.
//!
//! # JSON
//!
//! An object with the metadata keys at the top level or in an object `metadata` (`labels` may be
//! an object), and one of
//!
//! ```json
//! {"rows": [{"magnitude": 1, "omega_rad_s": 2, "harmonic": 1, "re": 0.4, "im": -0.1}]}
//! {"columns": {"magnitude": [1], "omega_rad_s": [2], "re": [0.4], "im": [-0.1]}}
//! {"experiments": [
//!   {"time_s": [0.0, 0.1], "input": [1, 0], "output": [0, 1], "period_s": 0.2},
//!   {"magnitude": 1, "omega_rad_s": 2, "harmonics": [{"harmonic": 1, "re": 0.4, "im": -0.1}]}]}
//! ```
//!
//! or the array of rows alone. Rows and columns use the names of the CSV columns. An experiment
//! with a record may have its own `period_s`, `settle_periods`, `initial_velocity`,
//! `initial_position`, `settle_s` and `run`. One with harmonics has `magnitude`, `omega_rad_s` or
//! `frequency_hz`, `averages` and `run` next to `harmonics`.

mod columns;
mod convention;
mod csv_text;
mod fault;
mod harmonic_row;
mod harmonic_table;
mod header;
mod join;
mod json;
mod json_table;
mod layout;
mod limits;
mod part;
mod repeats;
mod row_noise;
mod table;
mod time_record;
mod write;

pub use fault::ParseError;
pub use limits::{MAX_HARMONIC, MAX_INDEX, MAX_INPUT_LINES, MAX_ROWS, MAX_SETTLE_PERIODS};
pub use part::Source;
pub use write::write_harmonic_csv;

use columns::Column;
use csv_text::CsvText;
use fault::Fault;
use part::Part;

use super::Measurement;

/// Reads one or several files that together form one measurement.
///
/// The digest of the measurement is the SHA-256 of the concatenated bytes of the files. Remarks
/// number the experiments from 1.
///
/// # Errors
/// The first fault in any of the files; a faulty file is never read in part.
pub fn read(sources: &[Source<'_>]) -> Result<Measurement, ParseError> {
    let parts = sources
        .iter()
        .map(|source| part(source.bytes).map_err(|fault| fault.in_file(source.name)))
        .collect::<Result<Vec<_>, _>>()?;
    join::join(sources, parts)
}

fn part(bytes: &[u8]) -> Result<Part, Fault> {
    let text = text(bytes)?;
    if text.trim_start().starts_with(['{', '[']) {
        return json::read(text);
    }
    let csv = CsvText::open(text)?;
    if csv.has(Column::TimeS) {
        let (table, header, notes) = csv.table(columns::TIME_RECORD)?;
        return time_record::read(&table, header, notes);
    }
    if !columns::HARMONIC_TABLE.iter().any(|column| csv.has(*column)) {
        return Err(csv.fault_of_header(
            "the header has no known column: a time record needs time_s,input,output, a \
             harmonic table magnitude,omega_rad_s,harmonic,re,im",
        ));
    }
    let (table, header, notes) = csv.table(columns::HARMONIC_TABLE)?;
    harmonic_table::read(&table, header, notes)
}

/// The text of a file, without its byte order mark.
fn text(bytes: &[u8]) -> Result<&str, Fault> {
    if bytes.starts_with(&[0xFF, 0xFE]) || bytes.starts_with(&[0xFE, 0xFF]) {
        return Err(Fault::new("the text is UTF-16; UTF-8 is needed"));
    }
    let text = std::str::from_utf8(bytes).map_err(|error| {
        let before = &bytes[..error.valid_up_to()];
        let line = 1 + before.iter().filter(|byte| **byte == b'\n').count() as u64;
        Fault::new("the text is not UTF-8").at_line(Some(line))
    })?;
    Ok(text.strip_prefix('\u{FEFF}').unwrap_or(text))
}

#[cfg(test)]
mod tests;
