//! Logs of WPILib SysId in JSON: two ramps and two steps of the voltage, each with rows of time,
//! voltage, position and velocity.

use serde_json::Value;

use super::columns::{Column, TIME_RECORD};
use super::fault::Fault;
use super::format::Format;
use super::given::Given;
use super::header::Header;
use super::json_table::parse;
use super::lack;
use super::limits::MAX_ROWS;
use super::part::Part;
use super::table::{Place, Table};
use super::time_record;
use crate::measurement::ResponseKind;

/// A JSON object that says `"sysid": true`.
pub(super) const FORMAT: Format = Format {
    name: "log of WPILib SysId",
    is: |content| {
        content.begins_with(&["{"])
            && content.text().is_ok_and(|text| text.contains("\"sysid\""))
            && content.text().is_ok_and(|text| TESTS.iter().any(|test| text.contains(test)))
    },
    read: |content, given| read(content.text()?, given),
    see: |_, _| None,
};

/// The tests, in the order in which they are run.
const TESTS: [&str; 4] = ["slow-forward", "slow-backward", "fast-forward", "fast-backward"];

fn read(text: &str, given: &Given) -> Result<Part, Fault> {
    let log = parse(text)?;
    let mut header = Header::default();
    let mut notes = vec!["the file is a log of WPILib SysId".to_owned()];
    header.take(given, &mut notes)?;
    if !header.states("response") {
        let lack = lack::ask("response", "velocity");
        return Err(Fault::new(format!(
            "the log has the position and the velocity, either of which may be the response: {lack}"
        ))
        .lacking(lack));
    }
    let column = match header.metadata.response_kind {
        ResponseKind::Position => 2,
        ResponseKind::Velocity => 3,
        ResponseKind::Acceleration => {
            let reason = "the log has no acceleration: give velocity or position";
            return Err(Fault::new(reason).in_column("response"));
        }
    };
    if !header.states("input") {
        header.set(None, "input", "voltage V")?;
    }
    if let Some(unit) = log.get("units").and_then(Value::as_str) {
        let unit = unit.to_lowercase();
        let response = match column {
            2 => format!("position {unit}"),
            _ => format!("velocity {unit}/s"),
        };
        header.infer("response", &response, "units")?;
    }
    // Ramps and steps do not repeat.
    if !header.states("period_s") {
        header.set(None, "period_s", "none")?;
    }
    let mut table = Table::new(TIME_RECORD.to_vec(), None);
    for (segment, test) in TESTS.into_iter().enumerate() {
        let Some(rows) = log.get(test) else { continue };
        let rows = rows.as_array().ok_or_else(|| Fault::new("not an array").in_column(test))?;
        if table.len() + rows.len() > MAX_ROWS {
            return Err(Fault::new(format!("more than {MAX_ROWS} rows")));
        }
        for (index, row) in rows.iter().enumerate() {
            let numbers = numbers(row)
                .map_err(|reason| Fault::new(reason).in_column(format!("{test}[{index}]")))?;
            let cells = TIME_RECORD.iter().map(|of| {
                Ok(Some(match of {
                    Column::TimeS => numbers[0],
                    Column::Input => numbers[1],
                    Column::Output => numbers[column],
                    _ => segment as f64,
                }))
            });
            table.push(Place::Element(test.into(), index), cells)?;
        }
    }
    if table.len() == 0 {
        return Err(Fault::new("the log has no sample"));
    }
    time_record::read(&table, header, notes)
}

/// The four numbers of a row.
fn numbers(row: &Value) -> Result<[f64; 4], String> {
    let numbers: Option<Vec<f64>> =
        row.as_array().and_then(|row| row.iter().map(Value::as_f64).collect());
    match numbers.as_deref() {
        Some([time, volt, position, velocity]) => Ok([*time, *volt, *position, *velocity]),
        Some(numbers) if numbers.len() == 10 => {
            Err("a drive train has two sides: write one side alone, as four columns".into())
        }
        _ => Err("a row is four numbers: time, voltage, position, velocity".into()),
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::super::{Source, read};
    use crate::measurement::Measurement;

    /// A log of two tests with so many columns.
    pub(crate) fn log(columns: usize) -> String {
        let rows = |start: f64| {
            let row = |n: i32| {
                let time = f64::from(n) * 0.005;
                let velocity = 1.0 - (-5.0 * time).exp();
                let mut row = vec![start + time, 2.0, velocity * time, velocity];
                row.resize(columns, 0.0);
                row
            };
            serde_json::json!((0..60).map(row).collect::<Vec<_>>())
        };
        serde_json::json!({
            "sysid": true, "test": "Simple", "units": "Meters", "unitsPerRotation": 1.0,
            "slow-forward": rows(1.0), "fast-forward": rows(10.0),
        })
        .to_string()
    }

    fn of(text: &str, response: &str) -> Result<Measurement, String> {
        let given = format!("# given with the upload\n# response: {response}\n");
        let sources = [
            Source { name: "log.json", bytes: text.as_bytes() },
            Source { name: "given", bytes: given.as_bytes() },
        ];
        read(if response.is_empty() { &sources[..1] } else { &sources })
            .map_err(|error| error.to_string())
    }

    #[test]
    fn each_test_is_a_motion_with_the_response_that_is_asked_for() {
        let asked = of(&log(4), "").unwrap_err();
        assert!(asked.contains("--response velocity"), "{asked}");
        let velocity = of(&log(4), "velocity").unwrap();
        assert_eq!(velocity.transients().len(), 2);
        assert_eq!(velocity.metadata().response.unit, "meters/s");
        assert_eq!(velocity.metadata().input.unit, "V");
        let position = of(&log(4), "position").unwrap();
        assert_eq!(position.metadata().response.unit, "meters");
        assert_ne!(position.transients(), velocity.transients());
    }

    #[test]
    fn a_drive_train_and_rows_of_another_form_are_refused() {
        assert!(of(&log(10), "velocity").unwrap_err().contains("drive train"));
        assert!(of(&log(5), "velocity").unwrap_err().contains("slow-forward[0]"));
        assert!(of(&log(4), "acceleration m/s²").unwrap_err().contains("no acceleration"));
    }
}
