//! Finds which columns of the contract columns with names of the vocabulary are.

use super::columns::{self, Column};
use super::fault::Fault;
use super::header::Header;
use super::lack;
use super::name::{self, Name};
use super::naming::{
    Naming, ROW_NUMBER, Used, check_unit, driven_by, note_unused, response, unknown_kind,
};
use super::vocabulary::{Holds, Measures};
use crate::measurement::{ResponseKind, units};

/// The columns where names of the vocabulary fill in what those of the contract lack.
///
/// # Errors
/// If two columns could be the same thing, a unit is unknown or missing, the kind of the response is
/// not said, or it or the unit contradicts the metadata.
pub(super) fn resolve(names: &[Name], header: &mut Header) -> Result<Naming, Fault> {
    let (timed, names) = in_context(names, header);
    Vocabulary { names: &names, used: Vec::new() }.resolve(timed, header)
}

/// Whether the columns are those of a time record, and what their names mean there.
pub(super) fn in_context(names: &[Name], header: &Header) -> (bool, Vec<Name>) {
    let timed = is_timed(names, header);
    (timed, if timed { of_record(names) } else { names.to_vec() })
}

/// Whether the columns are those of a time record: they have times and no frequency. Beside times, ω is
/// a frequency only where there is a ratio of response to input.
fn is_timed(names: &[Name], header: &Header) -> bool {
    let contract =
        |columns: &[Column]| names.iter().any(|n| n.contract.is_some_and(|c| columns.contains(&c)));
    let holds = |wanted: fn(Holds) -> bool| names.iter().any(|n| n.holds.is_some_and(wanted));
    let time = contract(&[Column::TimeS])
        || holds(|holds| holds == Holds::Time)
        || header.sample_s.is_some();
    let frequency = contract(&[Column::FrequencyHz]) || holds(|holds| holds == Holds::Frequency);
    let omega = contract(&[Column::OmegaRadS]) || holds(|holds| holds == Holds::AngularFrequency);
    let ratio = contract(columns::RESPONSE_FORMS)
        || holds(|holds| {
            matches!(
                holds,
                Holds::Gain
                    | Holds::LinearGain
                    | Holds::GainRe
                    | Holds::GainIm
                    | Holds::RealPart
                    | Holds::ImaginaryPart
            )
        });
    time && !frequency && !(omega && ratio)
}

/// The columns of a time record: ω is a velocity there, and φ or θ a position.
fn of_record(names: &[Name]) -> Vec<Name> {
    let motion = |name: &Name| {
        let is_omega =
            name.contract == Some(Column::OmegaRadS) || name.holds == Some(Holds::AngularFrequency);
        let (kind, unit) = match name.holds {
            _ if is_omega => (ResponseKind::Velocity, "rad/s"),
            Some(Holds::Phase) if name.is_symbol => (ResponseKind::Position, ""),
            _ => return name.clone(),
        };
        let unit = if name.unit.is_empty() { unit } else { &name.unit };
        let (holds, unit) = (Some(Holds::Motion(kind)), unit.to_owned());
        Name { contract: None, holds, unit, ..name.clone() }
    };
    names.iter().map(motion).collect()
}

/// Names of which some are to be resolved by the vocabulary, and the columns that are.
struct Vocabulary<'a> {
    names: &'a [Name],
    used: Vec<Used>,
}

