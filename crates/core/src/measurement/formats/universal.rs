//! Universal files with datasets 58 and 58b: time records and frequency responses.

use super::column_table::ColumnTable;
use super::columns::Column;
use super::fault::Fault;
use super::format::Format;
use super::given::Given;
use super::harmonic_table;
use super::header::Header;
use super::naming;
use super::part::Part;
use super::table::{Place, Table};
use super::universal_dataset::{Axis, Dataset, Lines};

/// A file whose first line is `-1` and whose second names a dataset.
pub(super) const FORMAT: Format = Format {
    name: "universal file",
    is: |content| is(content.bytes),
    read: |content, given| read(content.bytes, given),
    see: |content, given| {
        let functions = functions(content.bytes).ok()?;
        let records: Vec<&Dataset> =
            functions.iter().filter(|data| data.function == TIME_RECORD).collect();
        (!records.is_empty()).then(|| table(&records).sight("universal file", given))
    },
};

const TIME_RECORD: u32 = 1;
const FREQUENCY_RESPONSE: u32 = 4;

fn is(bytes: &[u8]) -> bool {
    let mut lines = Lines::new(bytes);
    lines.next().is_some_and(|line| line.trim_ascii() == b"-1")
        && lines
            .next()
            .is_some_and(|line| line.trim_ascii().first().is_some_and(u8::is_ascii_digit))
}

fn read(bytes: &[u8], given: &Given) -> Result<Part, Fault> {
    let mut header = Header::default();
    let mut notes = Vec::new();
    header.take(given, &mut notes)?;
    let functions = functions(bytes)?;
    let of =
        |function| functions.iter().filter(|data| data.function == function).collect::<Vec<_>>();
    let (records, responses) = (of(TIME_RECORD), of(FREQUENCY_RESPONSE));
    if let Some(other) = functions.iter().find(|data| !matches!(data.function, 1 | 4)) {
        return Err(Fault::new(refusal(other.function)).at_line(Some(other.line)));
    }
    match (&records[..], &responses[..]) {
        ([], []) => Err(Fault::new("the file has no dataset 58")),
        ([], [response]) => frequency_response(response, header, notes),
        ([], _) => Err(Fault::new(format!(
            "the file has {} frequency responses: one is needed, so save them as one file each",
            responses.len()
        ))),
        (_, []) => table(&records).read(header, notes),
        _ => Err(Fault::new(
            "the file has time records and frequency responses: save them as two files",
        )),
    }
}

fn refusal(function: u32) -> String {
    match function {
        2 | 3 | 9 => format!(
            "function type {function} is a spectrum of power or energy, which has no phase: a \
             time record (1) or a frequency response (4) is needed"
        ),
        _ => format!(
            "function type {function} is not read: a time record (1) or a frequency response (4) \
             is needed"
        ),
    }
}

/// The datasets 58 of a file. Others are left out.
fn functions(bytes: &[u8]) -> Result<Vec<Dataset>, Fault> {
    let mut lines = Lines::new(bytes);
    let mut functions = Vec::new();
    while let Some(line) = lines.next() {
        if line.trim_ascii() != b"-1" {
            continue;
        }
        let Some(id) = lines.next() else { break };
        let id = String::from_utf8_lossy(id).trim().to_owned();
        if id.split_whitespace().next().is_some_and(|word| matches!(word, "58" | "58b")) {
            functions.push(Dataset::read(&mut lines, &id)?);
            if !id.starts_with("58b") {
                continue;
            }
        }
        // The rest of the dataset, whatever it is.
        while lines.next().is_some_and(|line| line.trim_ascii() != b"-1") {}
    }
    Ok(functions)
}

/// The name of a quantity, in words that the vocabulary knows if the number of the quantity does.
fn name(axis: &Axis) -> String {
    let name = match axis.quantity {
        8 => "position",
        11 => "velocity",
        12 => "acceleration",
        9 | 13 => "force",
        _ => axis.label.as_str(),
    };
    let name = if name.is_empty() { "channel" } else { name };
    if axis.unit.is_empty() { name.to_owned() } else { format!("{name} [{}]", axis.unit) }
}

/// The channels of time records.
fn table(records: &[&Dataset]) -> ColumnTable {
    ColumnTable {
        names: records.iter().map(|record| (name(&record.numerator), String::new())).collect(),
        times: records.iter().map(|record| record.x.clone()).collect(),
        values: records.iter().map(|record| record.re.clone()).collect(),
    }
}

fn frequency_response(
    response: &Dataset,
    mut header: Header,
    mut notes: Vec<String>,
) -> Result<Part, Fault> {
    let at_line = |fault: Fault| fault.at_line(Some(response.line));
    let Some(im) = &response.im else {
        return Err(at_line(Fault::new("the frequency response is real: it has no phase")));
    };
    if response.abscissa.quantity != 18 && response.abscissa.unit != "Hz" {
        return Err(at_line(Fault::new("the abscissa of the response is not a frequency")));
    }
    for (key, axis) in [("response", &response.numerator), ("input", &response.denominator)] {
        naming::take_quantity(key, &name(axis), &mut header).map_err(at_line)?;
    }
    let columns = vec![Column::FrequencyHz, Column::GainRe, Column::GainIm];
    let mut table = Table::new(columns, Some(Place::Line(response.line)));
    for (row, frequency_hz) in response.x.iter().enumerate() {
        if *frequency_hz == 0.0 {
            notes.push("the value at 0 Hz is not used".into());
            continue;
        }
        let cells = [*frequency_hz, response.re[row], im[row]].map(|number| Ok(Some(number)));
        table.push(Place::Element("lines".into(), row), cells)?;
    }
    harmonic_table::read(&table, header, notes)
}
