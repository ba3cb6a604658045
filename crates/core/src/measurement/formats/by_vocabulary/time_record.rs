//! The columns of a time record: time, input and response.

use super::Vocabulary;
use crate::measurement::formats::columns::Column;
use crate::measurement::formats::fault::Fault;
use crate::measurement::formats::header::Header;
use crate::measurement::formats::name::Name;
use crate::measurement::formats::naming::{
    ROW_NUMBER, Used, check_unit, driven_by, response, unknown_kind,
};
use crate::measurement::formats::vocabulary::{Holds, Measures};
use crate::measurement::units;

impl Vocabulary<'_> {
    pub(super) fn record(&mut self, header: &mut Header) -> Result<(), Fault> {
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
}
