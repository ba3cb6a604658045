//! Looks at files before they are read: what would be understood of them.

use sha2::{Digest, Sha256};

use super::columns::Column;
use super::delimiter::Delimiter;
use super::given::Given;
use super::sight::Sight;
use super::source::Source;
use super::{by_vocabulary, known_formats, naming, quantities, sight};

/// What is seen of an upload.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Look {
    /// One for each file.
    pub files: Vec<FileLook>,
    /// The same for uploads of the same layout: the same formats, column names and units; of a text
    /// without column names, the same delimiter, number of columns and decimal mark.
    /// `None` where neither is known.
    pub layout: Option<String>,
}

impl Look {
    /// How the first table without column names looks, in words: all that its layout is known by.
    pub fn without_names(&self) -> Option<String> {
        let tables = self.files.iter().filter_map(|file| file.table.as_ref());
        let mut nameless =
            tables.filter(|table| table.columns.iter().all(|column| column.name.is_empty()));
        let TableLook { delimiter, decimal, columns, .. } = nameless.next()?;
        let delimiter = delimiter.map(|mark| format!(" between {mark}")).unwrap_or_default();
        let decimal = decimal.map(|mark| format!(" with a decimal {mark}")).unwrap_or_default();
        Some(format!("{} columns{delimiter}{decimal}", columns.len()))
    }
}

/// What is seen of one file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FileLook {
    /// Its name.
    pub name: String,
    /// Its format.
    pub format: &'static str,
    /// How the text is decoded, if it is not UTF-8.
    pub encoding: Option<String>,
    /// Its table; `None` for a format whose columns need no names, and where there is none.
    pub table: Option<TableLook>,
}

/// What is seen of a table.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TableLook {
    /// What separates the columns of a text, in the plural.
    pub delimiter: Option<&'static str>,
    /// Decimal mark of the numbers, `comma` or `point`, if they have one.
    pub decimal: Option<&'static str>,
    /// Lines above the table, at most 20.
    pub preamble: Vec<String>,
    /// Line of the column names, or of the first row where there are none; from 1.
    pub line: Option<u64>,
    /// The columns.
    pub columns: Vec<ColumnLook>,
    /// The first rows, at most 20; text as it is written.
    pub rows: Vec<Vec<String>>,
    /// Sheets of a workbook.
    pub sheets: Vec<String>,
}

/// What is seen of a column.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ColumnLook {
    /// Name as the file has it; empty if it has none.
    pub name: String,
    /// Key of the quantity that its name means, among [`super::QUANTITIES`]; `None` if that is not
    /// known.
    pub quantity: Option<&'static str>,
    /// Its unit; empty if it is not said.
    pub unit: String,
    /// What it is used as; `None` if it is not used.
    pub used_as: Option<&'static str>,
}

/// Looks at files that together form one measurement. They need not be readable.
pub fn look(sources: &[Source<'_>]) -> Look {
    let given = sources.iter().find_map(|source| Given::of(source)?.ok()).unwrap_or_default();
    let files = sources.iter().filter(|source| Given::of(source).is_none());
    let mut layouts = Some(Vec::new());
    let files = files
        .map(|source| {
            let (format, encoding, sight) = known_formats::see(source.bytes, &given);
            let layout = sight.as_ref().and_then(|sight| sight.layout.as_deref());
            let layout = layout.map(|layout| format!("{format}\u{1d}{layout}"));
            layouts = layouts.take().zip(layout).map(|(mut all, one)| {
                all.push(one);
                all
            });
            let table = sight.map(table);
            FileLook { name: source.name.to_owned(), format, encoding, table }
        })
        .collect();
    Look { files, layout: layouts.filter(|all| !all.is_empty()).map(digest) }
}

/// One name for the layouts of all files; files of one layout count once.
fn digest(mut layouts: Vec<String>) -> String {
    layouts.sort();
    layouts.dedup();
    let digest = Sha256::digest(layouts.join("\u{1c}").as_bytes());
    digest[..16].iter().map(|byte| format!("{byte:02x}")).collect()
}

fn table(mut sight: Sight) -> TableLook {
    let names = sight.named();
    let ahead = usize::from(sight.timed);
    let used = naming::resolve(&names, &mut sight.header).map(|naming| naming.used);
    let used = used.unwrap_or_default();
    let (_, names) = by_vocabulary::in_context(&names, &sight.header);
    let columns = sight.names.iter().zip(&names[ahead..]).enumerate();
    let columns = columns.map(|(field, (written, name))| {
        let (quantity, unit) = quantities::of(name).unzip();
        let used = used.iter().find(|used| used.field == field + ahead);
        ColumnLook {
            name: written.clone(),
            quantity,
            unit: unit.unwrap_or_else(|| name.unit.clone()),
            used_as: used.map(|used| Column::name(used.column)),
        }
    });
    TableLook {
        delimiter: sight.delimiter.map(Delimiter::name),
        decimal: sight::decimal(&sight.rows, sight.header.decimal),
        preamble: sight.above,
        line: sight.line,
        columns: columns.collect(),
        rows: sight.rows,
        sheets: sight.sheets,
    }
}
