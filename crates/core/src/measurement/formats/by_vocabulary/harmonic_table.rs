//! The columns of a harmonic table: frequency, response or gain, and what states the noise.

use super::Vocabulary;
use crate::measurement::formats::columns::{self, Column};
use crate::measurement::formats::fault::Fault;
use crate::measurement::formats::header::Header;
use crate::measurement::formats::lack;
use crate::measurement::formats::name::Name;
use crate::measurement::formats::naming::Used;
use crate::measurement::formats::vocabulary::{Holds, Measures};

impl Vocabulary<'_> {
    pub(super) fn table(&mut self, header: &mut Header) -> Result<(), Fault> {
        for column in columns::HARMONIC_TABLE {
            self.exact(*column)?;
        }
        if !self.has(&[Column::FrequencyHz, Column::OmegaRadS]) {
            let wanted = |holds| matches!(holds, Holds::Frequency | Holds::AngularFrequency);
            let units = [
                (Measures::Frequency, Column::FrequencyHz),
                (Measures::AngularFrequency, Column::OmegaRadS),
            ];
            self.converted("frequency", wanted, &units, "Hz")?;
        }
        if self.has(&[Column::Re, Column::Im]) {
            return self.check_kind(header);
        }
        let degrees = [(Measures::Angle, Column::PhaseDeg)];
        if !self.has(&[Column::PhaseDeg]) {
            self.converted("phase", |holds| holds == Holds::Phase, &degrees, "deg")?;
        }
        let mut ratio = self.has(&[Column::Gain, Column::GainDb]);
        if !ratio && !self.has(&[Column::Amplitude]) {
            let wanted = |holds| matches!(holds, Holds::Gain | Holds::LinearGain);
            let units = [(Measures::Decibel, Column::GainDb), (Measures::One, Column::Gain)];
            ratio = self.converted("gain", wanted, &units, "dB")?;
        }
        if !ratio {
            let one = |column| [(Measures::One, column)];
            ratio =
                self.converted("real part", |h| h == Holds::GainRe, &one(Column::GainRe), "1")?;
            self.converted("imaginary part", |h| h == Holds::GainIm, &one(Column::GainIm), "1")?;
        }
        if !ratio && !self.has(&[Column::Amplitude]) {
            self.parts()?;
        }
        self.rest()?;
        self.check_kind(header)
    }

    /// Refuses real and imaginary parts that may be those of the ratio or of the response itself.
    fn parts(&self) -> Result<(), Fault> {
        let parts =
            |name: &&Name| matches!(name.holds, Some(Holds::RealPart | Holds::ImaginaryPart));
        let Some(name) = self.names.iter().find(parts) else { return Ok(()) };
        let lack = lack::ask("column_names", "frequency_hz; gain_re; gain_im");
        Err(Fault::new(format!(
            "`{}` may be a gain (response over input) or the response itself: {lack}, with gain_re \
             and gain_im for the ratio, re and im for the response",
            name.written,
        ))
        .lacking(lack)
        .in_column(name.written.as_str()))
    }

    /// Columns beside the response that a table may have.
    fn rest(&mut self) -> Result<(), Fault> {
        if !self.has(&[Column::Coherence]) {
            let units = [(Measures::One, Column::Coherence)];
            self.converted("coherence", |holds| holds == Holds::Coherence, &units, "1")?;
        }
        if !self.has(&[Column::Averages]) {
            let units = [(Measures::One, Column::Averages)];
            self.converted("number of averages", |holds| holds == Holds::Averages, &units, "1")?;
        }
        if !self.has(&[Column::GainStd, Column::GainDbStd, Column::Std]) {
            let units = [(Measures::Decibel, Column::GainDbStd), (Measures::One, Column::GainStd)];
            self.converted("deviation", |holds| holds == Holds::GainDeviation, &units, "dB")?;
        }
        if !self.has(&[Column::PhaseStdDeg, Column::Std]) {
            let units = [(Measures::Angle, Column::PhaseStdDeg)];
            self.converted("deviation", |holds| holds == Holds::PhaseDeviation, &units, "deg")?;
        }
        if !self.has(&[Column::Magnitude]) {
            let wanted = |name: &Name| name.holds == Some(Holds::Magnitude);
            let field = self.only("magnitude", wanted)?;
            self.used.extend(field.map(|field| Used::plain(Column::Magnitude, field)));
        }
        Ok(())
    }
}
