//! Limits on the size of one upload.
//!
//! A few bytes of text can demand gigabytes of memory (harmonic 10⁹ of a measured input), so
//! counts are checked before anything is allocated.

/// Most rows of one table or samples of one file of time records: 13 minutes at 2.5 kHz.
pub const MAX_ROWS: usize = 2_000_000;

/// Most experiments of one measurement, and most segments of one time record: a fit simulates each
/// of them thousands of times.
pub const MAX_EXPERIMENTS: usize = 20_000;

/// Says that there are more experiments than that.
pub(super) fn too_many_experiments(count: usize) -> String {
    format!(
        "{count} experiments are more than the {MAX_EXPERIMENTS} that are taken as one measurement: \
         upload them as several"
    )
}

/// Highest harmonic in a table.
pub const MAX_HARMONIC: usize = 100_000;

/// Most lines of measured inputs, summed over all experiments and repeats of one file. Each input
/// is stored without gaps from line 0 to its highest.
pub const MAX_INPUT_LINES: usize = 10_000_000;

/// Upper limit of an `experiment`, `repeat` or `segment` index, 2⁵³: every smaller integer has an
/// exact floating-point representation.
pub const MAX_INDEX: f64 = 9_007_199_254_740_992.0;

/// Largest `settle_periods`.
pub const MAX_SETTLE_PERIODS: usize = 1_000_000;

/// Most bytes of the parts of one workbook once unpacked.
pub const MAX_UNPACKED: u64 = 256 << 20;

/// Most bytes once unpacked of a part that is no sheet, such as its strings, all of which are held
/// in memory.
pub const MAX_UNPACKED_STRINGS: u64 = 32 << 20;

/// Most cells in a row of a sheet.
pub const MAX_CELLS_IN_ROW: usize = 1000;

/// Most bytes of a line of a text in columns.
pub const MAX_LINE: usize = 1_000_000;

/// Most lines of metadata above a table.
pub const MAX_METADATA_LINES: usize = 10_000;

/// Most columns of a text.
pub const MAX_COLUMNS: usize = 10_000;

/// Most bytes of a line that may have column names below a line that has none.
pub const MAX_NAMES_LINE: usize = 100_000;

/// Most bytes of a column name that is looked up.
pub const MAX_NAME: usize = 200;

/// Most bytes of the key or the value of a metadata line; only `column_names` may be longer.
pub const MAX_METADATA: usize = 1000;

/// Most labels of a measurement.
pub const MAX_LABELS: usize = 100;
