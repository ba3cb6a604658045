//! Logs of BAM (github.com/Rhoban/bam): a servo that moves a pendulum along a trajectory.
//!
//! An object with `entries`. Each has a `timestamp` (s), the `position` and the `goal_position` of
//! the servo's controller (rad), the `speed` (rad/s), whether the torque is on (`torque_enable`), and
//! what a servo reports beside: `load`, `control`, `measured_current`, `torque_demand`, the supply
//! `input_volts` (V), `temp` (°C). `load` is 0 where the recorder does not read it, otherwise in 0.1 %
//! or in %. Beside `entries` are the `mass` and the `length` of the pendulum, the gain `kp`, the
//! `motor`, the `trajectory`; metadata may stand there, too. The entries come from a loop without a
//! clock; those that BAM has processed are at equal times.

mod entries;
mod even;

use std::ops::Range;

use serde_json::{Map, Value};

use super::columns::TIME_RECORD;
use super::fault::Fault;
use super::format::Format;
use super::given::Given;
use super::header::Header;
use super::json_table::{element, object, parse, scalar};
use super::lack;
use super::part::Part;
use super::table::{Place, Table};
use super::time_record;
use crate::measurement::ResponseKind;
use entries::{ERROR, Entries, POSITION, TIME, never_drives};
use even::{Even, Signals};

/// A JSON object with `entries` that have times and a goal.
pub(super) const FORMAT: Format = Format {
    name: "BAM log",
    is: |content| {
        let has = |key: &&str| content.text().is_ok_and(|text| text.contains(*key));
        content.begins_with(&["{"])
            && ["\"entries\"", "\"timestamp\"", "\"goal_position\""].iter().all(has)
    },
    read: |content, given| read(content.text()?, given),
    see: |_, _| None,
};

/// Columns whose unit is known.
const UNITS: [(&str, &str); 2] = [(ERROR, "rad"), ("measured_current", "A")];

/// Most characters of a word of the log in a note, most words, and most entries or steps.
const MOST_SAID: [usize; 3] = [60, 20, 10];

fn read(text: &str, given: &Given) -> Result<Part, Fault> {
    let log = parse(text)?;
    let log = object(&log, "")?;
    let mut header = Header::default();
    let mut notes = vec![format!("the file is a BAM log{}", rig(log))];
    for (key, value) in log.iter().filter(|(key, value)| is_metadata(key) && !value.is_null()) {
        header.set(None, key, &scalar(value, key)?).map_err(|fault| fault.in_column(key))?;
    }
    header.take(given, &mut notes)?;
    let entries = Entries::of(log)?;
    let stretches = stretches(&entries.torque_on);
    if stretches.is_empty() {
        let reason = "the torque is off in every entry: nothing drives the axis";
        return Err(Fault::new(reason).in_column("entries"));
    }
    ask(&header, &entries.driving())?;
    let input = input(&mut header, &entries, &mut notes)?;
    let response = response(&mut header)?;
    if !header.states("loop") {
        header.set(None, "loop", "closed")?;
        notes.push("the servo follows a goal: the loop is taken as closed".into());
    }
    let uses_position = response == POSITION || header.metadata.input.name == ERROR;
    let signals = Signals {
        time_s: entries.require(TIME)?,
        position: entries.require(POSITION)?,
        input,
        output: entries.require(response)?,
        uses_position,
    };
    let even = stretches.iter().map(|stretch| signals.even(stretch.clone()));
    let even: Vec<Even> = even.collect::<Result<_, _>>()?;
    let off = entries.torque_on.iter().filter(|on| !**on).count();
    notes.extend(said(&even, off));
    time_record::read(&table(&stretches, &even)?, header, notes)
}

fn is_metadata(key: &str) -> bool {
    key != "entries" && Header::knows(key)
}

/// What the log says of the rig, in brackets.
fn rig(log: &Map<String, Value>) -> String {
    let [characters, words, _] = MOST_SAID;
    let short = |text: &str| text.chars().take(characters).collect::<String>();
    let said = log.iter().filter(|(key, _)| !is_metadata(key));
    let said = said.filter_map(|(key, value)| match value {
        Value::String(text) => Some(format!("{} {}", short(key), short(text))),
        Value::Number(number) => Some(format!("{} {number}", short(key))),
        _ => None,
    });
    let said: Vec<String> = said.take(words).collect();
    if said.is_empty() { String::new() } else { format!(" ({})", said.join(", ")) }
}

/// Entries with the torque on that follow each other. Without torque the axis swings freely, and what
/// the log says of its drive acts on nothing.
fn stretches(torque_on: &[bool]) -> Vec<Range<usize>> {
    let mut stretches: Vec<Range<usize>> = Vec::new();
    for entry in (0..torque_on.len()).filter(|entry| torque_on[*entry]) {
        match stretches.last_mut() {
            Some(stretch) if stretch.end == entry => stretch.end += 1,
            _ => stretches.push(entry..entry + 1),
        }
    }
    stretches
}

