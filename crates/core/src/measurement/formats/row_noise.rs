//! Reads the noise of one row of a harmonic table, in any of the ways to state it.
//!
//! The result is the standard deviation σ of each of re and im (of re alone for harmonic 0).
//! `std` is σ itself. The other ways are relative to the row's response Y or magnitude m:
//!
//! - `coherence` γ² with `averages` n: σ = |Y|·√((1 − γ²)/(2nγ²)). This is the random error of
//!   the gain of a frequency response, and in radians that of its phase: J. S. Bendat,
//!   A. G. Piersol, *Random Data*, 4th ed. 2010, chapter 9, doi:10.1002/9781118032428.
//! - `gain_std` s, the deviation of |Y₁|/m: m·s along the response.
//! - `gain_db_std` s, the deviation of 20·lg(|Y₁|/m) in dB: |Y₁|·s·ln(10)/20 along the response.
//! - `phase_std_deg` s, in degrees: |Y|·s·π/180 across the response.
//!
//! A harmonic has one deviation for both re and im, so σ is the rms of those along and across.
//! Where only one of them is stated, σ is that one. Y and m are peak values by then, and so is σ.

use super::columns::Column;
use super::fault::Fault;
use super::harmonic_row::Entry;
use super::header::Header;
use super::table::Row;
use crate::measurement::size;

/// Columns that state noise. Of two that contradict, the message names the place of the later.
const STATEMENTS: [Column; 5] =
    [Column::Std, Column::Coherence, Column::GainStd, Column::GainDbStd, Column::PhaseStdDeg];

const COHERENCE_OF_ONE: &str =
    "a coherence of 1 leaves no noise: rows with it are read as rows that state none";
const SHARE_OF_ZERO: &str = "noise relative to a response of 0 says nothing: rows with it are read \
                             as rows that state none";
const GAIN_ALONE: &str = "gain_std without phase_std_deg: the response is taken to deviate as much in \
                          phase as in gain";
const GAIN_DB_ALONE: &str = "gain_db_std without phase_std_deg: the response is taken to deviate as \
                             much in phase as in gain";
const PHASE_ALONE: &str = "phase_std_deg without gain_std or gain_db_std: the response is taken to \
                           deviate as much in gain as in phase";

/// The noise that a row states.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Noise {
    /// Standard deviation of each of re and im (of re alone for harmonic 0), response units;
    /// `None` if the row states none.
    pub(super) std: Option<f64>,
    /// What the user should know of how it was read.
    pub(super) remark: Option<&'static str>,
}

impl Noise {
    /// Reads the noise of a row whose harmonic, magnitude and response are in `entry`.
    pub(super) fn read(row: Row<'_>, header: &Header, entry: &Entry) -> Result<Self, Fault> {
        check_one_way(row)?;
        let averages = positive(row, Column::Averages)?.or(header.averages);
        if let Some(std) = positive(row, Column::Std)? {
            let std = header.convention.deviation(entry.harmonic, std);
            return Self::of(row, Column::Std, std, None);
        }
        let Some(size) = entry.response.map(|y| y.norm()) else { return Ok(Self::default()) };
        if let Some(coherence) = positive(row, Column::Coherence)? {
            return Self::of_coherence(row, coherence, averages, size);
        }
        let along = along(row, entry, size)?;
        let across = across(row, entry, size)?;
        match (along, across) {
            (None, None) => Ok(Self::default()),
            (Some((column, along)), Some(across)) => {
                let rms = along.hypot(across) * std::f64::consts::FRAC_1_SQRT_2;
                Self::of(row, column, rms, None)
            }
            (Some((column, along)), None) => {
                let remark = if column == Column::GainStd { GAIN_ALONE } else { GAIN_DB_ALONE };
                Self::of(row, column, along, Some(remark))
            }
            (None, Some(across)) => Self::of(row, Column::PhaseStdDeg, across, Some(PHASE_ALONE)),
        }
    }

