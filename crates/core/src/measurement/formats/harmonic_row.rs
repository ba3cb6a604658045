//! Reads one row of a harmonic table.

use super::columns::Column;
use super::convention::Convention;
use super::fault::Fault;
use super::header::Header;
use super::layout::{Form, Layout};
use super::limits::MAX_HARMONIC;
use super::row_noise::Noise;
use super::table::Row;
use crate::measurement::{Complex, size};

/// Identifies the experiment that a row belongs to: rows with equal keys form one experiment.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(super) enum Key {
    /// Value of the column `experiment`.
    Index(u64),
    /// Bit patterns of magnitude, frequency and bias.
    Point(u64, u64, u64),
}

/// One row, converted to the conventions of this crate.
#[derive(Debug, Clone, Copy)]
pub(super) struct Entry {
    pub(super) key: Key,
    /// Peak magnitude m, if the table has it.
    pub(super) magnitude: Option<f64>,
    pub(super) omega_rad_s: f64,
    /// Constant added to the input, if the table has it.
    pub(super) bias: Option<f64>,
    pub(super) harmonic: usize,
    pub(super) repeat: u64,
    pub(super) run: Option<f64>,
    /// Yₖ; `None` if the row gives the input alone.
    pub(super) response: Option<Complex>,
    pub(super) noise: Noise,
    /// Uₖ, if measured.
    pub(super) input: Option<Complex>,
    /// Index of the row in its table.
    pub(super) row: usize,
    /// Whether a nonzero imaginary part of a mean was discarded.
    pub(super) mean_had_imaginary_part: bool,
}

impl Entry {
    pub(super) fn read(row: Row<'_>, layout: Layout, header: &Header) -> Result<Self, Fault> {
        let convention = header.convention;
        let harmonic = match row.required_index(Column::Harmonic)? {
            Some(k) if k > MAX_HARMONIC as u64 => {
                return Err(row.fault(
                    Column::Harmonic,
                    format!("harmonic {k} is beyond the highest accepted, {MAX_HARMONIC}"),
                ));
            }
            Some(k) => k as usize,
            None => 1,
        };
        let magnitude = magnitude(row, layout, header)?.map(|m| m * convention.peak());
        let omega_rad_s = frequency(row, layout)?;
        // −0 and 0 must give the same bits, which are part of the key.
        let bias = row.get(Column::Bias).map(|bias| bias + 0.0);
        let key = match row.required_index(Column::Experiment)? {
            Some(index) => Key::Index(index),
            None => {
                let values = [magnitude.unwrap_or(0.0), omega_rad_s, bias.unwrap_or(0.0)];
                let [magnitude, omega_rad_s, bias] = values.map(f64::to_bits);
                Key::Point(magnitude, omega_rad_s, bias)
            }
        };
        let written_input = pair(row, Column::URe, Column::UIm, harmonic)?;
        let written_response = response(row, layout, harmonic, magnitude, convention)?;
        if written_response.is_none() && written_input.is_none() {
            row.require(response_column(layout.form))?;
        }
        let imaginary = |z: Option<Complex>| harmonic == 0 && z.is_some_and(|z| z.im != 0.0);
        let mut entry = Self {
            key,
            magnitude,
            omega_rad_s,
            bias,
            harmonic,
            repeat: row.index_in(Column::Repeat)?.unwrap_or(0),
            run: row.get(Column::Run),
            response: written_response
                .map(|z| convention.harmonic(harmonic, z))
                .map(|z| if header.inverted { -z } else { z }),
            noise: Noise::default(),
            input: written_input.map(|z| convention.harmonic(harmonic, z)),
            row: row.index(),
            mean_had_imaginary_part: layout.form == Form::Rectangular
                && (imaginary(written_response) || imaginary(written_input)),
        };
        entry.check_sizes(row, layout)?;
        entry.noise = Noise::read(row, header, &entry)?;
        Ok(entry)
    }

    /// Checks that no value is too large or too small, and names the column of one that is.
    ///
    /// A response and an input line are checked for the upper limit only, because single ones may
    /// be as small as rounding errors.
    fn check_sizes(&self, row: Row<'_>, layout: Layout) -> Result<(), Fault> {
        let large = |z: Option<Complex>| z.map(|z| z.re.abs().max(z.im.abs()).max(1.0));
        let response = response_column(layout.form);
        let values = [
            (response, "the response", large(self.response)),
            (Column::URe, "the input", large(self.input)),
            (Column::Magnitude, "the magnitude", self.magnitude),
            (Column::Bias, "the bias", self.bias.map(f64::abs)),
        ];
        for (column, what, value) in values {
            if let Some(reason) = value.and_then(|value| size::fault(what, value)) {
                return Err(row.fault(column, reason));
            }
        }
        let frequency = if layout.hertz { Column::FrequencyHz } else { Column::OmegaRadS };
        match size::frequency_fault("the frequency (rad/s)", self.omega_rad_s) {
            Some(reason) => Err(row.fault(frequency, reason)),
            None => Ok(()),
        }
    }
}