/// Asks for what the log does not say.
fn ask(header: &Header, driving: &[&str]) -> Result<(), Fault> {
    let input = lack::ask("input", driving.first().copied().unwrap_or(ERROR));
    let response = lack::ask("response", "velocity");
    let no_input = format!("the log does not say what drives the axis ({}): {input}", may(driving));
    let no_response = format!(
        "the log has the position and the velocity, either of which may be the response: {response}"
    );
    match (header.states("input"), header.states("response")) {
        (true, true) => Ok(()),
        (false, true) => Err(Fault::new(no_input).lacking(input)),
        (true, false) => Err(Fault::new(no_response).lacking(response)),
        (false, false) => {
            Err(Fault::new(format!("{no_input}; {no_response}")).lacking(input).lacking(response))
        }
    }
}

/// Says which columns may drive the axis.
fn may(driving: &[&str]) -> String {
    let name = |name: &&str| match *name {
        ERROR => "`error`, which is goal_position − position in rad".to_owned(),
        name => format!("`{name}`"),
    };
    match driving {
        [] => "none of the columns that could drive it changes".into(),
        names => format!("it may be {}", names.iter().map(name).collect::<Vec<_>>().join(" or ")),
    }
}

/// The column that is stated as the input.
fn input<'a>(
    header: &mut Header,
    entries: &'a Entries,
    notes: &mut Vec<String>,
) -> Result<&'a [f64], Fault> {
    let driving = entries.driving();
    let name = header.metadata.input.name.clone();
    let wrong = match entries.column(&name) {
        Some(values) if driving.contains(&name.as_str()) => {
            match UNITS.iter().find(|(of, _)| *of == name) {
                Some((_, unit)) => header.infer("input", &format!("{name} [{unit}]"), &name)?,
                None if header.metadata.input.unit.is_empty() => notes.push(format!(
                    "the log does not say the unit of `{name}`; it may follow the name in input"
                )),
                None => {}
            }
            return Ok(values);
        }
        Some(_) if never_drives(&name) => format!("`{name}` is not what drives the axis"),
        Some(_) => format!("`{name}` is the same in every entry with the torque on"),
        None => format!("the log has no column `{name}`"),
    };
    let lack = lack::ask("input", driving.first().copied().unwrap_or(ERROR));
    let reason = format!("{wrong} ({}): {lack}", may(&driving));
    Err(Fault::new(reason).lacking(lack).in_column("input"))
}

/// The name of the column that is the response.
fn response(header: &mut Header) -> Result<&'static str, Fault> {
    let (column, told) = match header.metadata.response_kind {
        ResponseKind::Position => (POSITION, "position rad"),
        ResponseKind::Velocity => ("speed", "velocity rad/s"),
        ResponseKind::Acceleration => {
            let reason = "the log has no acceleration: give velocity or position";
            return Err(Fault::new(reason).in_column("response"));
        }
    };
    header.infer("response", told, column)?;
    Ok(column)
}

/// What was done to the entries, of which so many have the torque off.
fn said(even: &[Even], off: usize) -> Vec<String> {
    let [_, _, most] = MOST_SAID;
    let mut notes = Vec::new();
    if off > 0 {
        notes.push(format!("in {off} entries the torque is off: they are left out"));
    }
    let steps: Vec<[f64; 3]> = even.iter().filter_map(|even| even.steps_s).collect();
    if !steps.is_empty() {
        let shortest_s = steps.iter().map(|steps| steps[0]).fold(f64::INFINITY, f64::min);
        let longest_s = steps.iter().map(|steps| steps[1]).fold(0.0, f64::max);
        let means: Vec<String> =
            steps.iter().take(most).map(|steps| format!("{:.4}", steps[2] * 1e3)).collect();
        notes.push(format!(
            "the entries are {:.3} to {:.3} ms apart: input and response are read on straight \
             lines between them, every {}{} ms",
            shortest_s * 1e3,
            longest_s * 1e3,
            means.join(", "),
            if steps.len() > most { ", …" } else { "" }
        ));
    }
    let dropouts: Vec<usize> = even.iter().flat_map(|even| even.dropouts.clone()).collect();
    if !dropouts.is_empty() {
        let listed = dropouts.iter().take(most).map(|entry| element("entries", *entry));
        notes.push(format!(
            "in {} entries the position jumps and is back with the next ({}{}): they are left out, \
             and the line between their neighbours stands for them",
            dropouts.len(),
            listed.collect::<Vec<_>>().join(", "),
            if dropouts.len() > most { ", …" } else { "" }
        ));
    }
    notes
}

/// The table of the stretches: segments where there are several.
fn table(stretches: &[Range<usize>], even: &[Even]) -> Result<Table, Fault> {
    let columns = &TIME_RECORD[..if even.len() > 1 { 4 } else { 3 }];
    let mut table = Table::new(columns.to_vec(), None);
    for (segment, (stretch, even)) in stretches.iter().zip(even).enumerate() {
        for (row, time_s) in even.time_s.iter().enumerate() {
            let cells = [*time_s, even.input[row], even.output[row], segment as f64];
            let place = Place::Object(element("entries", stretch.start + row));
            table.push(place, cells.map(|cell| Ok(Some(cell))))?;
        }
    }
    Ok(table)
}

#[cfg(test)]
pub(super) mod tests;
