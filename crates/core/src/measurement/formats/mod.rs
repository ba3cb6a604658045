//! File formats: parses bytes into a [`Measurement`], or reports what is wrong and where.
//!
//! The format is detected from the content; the list is in `known_formats.rs`. Every format contains a
//! table of numbers, and the names of its columns tell which kind it is:
//!
//! - **Harmonic table** (CSV): `magnitude`; `omega_rad_s` or `frequency_hz`; `re,im`,
//!   `amplitude,phase_deg`, `gain,phase_deg`, `gain_db,phase_deg` or `gain_re,gain_im` (parts of
//!   the ratio of response to input); and optionally `experiment`,
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
//! Text that spreadsheets and instruments write has other delimiters, decimal marks, encodings and
//! names. A file with the names above is read by these alone; otherwise those of `vocabulary` fill
//! in what is missing. What was understood is said in the notes of the measurement. What could be
//! read in two ways is refused, and the message names the metadata that decides: `magnitude`,
//! `decimal`, `column_names`, `sample_s`, `sheet`, `inverted`. Metadata may also be given beside the
//! files ([`Given`]).
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

mod bam;
mod bode_100;
mod by_vocabulary;
mod column_table;
mod columns;
mod convention;
mod csv_text;
mod decimal;
mod delimited;
mod delimiter;
mod digilent;
mod encoding;
mod fault;
mod format;
mod given;
mod harmonic_row;
mod harmonic_table;
mod header;
mod instrument;
mod instruments;
mod join;
mod json;
mod json_table;
mod known_formats;
mod lack;
mod layout;
mod limits;
mod look;
mod matlab;
mod matlab_variable;
mod name;
mod naming;
mod nf_fra;
mod part;
mod preamble;
mod quantities;
mod repeats;
mod row_noise;
mod sight;
mod source;
mod sysid;
mod table;
mod tdms;
mod tdms_segment;
mod time_record;
mod twincat_scope;
mod universal;
mod universal_dataset;
mod values;
mod vocabulary;
mod write;
mod xlsx;

pub use fault::ParseError;
pub use given::Given;
pub use lack::Lack;
pub use limits::{
    MAX_CELLS_IN_ROW, MAX_COLUMNS, MAX_EXPERIMENTS, MAX_HARMONIC, MAX_INDEX, MAX_INPUT_LINES,
    MAX_NAME, MAX_NAMES_LINE, MAX_ROWS, MAX_SETTLE_PERIODS, MAX_UNPACKED, MAX_UNPACKED_STRINGS,
};
pub use look::{ColumnLook, FileLook, Look, TableLook, look};
pub use quantities::{QUANTITIES, QuantityChoice};
pub use source::Source;
pub use write::write_harmonic_csv;

use super::Measurement;

/// Reads one or several files that together form one measurement.
///
/// A source that holds the text of a [`Given`] is no file: what it states holds for all files. The
/// digest of the measurement is the SHA-256 of the concatenated bytes of all sources. Remarks
/// number the experiments from 1.
///
/// # Errors
/// The first fault in any of the files; a faulty file is never read in part.
pub fn read(sources: &[Source<'_>]) -> Result<Measurement, ParseError> {
    let mut given = Given::default();
    let mut files = Vec::new();
    for source in sources {
        match Given::of(source) {
            Some(stated) => given = stated?,
            None => files.push(*source),
        }
    }
    let parts = files
        .iter()
        .map(|source| {
            known_formats::read(source.bytes, &given).map_err(|fault| fault.in_file(source.name))
        })
        .collect::<Result<Vec<_>, _>>()?;
    join::join(&files, parts, join::digest(sources))
}

#[cfg(test)]
mod tests;
