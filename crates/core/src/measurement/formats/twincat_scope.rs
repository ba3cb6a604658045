//! TwinCAT Scope, export as CSV.
//!
//! Lines of keys and values come first, separated by tabs, semicolons or colons; `Name` and
//! `Starttime of export` begin the file. Then come lines that have a key and a value for every
//! channel (`Name`, `Unit`, `SampleTime[ms]`, …), a blank line, and the numbers. Where the line
//! `Name` has the word itself again, the column holds the times (ms) of the channels up to the next;
//! an export with one time for all channels has it once. The number behind `Starttime of export` is
//! the time of the measurement.

use super::column_table::ColumnTable;
use super::decimal::{Decimals, Mark};
use super::delimiter::{Delimiter, unquote};
use super::fault::Fault;
use super::format::Format;
use super::given::Given;
use super::header::Header;
use super::limits::MAX_ROWS;
use super::part::Part;

/// A text that begins with the lines `Name` and `Starttime of export`.
pub(super) const FORMAT: Format = Format {
    name: "export of TwinCAT Scope",
    is: |content| content.text().is_ok_and(|text| delimiter(text).is_some()),
    read: |content, given| read(content.text()?, given),
    see: |content, given| {
        let text = content.text().ok()?;
        let table = table(text, delimiter(text)?, given.header().decimal).ok()?;
        Some(table.sight("TwinCAT Scope", given))
    },
};

const KEY_OF_TIME: &str = "Name";

const KEY_OF_START: &str = "Starttime of export";

/// From 1601, where the count of 100 ns begins, to 1970, in units of 100 ns.
const UNIX_EPOCH: i128 = 116_444_736_000_000_000;

/// The mark between the cells; `None` if the text is not of this format.
fn delimiter(text: &str) -> Option<char> {
    let mut lines = text.lines();
    let mark = lines.next()?.strip_prefix(KEY_OF_TIME)?.chars().next()?;
    let second = lines.next()?.strip_prefix(KEY_OF_START)?;
    (['\t', ';', ':'].contains(&mark) && second.starts_with(mark)).then_some(mark)
}

/// A channel: where its numbers and their times are.
struct Channel {
    name: String,
    unit: String,
    field: usize,
    time_field: usize,
}

fn read(text: &str, given: &Given) -> Result<Part, Fault> {
    let mark = delimiter(text).unwrap_or('\t');
    let mut notes = vec![format!(
        "the file is an export of TwinCAT Scope, its cells separated by {}; its numbers are taken \
         as they are written, its times as ms",
        [Delimiter::Tab, Delimiter::Semicolon]
            .into_iter()
            .find(|known| char::from(known.byte()) == mark)
            .map_or("colons", Delimiter::name)
    )];
    let mut header = Header::default();
    if let Some((line, time)) = measured_at(text, mark) {
        header.set(Some(line), "measured_at", &time.to_string())?;
    }
    header.take(given, &mut notes)?;
    table(text, mark, header.decimal)?.read(header, notes)
}

/// The time at which the measurement began, and its line; `None` where it is no count of 100 ns since
/// 1601, or one that ends before 1970.
fn measured_at(text: &str, mark: char) -> Option<(u64, jiff::Timestamp)> {
    let mut lines = (1..).zip(text.lines());
    let (line, start) = lines.find(|(_, line)| line.starts_with(KEY_OF_START))?;
    let count: i128 = unquote(start.split(mark).nth(1)?.trim()).parse().ok()?;
    let nanoseconds = count.checked_sub(UNIX_EPOCH)?.checked_mul(100)?;
    let time = jiff::Timestamp::from_nanosecond(nanoseconds).ok()?;
    (time > jiff::Timestamp::UNIX_EPOCH).then_some((line, time))
}

