//! Finds which columns of the contract columns with names of the vocabulary are.

mod context;
mod harmonic_table;
mod time_record;

use super::columns::Column;
use super::fault::Fault;
use super::header::Header;
use super::lack;
use super::name::{self, Name};
use super::naming::{Naming, ROW_NUMBER, Used, note_unused, unknown_kind};
use super::vocabulary::{Holds, Measures};
pub(super) use context::in_context;

/// The columns where names of the vocabulary fill in what those of the contract lack.
///
/// # Errors
/// If two columns could be the same thing, a unit is unknown or missing, the kind of the response is
/// not said, or it or the unit contradicts the metadata.
pub(super) fn resolve(names: &[Name], header: &mut Header) -> Result<Naming, Fault> {
    let (timed, names) = in_context(names, header);
    Vocabulary { names: &names, used: Vec::new() }.resolve(timed, header)
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
