//! How much one upload may hold.
//!
//! A few bytes of text can ask for gigabytes of memory (harmonic 10⁹ of a
//! measured input), so counts are limited before anything is allocated.

/// Rows of one table, samples of one file of records: 13 minutes at 2.5 kHz.
pub const MAX_ROWS: usize = 2_000_000;

/// Highest harmonic a table may name.
pub const MAX_HARMONIC: usize = 100_000;

/// Lines of measured inputs, over all experiments and repeats of one file:
/// they are stored without gaps from 0 to the highest.
pub const MAX_INPUT_LINES: usize = 10_000_000;

/// Largest `experiment`, `repeat` or `segment` index: up to here every integer
/// has a floating-point number of its own.
pub const MAX_INDEX: f64 = 9_007_199_254_740_992.0;

/// Most periods that `settle_periods` may drop.
pub const MAX_SETTLE_PERIODS: usize = 1_000_000;