/// The channels and their times.
fn table(text: &str, mark: char, decimal: Option<Mark>) -> Result<ColumnTable, Fault> {
    let mut lines = (1..).zip(text.lines()).skip_while(|(_, line)| !line.trim().is_empty());
    let channels = channels(&mut lines, mark)?;
    let mut decimals = Decimals::new(decimal);
    let mut times: Vec<Vec<f64>> = channels.iter().map(|_| Vec::new()).collect();
    let mut values = times.clone();
    for (line, text) in lines {
        let text = text.trim_end();
        if text.is_empty() || text == "EOF" {
            continue;
        }
        let cells: Vec<&str> = text.split(mark).map(|cell| unquote(cell.trim())).collect();
        for (index, channel) in channels.iter().enumerate() {
            let mut number = |field: usize| {
                let cell = cells.get(field).copied().unwrap_or_default();
                decimals.number(line, cell).map_err(|reason| {
                    Fault::new(reason).at_line(Some(line)).in_column(channel.name.as_str())
                })
            };
            // The channels of a longer sample time end earlier.
            if let (Some(time), Some(value)) = (number(channel.time_field)?, number(channel.field)?)
            {
                times[index].push(time / 1e3);
                values[index].push(value);
            }
        }
        if times.iter().any(|times| times.len() > MAX_ROWS) {
            return Err(Fault::new(format!("more than {MAX_ROWS} rows")).at_line(Some(line)));
        }
    }
    decimals.mark()?;
    let names = channels.iter().map(|channel| (channel.name.clone(), channel.unit.clone()));
    Ok(ColumnTable { names: names.collect(), times, values })
}

/// Reads the lines that describe the channels, up to the blank line behind them.
fn channels<'a>(
    lines: &mut impl Iterator<Item = (u64, &'a str)>,
    mark: char,
) -> Result<Vec<Channel>, Fault> {
    let mut channels = Vec::new();
    let mut last = None;
    for (line, text) in lines.skip_while(|(_, line)| line.trim().is_empty()) {
        if text.trim().is_empty() {
            break;
        }
        last = Some(line);
        let cells: Vec<&str> = text.split(mark).map(|cell| unquote(cell.trim())).collect();
        match cells[0] {
            KEY_OF_TIME => channels = named(&cells),
            "Unit" => {
                for channel in &mut channels {
                    let unit = cells.get(channel.field).copied().unwrap_or_default();
                    channel.unit = if unit == "(None)" { String::new() } else { unit.to_owned() };
                }
            }
            _ => {}
        }
    }
    match channels.is_empty() {
        true => {
            Err(Fault::new("the line `Name` with the names of the channels is missing")
                .at_line(last))
        }
        false => Ok(channels),
    }
}

/// The channels that a line `Name` names.
fn named(cells: &[&str]) -> Vec<Channel> {
    let mut time_field = 0;
    let mut channels = Vec::new();
    for (field, cell) in cells.iter().enumerate() {
        if *cell == KEY_OF_TIME {
            time_field = field;
        } else if !cell.is_empty() {
            let name = (*cell).to_owned();
            channels.push(Channel { name, unit: String::new(), field, time_field });
        }
    }
    channels
}

#[cfg(test)]
pub(super) mod tests {
    use super::super::{Source, read};
    use crate::measurement::{Measurement, ResponseKind};

    /// 200 samples of a current and a position 0.5 ms apart, with or without a second time column.
    pub(crate) fn export(mark: &str, own_times: bool, decimal: &str) -> String {
        let again = if own_times { "Name\t" } else { "" };
        let unit = if own_times { "Unit\t" } else { "" };
        let mut text = format!(
            "Name\taxis_test\nStarttime of export\t132959733843760000\tMontag\n\n\n\
             Name\tActCurrent Current\t{again}ActPos Position\nData-Type\tREAL64\tREAL64\n\
             Unit\tA\t{unit}mm\n\n"
        );
        for n in 0..200 {
            let angle = std::f64::consts::TAU * f64::from(n) / 50.0;
            let time = f64::from(n) * 0.5;
            let again = if own_times { format!("{time}\t") } else { String::new() };
            text += &format!("{time}\t{}\t{again}{}\n", angle.cos(), (angle - 0.5).cos());
        }
        text += "EOF\n";
        text.replace('.', decimal).replace('\t', mark)
    }

    fn of(text: &str) -> Result<Measurement, String> {
        read(&[Source { name: "x.csv", bytes: text.as_bytes() }]).map_err(|error| error.to_string())
    }