impl Vocabulary<'_> {
    fn resolve(mut self, timed: bool, header: &mut Header) -> Result<Naming, Fault> {
        if timed {
            self.record(header)?;
        } else {
            self.table(header)?;
        }
        let mut notes: Vec<String> = Vec::new();
        let renamed = |used: &&Used| used.field != ROW_NUMBER && !self.is_contract(used);
        let said = self.used.iter().filter(renamed);
        let said: Vec<String> = said
            .map(|used| format!("`{}` is {}", self.names[used.field].written, used.column.name()))
            .collect();
        if !said.is_empty() {
            notes.push(format!("columns: {}", said.join(", ")));
        }
        note_unused(self.names, &self.used, &mut notes);
        Ok(Naming { used: self.used, timed, notes })
    }

    /// The one column that holds something; `None` if no column does.
    fn only(&self, what: &str, wanted: impl Fn(&Name) -> bool) -> Result<Option<usize>, Fault> {
        let mut fields = (0..self.names.len()).filter(|field| wanted(&self.names[*field]));
        let Some(first) = fields.next() else { return Ok(None) };
        match fields.next() {
            None => Ok(Some(first)),
            Some(second) => {
                let lack = lack::ask("column_names", self.example(&[]));
                Err(Fault::new(format!(
                    "`{}` and `{}` may both be the {what}: {lack}; leave the name of a column \
                     empty that is not to be used",
                    self.names[first].written, self.names[second].written,
                ))
                .lacking(lack)
                .in_column(self.names[second].written.as_str()))
            }
        }
    }

    /// The names as an example of `column_names`, some of them with a unit.
    fn example(&self, units: &[(usize, &str)]) -> String {
        let name = |(field, name): (usize, &Name)| match units.iter().find(|(of, _)| *of == field) {
            Some((_, unit)) => format!("{} ({unit})", name.written),
            None => name.written.clone(),
        };
        self.names.iter().enumerate().map(name).collect::<Vec<_>>().join("; ")
    }

    /// Uses a column with the name of the contract, if there is one.
    fn exact(&mut self, column: Column) -> Result<bool, Fault> {
        let field = self.only(column.name(), |name| name.contract == Some(column))?;
        self.used.extend(field.map(|field| Used::plain(column, field)));
        Ok(field.is_some())
    }

    /// Uses a column of the vocabulary in the units that `columns` lists, if there is one.
    fn converted(
        &mut self,
        what: &str,
        wanted: fn(Holds) -> bool,
        columns: &[(Measures, Column)],
        example: &str,
    ) -> Result<bool, Fault> {
        let open = |name: &Name| name.contract.is_none() && name.holds.is_some_and(wanted);
        let Some(field) = self.only(what, open)? else { return Ok(false) };
        let name = &self.names[field];
        let unit = match (name.holds, name.unit.as_str()) {
            (Some(Holds::AngularFrequency), "") => "rad/s",
            (Some(Holds::LinearGain | Holds::GainRe | Holds::GainIm), "") => "1",
            (Some(Holds::Coherence | Holds::Averages), "") => "1",
            (_, "") => {
                let lack = lack::ask("column_names", self.example(&[(field, example)]));
                return Err(Fault::new(format!("`{}` has no unit: {lack}", name.written))
                    .lacking(lack)
                    .in_column(name.written.as_str()));
            }
            (_, unit) => unit,
        };
        let known = name::unit(unit);
        let column = known.and_then(|known| columns.iter().find(|(m, _)| *m == known.measures));
        let (Some(unit), Some((_, column))) = (known, column) else {
            return Err(Fault::new(format!(
                "`{unit}` is not a known unit of a {what}; {example} is, for example"
            ))
            .in_column(name.written.as_str()));
        };
        self.used.push(Used { column: *column, field, scale: [unit.times, unit.over] });
        Ok(true)
    }

    fn record(&mut self, header: &mut Header) -> Result<(), Fault> {
        let units = [(Measures::Time, Column::TimeS)];
        if !self.exact(Column::TimeS)?
            && !self.converted("time", |holds| holds == Holds::Time, &units, "s")?
            && let Some(sample_s) = header.sample_s
        {
            let number = self.only("number of the sample", |n| n.holds == Some(Holds::Sample))?;
            let field = number.unwrap_or(ROW_NUMBER);
            self.used.push(Used { column: Column::TimeS, field, scale: [sample_s, 1.0] });
        }
        self.exact(Column::Segment)?;
        if self.exact(Column::Input)? {
            self.check_exact(Column::Input, header)?;
        } else {
            self.input(header)?;
        }
        if self.exact(Column::Output)? {
            self.check_exact(Column::Output, header)?;
            return self.check_kind(header);
        }
        self.output(header)
    }

    fn check_exact(&self, column: Column, header: &mut Header) -> Result<(), Fault> {
        let used = self.used.iter().find(|used| used.column == column);
        used.map_or(Ok(()), |used| check_unit(&self.names[used.field], column, header))
    }

    fn input(&mut self, header: &mut Header) -> Result<(), Fault> {
        let stated = header.metadata.input.name.to_lowercase();
        let is_input = |name: &Name| matches!(name.holds, Some(Holds::Input(_)));
        // What the metadata calls the input tells one of several.
        let is_stated =
            |name: &Name| matches!(name.holds, Some(Holds::Input(quantity)) if quantity == stated);
        let field = match self.names.iter().any(is_stated) {
            true => self.only("input", is_stated)?,
            false => self.only("input", is_input)?,
        };
        let Some(field) = field else {
            return Err(self.missing("input", "Time (s); Current (A); Position (mm)"));
        };
        self.used.push(Used::plain(Column::Input, field));
        let name = &self.names[field];
        let by_unit = driven_by(&name.unit).unwrap_or_default();
        let quantity = match name.holds {
            Some(Holds::Input(quantity)) if !quantity.is_empty() => quantity,
            _ => by_unit,
        };
        if !by_unit.is_empty() && quantity != by_unit {
            return Err(Fault::new(format!("`{}` is not a unit of a {quantity}", name.unit))
                .in_column(name.written.as_str()));
        }
        if quantity.is_empty() && name.unit.is_empty() {
            return Ok(());
        }
        let quantity = if quantity.is_empty() { "input" } else { quantity };
        header.infer("input", &format!("{quantity} [{}]", name.unit), &name.written)
    }

    fn output(&mut self, header: &mut Header) -> Result<(), Fault> {
        let stated = header.states("response").then_some(header.metadata.response_kind);
        let is_motion = |name: &Name| matches!(name.holds, Some(Holds::Motion(_) | Holds::Output));
        let is_stated =
            |name: &Name| stated.is_some_and(|kind| name.holds == Some(Holds::Motion(kind)));
        let field = match self.names.iter().any(is_stated) {
            true => self.only("response", is_stated)?,
            false => self.only("response", is_motion)?,
        };
        let Some(field) = field else {
            return Err(self.missing("response", "Time (s); Current (A); Position (mm)"));
        };
        self.used.push(Used::plain(Column::Output, field));
        let name = &self.names[field];
        let kind = match name.holds {
            Some(Holds::Motion(kind)) => Some(kind),
            _ => units::kind_of(&name.unit),
        };
        match kind.or(stated) {
            Some(kind) => response(header, kind, name),
            None => Err(unknown_kind().in_column(name.written.as_str())),
        }
    }

    fn table(&mut self, header: &mut Header) -> Result<(), Fault> {
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

    /// Checks that the kind of the response is said where names are not those of the contract,
    /// whose default is velocity.
    fn check_kind(&self, header: &Header) -> Result<(), Fault> {
        let known = header.states("response") || !header.metadata.response.unit.is_empty();
        if known || self.used.iter().all(|used| self.is_contract(used)) {
            return Ok(());
        }
        let magnitude = [Column::Magnitude, Column::URe, Column::Input];
        let mut fault = unknown_kind();
        if !self.has(&magnitude) && header.magnitude.is_none() {
            let lack = lack::ask("magnitude", "0.5");
            fault = fault.and(&format!(", and {lack}")).lacking(lack);
        }
        Err(fault)
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

    /// Whether a column has the name of the contract.
    fn is_contract(&self, used: &Used) -> bool {
        self.names.get(used.field).is_some_and(|name| name.contract == Some(used.column))
    }

    fn has(&self, columns: &[Column]) -> bool {
        self.used.iter().any(|used| columns.contains(&used.column))
    }

    fn missing(&self, what: &str, example: &str) -> Fault {
        let lack = lack::ask("column_names", example);
        Fault::new(format!(
            "the column is missing: none is known as the {what}; {lack}, with a name for each of \
             the {} columns of the file",
            self.names.len(),
        ))
        .lacking(lack)
        .in_column(if what == "input" { "input" } else { "output" })
    }
}
