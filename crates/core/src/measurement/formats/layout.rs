//! Determines which of the possible sets of columns a harmonic table has.

use super::columns::Column;
use super::fault::Fault;
use super::header::Header;
use super::lack;
use super::table::Table;

/// Columns in which a table gives a harmonic of the response.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Form {
    /// `re`, `im`.
    Rectangular,
    /// `amplitude`, `phase_deg`.
    Polar,
    /// `gain`, `phase_deg`; harmonic 1 only.
    Gain,
    /// `gain_db`, `phase_deg`; harmonic 1 only.
    GainDb,
    /// `gain_re`, `gain_im`; harmonic 1 only.
    GainRectangular,
}

/// The columns of a harmonic table, checked for contradictions.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Layout {
    pub(super) form: Form,
    /// `frequency_hz` rather than `omega_rad_s`.
    pub(super) hertz: bool,
    /// Whether there is a column `magnitude`, or one magnitude for all rows.
    pub(super) magnitude: bool,
    /// Whether there are columns `u_re`, `u_im`.
    pub(super) input: bool,
}

const FORMS: &str = "re,im or amplitude,phase_deg or gain,phase_deg or gain_db,phase_deg \
                     or gain_re,gain_im";

impl Layout {
    /// The layout of a table.
    ///
    /// # Errors
    /// If a column is missing (the message names its alternatives) or columns contradict.
    pub(super) fn of(table: &Table, header: &Header) -> Result<Self, Fault> {
        let form = form(table)?;
        let hertz = match (table.has(Column::OmegaRadS), table.has(Column::FrequencyHz)) {
            (true, false) => false,
            (false, true) => true,
            (true, true) => {
                return Err(table.fault(
                    Some(Column::FrequencyHz),
                    "omega_rad_s and frequency_hz contradict: give one of them",
                ));
            }
            (false, false) => {
                return Err(missing(table, Column::OmegaRadS, "omega_rad_s or frequency_hz"));
            }
        };
        let input = match (table.has(Column::URe), table.has(Column::UIm)) {
            (true, true) => true,
            (false, false) => false,
            (true, false) => return Err(missing(table, Column::UIm, "u_im beside u_re")),
            (false, true) => return Err(missing(table, Column::URe, "u_re beside u_im")),
        };
        let magnitude = table.has(Column::Magnitude) || header.magnitude.is_some();
        if !magnitude && !input {
            let fault = missing(table, Column::Magnitude, "magnitude, or u_re,u_im");
            let lack = lack::ask("magnitude", "0.5");
            let more = format!("; where it is the same at all frequencies, {lack}");
            return Err(fault.and(&more).lacking(lack));
        }
        Ok(Self { form, hertz, magnitude, input })
    }
}

fn form(table: &Table) -> Result<Form, Fault> {
    let sizes = [
        (Form::Rectangular, &[Column::Re, Column::Im][..]),
        (Form::Polar, &[Column::Amplitude]),
        (Form::Gain, &[Column::Gain]),
        (Form::GainDb, &[Column::GainDb]),
        (Form::GainRectangular, &[Column::GainRe, Column::GainIm]),
    ];
    let mut given =
        sizes.into_iter().filter(|(_, columns)| columns.iter().any(|column| table.has(*column)));
    let Some((form, columns)) = given.next() else {
        return Err(missing(table, Column::Re, FORMS));
    };
    if let Some((_, others)) = given.next() {
        return Err(table.fault(
            Some(others[0]),
            format!(
                "{} and {} are two forms of the response: give one of {FORMS}",
                columns[0].name(),
                others[0].name()
            ),
        ));
    }
    if matches!(form, Form::Rectangular | Form::GainRectangular) {
        for column in columns {
            if !table.has(*column) {
                return Err(missing(table, *column, FORMS));
            }
        }
        if table.has(Column::PhaseDeg) {
            return Err(table.fault(
                Some(Column::PhaseDeg),
                format!(
                    "{},{} and phase_deg are two forms of the response: give one of them",
                    columns[0].name(),
                    columns[1].name()
                ),
            ));
        }
    } else if !table.has(Column::PhaseDeg) {
        return Err(missing(table, Column::PhaseDeg, FORMS));
    }
    Ok(form)
}

fn missing(table: &Table, column: Column, alternatives: &str) -> Fault {
    table.fault(Some(column), format!("the column is missing: {alternatives} is needed"))
}