fn response_column(form: Form) -> Column {
    match form {
        Form::Rectangular => Column::Re,
        Form::Polar => Column::Amplitude,
        Form::Gain => Column::Gain,
        Form::GainDb => Column::GainDb,
        Form::GainRectangular => Column::GainRe,
    }
}

fn magnitude(row: Row<'_>, layout: Layout, header: &Header) -> Result<Option<f64>, Fault> {
    let magnitude = match row.has(Column::Magnitude) {
        true => row.get(Column::Magnitude),
        false => header.magnitude,
    };
    if magnitude.is_none() && layout.magnitude && !layout.input {
        row.require(Column::Magnitude)?;
    }
    match magnitude {
        Some(m) if m < 0.0 => Err(row.fault(
            Column::Magnitude,
            format!("magnitude {m} is negative; a phase of 180° belongs to the response"),
        )),
        // −0 and 0 must give the same bits, which are part of the key.
        magnitude => Ok(magnitude.map(f64::abs)),
    }
}

fn frequency(row: Row<'_>, layout: Layout) -> Result<f64, Fault> {
    let (column, factor) = if layout.hertz {
        (Column::FrequencyHz, std::f64::consts::TAU)
    } else {
        (Column::OmegaRadS, 1.0)
    };
    let written = row.require(column)?;
    let omega_rad_s = written * factor;
    if omega_rad_s <= 0.0 || !omega_rad_s.is_finite() {
        return Err(row.fault(column, format!("frequency {written} is not positive and finite")));
    }
    Ok(omega_rad_s)
}

/// A complex number from two cells, which must be both given or both blank. For a mean the second
/// may be blank.
fn pair(
    row: Row<'_>,
    first: Column,
    second: Column,
    harmonic: usize,
) -> Result<Option<Complex>, Fault> {
    match (row.get(first), row.get(second)) {
        (Some(a), Some(b)) => Ok(Some(Complex::new(a, b))),
        (Some(a), None) if harmonic == 0 => Ok(Some(Complex::new(a, 0.0))),
        (None, None) => Ok(None),
        (Some(_), None) => row.require(second).map(|_| None),
        (None, Some(_)) => row.require(first).map(|_| None),
    }
}

/// Yₖ in the conventions of the file, with a gain multiplied by the magnitude.
fn response(
    row: Row<'_>,
    layout: Layout,
    harmonic: usize,
    magnitude: Option<f64>,
    convention: Convention,
) -> Result<Option<Complex>, Fault> {
    let column = response_column(layout.form);
    if layout.form == Form::Rectangular {
        return pair(row, Column::Re, Column::Im, harmonic);
    }
    if layout.form == Form::GainRectangular {
        let gain = pair(row, Column::GainRe, Column::GainIm, harmonic)?;
        let Some(gain) = gain else { return Ok(None) };
        let m = magnitude_of_gain(row, column, harmonic, magnitude)?;
        return Ok(Some(gain * m / convention.peak()));
    }
    let Some(Complex { re: size, im: phase_deg }) = pair(row, column, Column::PhaseDeg, harmonic)?
    else {
        return Ok(None);
    };
    let negative_mean = harmonic == 0 && layout.form == Form::Polar;
    if size < 0.0 && layout.form != Form::GainDb && !negative_mean {
        return Err(row.fault(column, format!("{size} is negative")));
    }
    let amplitude = match layout.form {
        Form::Gain | Form::GainDb => {
            let m = magnitude_of_gain(row, column, harmonic, magnitude)?;
            let gain = if layout.form == Form::Gain { size } else { 10f64.powf(size / 20.0) };
            // The caller multiplies the result by `peak`, but `m` is a peak value already.
            gain * m / convention.peak()
        }
        Form::Rectangular | Form::GainRectangular | Form::Polar => size,
    };
    Ok(Some(polar_deg(amplitude, phase_deg)))
}

/// The magnitude (peak) that a gain is multiplied by.
fn magnitude_of_gain(
    row: Row<'_>,
    column: Column,
    harmonic: usize,
    magnitude: Option<f64>,
) -> Result<f64, Fault> {
    if harmonic != 1 {
        let reason = format!("a gain is |Y₁|/m and harmonic {harmonic} has none: use re,im");
        return Err(row.fault(column, reason));
    }
    magnitude.ok_or_else(|| row.fault(Column::Magnitude, "a gain needs the magnitude"))
}

/// Complex number from amplitude and phase, exact at multiples of 90° (no rounding error in `im` at
/// 180°).
fn polar_deg(amplitude: f64, phase_deg: f64) -> Complex {
    let turn = phase_deg.rem_euclid(360.0);
    if turn == 0.0 {
        Complex::new(amplitude, 0.0)
    } else if turn == 90.0 {
        Complex::new(0.0, amplitude)
    } else if turn == 180.0 {
        Complex::new(-amplitude, 0.0)
    } else if turn == 270.0 {
        Complex::new(0.0, -amplitude)
    } else {
        Complex::from_polar(amplitude, turn.to_radians())
    }
}
