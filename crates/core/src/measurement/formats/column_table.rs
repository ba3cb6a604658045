//! Channels with names, units and times, from formats that keep each by itself.

use super::csv_text::NamedTable;
use super::delimited;
use super::fault::Fault;
use super::given::Given;
use super::header::Header;
use super::name::Name;
use super::naming::{self, ROW_NUMBER};
use super::part::Part;
use super::sight::{self, Sight};
use super::table::{Place, Table};

/// Channels of one recording.
pub(super) struct ColumnTable {
    /// Name and unit of each channel.
    pub(super) names: Vec<(String, String)>,
    /// Times of each channel, s.
    pub(super) times: Vec<Vec<f64>>,
    /// Values of each channel.
    pub(super) values: Vec<Vec<f64>>,
}

impl ColumnTable {
    /// The channels as they are seen in a file of this kind.
    pub(super) fn sight(&self, kind: &str, given: &Given) -> Sight {
        let (names, units): (Vec<String>, Vec<String>) = self.names.iter().cloned().unzip();
        let shortest = self.values.iter().map(Vec::len).min().unwrap_or_default();
        let cell = |row: usize| move |values: &Vec<f64>| format!("{}", values[row]);
        let row = |row: usize| self.values.iter().map(cell(row)).collect();
        Sight {
            layout: sight::layout(kind, &names, &units),
            meant: names.clone(),
            names,
            units,
            rows: (0..shortest.min(sight::ROWS)).map(row).collect(),
            header: given.header(),
            timed: true,
            ..Sight::default()
        }
    }

    /// Reads the channels as a time record. Where `column_names` is given, it has a name for each
    /// channel.
    ///
    /// # Errors
    /// If it is not clear which channel is the input and which the response, or they do not have
    /// the same times.
    pub(super) fn read(self, mut header: Header, mut notes: Vec<String>) -> Result<Part, Fault> {
        let count = self.names.len();
        let mut names = vec![Name::of("time_s", None)];
        match &header.column_names {
            Some(given) if given.len() != count => {
                let reason = format!("the file has {count} channels, not {}", given.len());
                return Err(Fault::new(reason).in_column("column_names"));
            }
            Some(given) => names.extend(given.iter().map(|name| Name::of(name, None))),
            None => names.extend(self.names.iter().map(|(name, unit)| Name::of(name, Some(unit)))),
        }
        let naming = naming::resolve(&names, &mut header)?;
        notes.extend(naming.notes);
        let channel = |field: usize| field.checked_sub(1).filter(|_| field != ROW_NUMBER);
        let used: Vec<usize> = naming.used.iter().filter_map(|used| channel(used.field)).collect();
        let times = used.first().map_or(&[][..], |first| self.times[*first].as_slice());
        if let Some(other) = used.iter().find(|other| self.times[**other] != times) {
            let name = self.names[*other].0.as_str();
            return Err(
                Fault::new("the channels that are used do not have the same times").in_column(name)
            );
        }
        let columns = naming.used.iter().map(|used| used.column).collect();
        let mut table = Table::new(columns, None);
        for (row, time_s) in times.iter().enumerate() {
            let cells = naming.used.iter().map(|used| {
                let number = channel(used.field).map_or(*time_s, |index| self.values[index][row]);
                Ok(Some(used.convert(number)))
            });
            table.push(Place::Element("samples".into(), row), cells)?;
        }
        if table.len() == 0 {
            return Err(Fault::new("the file has no sample"));
        }
        let timed = naming.timed;
        delimited::part(NamedTable { table, header, notes, timed, written: Vec::new() })
    }
}