    #[test]
    fn every_mark_and_layout_of_the_times_gives_the_same_record() {
        let plain = of(&export("\t", true, ",")).unwrap();
        assert_eq!(plain.metadata().response_kind, ResponseKind::Position);
        assert_eq!(plain.metadata().input.unit, "A");
        let omega_rad_s = plain.experiments()[0].omega_rad_s;
        assert!((omega_rad_s / (std::f64::consts::TAU / 0.025) - 1.0).abs() < 1e-9);
        for other in [export(";", true, ","), export(":", false, "."), export("\t", false, ",")] {
            assert_eq!(of(&other).unwrap().experiments(), plain.experiments());
        }
    }

    /// The lines of keys and values that an export has for each channel, with sample times of 0.2 ms
    /// and of another.
    fn documented(sample: &str, other_step_ms: f64) -> String {
        let mut text = format!(
            "Name\taxis_test\n\
             Starttime of export\t132959733843760000\tMontag, 2. Mai 2022\t15:56:24.376\n\n\n\
             Name\tActTorque\tName\tActPos\n\
             Data-Type\tREAL32\tData-Type\tREAL64\n\
             SampleTime[ms]\t0,2\tSampleTime[ms]\t{sample}\n\
             ScaleFactor\t1\tScaleFactor\t1\n\
             Unit\tNm\tUnit\tmm\n\
             Unit ScaleFactor\t1\tUnit ScaleFactor\t1\n\
             Unit Offset\t0\tUnit Offset\t0\n\n"
        );
        for n in 0..200 {
            let angle = std::f64::consts::TAU * f64::from(n) / 50.0;
            let (u, y) = (angle.cos(), (angle - 0.5).cos());
            let [time, other] = [0.2, other_step_ms].map(|step| f64::from(n) * step);
            text += &format!("{time:.1}\t{u:.9}\t{other:.1}\t{y:.9}\n").replace('.', ",");
        }
        text
    }

    #[test]
    fn the_documented_lines_of_keys_and_values_are_understood() {
        let read = of(&documented("0,2", 0.2)).unwrap();
        let metadata = read.metadata();
        assert_eq!((metadata.input.name.as_str(), metadata.input.unit.as_str()), ("torque", "Nm"));
        assert_eq!(
            (metadata.response_kind, metadata.response.unit.as_str()),
            (ResponseKind::Position, "mm")
        );
        let omega_rad_s = read.experiments()[0].omega_rad_s;
        assert!((omega_rad_s / (std::f64::consts::TAU / 0.01) - 1.0).abs() < 1e-9);
        let slower = of(&documented("1", 1.0)).unwrap_err();
        assert!(slower.contains("same times"), "{slower}");
    }

    #[test]
    fn the_start_of_the_export_is_the_time_of_the_measurement() {
        let text = documented("0,2", 0.2);
        let read = of(&text).unwrap();
        // Local time of the line is two hours ahead of UTC.
        let began = "2022-05-02T13:56:24.376Z".parse().unwrap();
        assert_eq!(read.metadata().measured_at, Some(began));
        for other in ["soon", "-1", "99999999999999999999999999999999999999999"] {
            let read = of(&text.replace("132959733843760000", other)).unwrap();
            assert_eq!(read.metadata().measured_at, None, "{other}");
        }
    }

    #[test]
    fn what_is_wrong_is_refused_where_it_is() {
        let text = export("\t", true, ",");
        let faulty = text.replace("\n1,5\t", "\nx\t");
        assert!(of(&faulty).unwrap_err().contains("line 12"), "{:?}", of(&faulty));
        let unnamed = text.replace("ActPos Position", "b");
        assert!(of(&unnamed).is_ok(), "the unit says that it is a position");
        let unknown = unnamed.replace("\tmm", "\t(None)");
        assert!(of(&unknown).unwrap_err().contains("response"), "{:?}", of(&unknown));
        let later = text.replace("\n0\t1\t0\t", "\n0\t1\t0,25\t");
        assert!(of(&later).unwrap_err().contains("same times"), "{:?}", of(&later));
    }

    #[test]
    fn a_mutated_export_is_read_or_refused() {
        let text = export("\t", true, ",");
        for at in 0..300 {
            let mut bytes = text.clone().into_bytes();
            bytes[at] = b"\t\n;,0aN"[at % 7];
            let _ = read(&[Source { name: "x", bytes: &bytes }]);
            let _ = read(&[Source { name: "x", bytes: &text.as_bytes()[..at] }]);
        }
    }
}