    fn of_coherence(
        row: Row<'_>,
        coherence: f64,
        averages: Option<f64>,
        size: f64,
    ) -> Result<Self, Fault> {
        if coherence > 1.0 {
            return Err(row.fault(
                Column::Coherence,
                format!("{coherence} is above 1: γ² from 0 to 1 is needed, not per cent"),
            ));
        }
        let Some(averages) = averages else {
            return Err(row.fault(
                Column::Averages,
                "coherence states noise only with the number of averages: add the column averages, \
                 or averages to the metadata (`# averages: 16`)",
            ));
        };
        // Analysers round a good coherence to 1. Such a row is not faulty, but says too little.
        if coherence == 1.0 {
            return Ok(Self { std: None, remark: Some(COHERENCE_OF_ONE) });
        }
        let share = ((1.0 - coherence) / (2.0 * averages * coherence)).sqrt();
        Self::of(row, Column::Coherence, size * share, None)
    }

    /// A deviation (response units) that follows from a column.
    fn of(
        row: Row<'_>,
        column: Column,
        std: f64,
        remark: Option<&'static str>,
    ) -> Result<Self, Fault> {
        if std == 0.0 {
            return Ok(Self { std: None, remark: Some(SHARE_OF_ZERO) });
        }
        // A deviation may be as small as a rounding error, so only the upper limit is checked.
        match size::fault("the deviation", std.max(1.0)) {
            Some(reason) => Err(row.fault(column, reason)),
            None => Ok(Self { std: Some(std), remark }),
        }
    }
}

/// Checks that a row states its noise in one way only. A deviation of the gain and one of the phase
/// are one way.
fn check_one_way(row: Row<'_>) -> Result<(), Fault> {
    let mut filled = STATEMENTS.into_iter().filter(|column| row.get(*column).is_some());
    let Some(first) = filled.next() else { return Ok(()) };
    let is_gain = matches!(first, Column::GainStd | Column::GainDbStd);
    match filled.find(|other| !(is_gain && *other == Column::PhaseStdDeg)) {
        Some(other) => Err(row.fault(
            other,
            format!(
                "{} and {} both state the noise of this row: fill one of them",
                first.name(),
                other.name()
            ),
        )),
        None => Ok(()),
    }
}

/// Deviation along the response (response units) from the deviation of the gain, and its column.
fn along(row: Row<'_>, entry: &Entry, size: f64) -> Result<Option<(Column, f64)>, Fault> {
    let (column, std) = match (positive(row, Column::GainStd)?, positive(row, Column::GainDbStd)?) {
        (Some(std), _) => (Column::GainStd, std),
        (None, Some(std)) => (Column::GainDbStd, std),
        (None, None) => return Ok(None),
    };
    if entry.harmonic != 1 {
        return Err(row.fault(
            column,
            format!(
                "a gain is |Y₁|/m and harmonic {} has none: leave the cell blank and use std",
                entry.harmonic
            ),
        ));
    }
    if column == Column::GainDbStd {
        return Ok(Some((column, size * std * std::f64::consts::LN_10 / 20.0)));
    }
    match entry.magnitude {
        Some(m) if m > 0.0 => Ok(Some((column, m * std))),
        _ => Err(row.fault(Column::Magnitude, "gain_std needs a magnitude above 0")),
    }
}

/// Deviation across the response (response units) from the deviation of the phase.
fn across(row: Row<'_>, entry: &Entry, size: f64) -> Result<Option<f64>, Fault> {
    match positive(row, Column::PhaseStdDeg)? {
        Some(_) if entry.harmonic == 0 => Err(row.fault(
            Column::PhaseStdDeg,
            "harmonic 0 is a mean and has no phase: leave the cell blank and use std",
        )),
        std => Ok(std.map(|std| size * std.to_radians())),
    }
}

/// The number in a column, which must be positive if the cell is not blank.
fn positive(row: Row<'_>, column: Column) -> Result<Option<f64>, Fault> {
    match row.get(column) {
        Some(value) if value <= 0.0 => Err(row.fault(column, format!("{value} is not positive"))),
        value => Ok(value),
    }
}
