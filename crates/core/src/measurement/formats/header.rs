//! Reads the `key: value` metadata of one file.

use std::collections::BTreeMap;

use super::convention::{AmplitudeUnit, Convention, Reference};
use super::decimal::Mark;
use super::fault::Fault;
use super::given::Given;
use super::limits::{MAX_LABELS, MAX_METADATA};
use super::values::{averages, magnitude, names, number, period, sample, settle_periods};
use crate::measurement::units;
use crate::measurement::{Beginning, Intersample, Loop, Metadata, Quantity, ResponseKind};

/// Metadata of one file, and the settings for reading its numbers.
#[derive(Debug, Clone, Default)]
pub(super) struct Header {
    pub(super) metadata: Metadata,
    pub(super) convention: Convention,
    /// Period of a time record, s.
    pub(super) period_s: Option<f64>,
    /// Whether the file states that a time record has no period (`period_s: none`).
    pub(super) aperiodic: bool,
    /// Course of the input of a record without period between samples.
    pub(super) intersample: Option<Intersample>,
    /// Initial state of a record without period.
    pub(super) beginning: Beginning,
    /// Periods to drop at the beginning of a time record, if stated.
    pub(super) settle_periods: Option<usize>,
    /// Averages behind each `coherence` of a harmonic table, where a row does not state its own.
    pub(super) averages: Option<f64>,
    /// Whether the repeats of a harmonic table are the periods of one record.
    pub(super) repeats_are_periods: bool,
    /// Magnitude of the input in every row of a harmonic table, in its amplitude convention.
    pub(super) magnitude: Option<f64>,
    /// Decimal mark of a text, if stated.
    pub(super) decimal: Option<Mark>,
    /// Whether the response is read with the opposite sign.
    pub(super) inverted: bool,
    /// Whether rows of a time record with a blank segment are left out (ramps and settling).
    pub(super) blank_segments_unused: bool,
    /// Time between the samples of a record that has no column of times, s.
    pub(super) sample_s: Option<f64>,
    /// Names of the columns of a text, in place of those that it has.
    pub(super) column_names: Option<Vec<String>>,
    /// Line and value of every key seen.
    seen: BTreeMap<String, (Option<u64>, String)>,
}

impl Header {
    /// Reads one `key: value`; returns `false` if the key is unknown.
    pub(super) fn set(&mut self, line: Option<u64>, key: &str, value: &str) -> Result<bool, Fault> {
        // A JSON string may hold line breaks, which would corrupt a CSV preamble written from it.
        let value = value.split_whitespace().collect::<Vec<_>>().join(" ");
        let fault = |reason: String| Fault::new(reason).at_line(line).in_column(key);
        if !self.apply(key, &value).map_err(fault)? {
            return Ok(false);
        }
        self.check_storable(key, &value).map_err(fault)?;
        if let Some((_, earlier)) = self.seen.get(key)
            && *earlier != value
        {
            return Err(fault(format!("given twice: `{earlier}` and `{value}`")));
        }
        self.seen.insert(key.to_owned(), (line, value));
        Ok(true)
    }

    /// Refuses what no list of measurements has room for, and what not every database keeps.
    fn check_storable(&self, key: &str, value: &str) -> Result<(), String> {
        if key.contains('\0') || value.contains('\0') {
            return Err("it has a NUL character; remove it".into());
        }
        let longest = key.len().max(if key == "column_names" { 0 } else { value.len() });
        if longest > MAX_METADATA {
            return Err(format!("it has {longest} bytes; at most {MAX_METADATA} are taken"));
        }
        if self.metadata.labels.len() > MAX_LABELS {
            return Err(format!("there are more than {MAX_LABELS} labels"));
        }
        Ok(())
    }

    /// Takes over what is given beside the file. Where the file says something else, a note says
    /// so.
    pub(super) fn take(&mut self, given: &Given, notes: &mut Vec<String>) -> Result<(), Fault> {
        for (key, value) in given.entries() {
            match self.seen.remove(key) {
                Some((_, earlier)) if earlier != value => notes.push(format!(
                    "{key} is `{value}`, as given with the upload, not `{earlier}`, as in the file"
                )),
                _ => {}
            }
            self.set(None, key, value)?;
        }
        Ok(())
    }

    /// Takes over the input or the response that the name of a column tells.
    ///
    /// # Errors
    /// If the metadata states another unit, or another kind of the response.
    pub(super) fn infer(&mut self, key: &str, value: &str, column: &str) -> Result<(), Fault> {
        let mut told = Self::default();
        told.set(None, key, value).map_err(|fault| fault.in_column(column))?;
        let of = |header: &mut Self| match key {
            "input" => header.metadata.input.clone(),
            _ => header.metadata.response.clone(),
        };
        let (stated, told_quantity) = (of(self), of(&mut told));
        if !self.states(key) {
            self.metadata.response_kind = match key {
                "input" => self.metadata.response_kind,
                _ => told.metadata.response_kind,
            };
        }
        let kinds_differ =
            key == "response" && told.metadata.response_kind != self.metadata.response_kind;
        let units_differ = !stated.unit.is_empty()
            && !told_quantity.unit.is_empty()
            && stated.unit != told_quantity.unit;
        if kinds_differ || units_differ {
            return Err(Fault::new(format!(
                "the column is `{}`, but the {key} is said to be `{} {}`: correct the one or the \
                 other",
                [told_quantity.name, told_quantity.unit].join(" ").trim(),
                stated.name,
                stated.unit
            ))
            .in_column(column));
        }
        let open = match key {
            "input" => &mut self.metadata.input,
            _ => &mut self.metadata.response,
        };
        if open.name.is_empty() {
            open.name = told_quantity.name;
        }
        if open.unit.is_empty() {
            open.unit = told_quantity.unit;
        }
        Ok(())
    }

    /// Whether the key was given.
    pub(super) fn states(&self, key: &str) -> bool {
        self.seen.contains_key(key)
    }

    /// Whether the key is known.
    pub(super) fn knows(key: &str) -> bool {
        !matches!(Self::default().apply(key, ""), Ok(false))
    }

    /// Line of the file in which a key was given.
    pub(super) fn line_of(&self, key: &str) -> Option<u64> {
        self.seen.get(key).and_then(|(line, _)| *line)
    }

    fn apply(&mut self, key: &str, value: &str) -> Result<bool, String> {
        let metadata = &mut self.metadata;
        let text = || (!value.is_empty()).then(|| value.to_owned());
        match key {
            "name" => metadata.name = text(),
            "machine" => metadata.machine = text(),
            "axis" => metadata.axis = text(),
            "operator" => metadata.operator = text(),
            "input" => metadata.input = quantity(value),
            "response" => {
                metadata.response = quantity(value);
                metadata.response_kind = response_kind(&metadata.response.name)?;
                check_unit(metadata)?;
            }
            "loop" => {
                metadata.feedback = Some(match value {
                    "open" => Loop::Open,
                    "closed" => Loop::Closed,
                    _ => return Err(format!("`{value}` is neither open nor closed")),
                });
            }
            "measured_at" => {
                metadata.measured_at = Some(value.parse().map_err(|_| {
                    format!("`{value}` is not an RFC 3339 time such as 2024-05-31T13:45:00Z")
                })?);
            }
            "reference" => {
                self.convention.reference = match value {
                    "cos" => Reference::Cosine,
                    "sin" => Reference::Sine,
                    _ => return Err(format!("`{value}` is neither cos nor sin")),
                };
            }
            "amplitude" => {
                self.convention.amplitude = match value {
                    "peak" => AmplitudeUnit::Peak,
                    "rms" => AmplitudeUnit::Rms,
                    "peak-to-peak" => AmplitudeUnit::PeakToPeak,
                    _ => return Err(format!("`{value}` is not peak, rms or peak-to-peak")),
                };
            }
            "period_s" if value == "none" => (self.period_s, self.aperiodic) = (None, true),
            "period_s" => (self.period_s, self.aperiodic) = (Some(period(value)?), false),
            "intersample" => {
                self.intersample = match value {
                    "linear" => Some(Intersample::Linear),
                    "hold" => Some(Intersample::Hold),
                    _ => return Err(format!("`{value}` is neither linear nor hold")),
                };
            }
            "initial_velocity" => self.beginning.velocity = Some(number(value)?),
            "initial_position" => self.beginning.position = Some(number(value)?),
            "settle_s" => match number(value)? {
                settle_s if settle_s >= 0.0 => self.beginning.settle_s = Some(settle_s),
                _ => return Err(format!("`{value}` is not a number of seconds ≥ 0")),
            },
            "settle_periods" => self.settle_periods = Some(settle_periods(value)?),
            "averages" => self.averages = Some(averages(value)?),
            "magnitude" => self.magnitude = Some(magnitude(value)?),
            "decimal" => {
                self.decimal = match value {
                    "comma" => Some(Mark::Comma),
                    "point" => Some(Mark::Point),
                    _ => return Err(format!("`{value}` is neither comma nor point")),
                };
            }
            "inverted" => {
                self.inverted = match value {
                    "yes" => true,
                    "no" => false,
                    _ => return Err(format!("`{value}` is neither yes nor no")),
                };
            }
            "blank_segments" => {
                self.blank_segments_unused = match value {
                    "unused" => true,
                    "refused" => false,
                    _ => return Err(format!("`{value}` is neither unused nor refused")),
                };
            }
            "sample_s" => self.sample_s = Some(sample(value)?),
            "column_names" => self.column_names = Some(names(value)?),
            // Looked up before there is a text with metadata: see `xlsx`.
            "sheet" if value.is_empty() => return Err("the name of a sheet is needed".into()),
            "sheet" => {}
            "repeats" => {
                self.repeats_are_periods = match value {
                    "periods" => true,
                    "measurements" => false,
                    _ => return Err(format!("`{value}` is neither periods nor measurements")),
                };
            }
            _ => match key.strip_prefix("label.") {
                Some(label) if label.contains([':', '\n', '\r']) => {
                    return Err("a label's name must have no colon and no line break".into());
                }
                Some(label) if !label.is_empty() => {
                    metadata.labels.insert(label.to_owned(), value.to_owned());
                }
                _ => return Ok(false),
            },
        }
        Ok(true)
    }
}

/// Splits `force N` into the first word as name and the rest as unit, and `motor current [A]` at
/// the brackets.
fn quantity(text: &str) -> Quantity {
    let bracketed = [('[', ']'), ('(', ')')].into_iter().find_map(|(open, close)| {
        let (name, unit) = text.strip_suffix(close)?.rsplit_once(open)?;
        Some((name, unit))
    });
    let (name, unit) =
        bracketed.unwrap_or_else(|| text.split_once(char::is_whitespace).unwrap_or((text, "")));
    Quantity { name: name.trim().to_owned(), unit: unit.trim().to_owned() }
}

fn response_kind(name: &str) -> Result<ResponseKind, String> {
    match name.split_whitespace().next().unwrap_or("").to_ascii_lowercase().as_str() {
        "velocity" => Ok(ResponseKind::Velocity),
        "position" => Ok(ResponseKind::Position),
        "acceleration" => Ok(ResponseKind::Acceleration),
        other => Err(format!(
            "the first word must be velocity, position or acceleration, but is `{other}`"
        )),
    }
}

/// Checks that the unit of the response does not belong to another kind than its name.
fn check_unit(metadata: &Metadata) -> Result<(), String> {
    let named = |kind: ResponseKind| format!("{kind:?}").to_lowercase();
    match units::kind_of(&metadata.response.unit) {
        Some(kind) if kind != metadata.response_kind => Err(format!(
            "the response is called {}, but `{}` is a unit of {}: correct the one or the other",
            named(metadata.response_kind),
            metadata.response.unit,
            named(kind),
        )),
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn header(key: &str, value: &str) -> Header {
        let mut header = Header::default();
        assert_eq!(header.set(Some(1), key, value), Ok(true));
        header
    }

    #[test]
    fn a_quantity_is_a_name_and_a_unit() {
        let of = |text| {
            let Quantity { name, unit } = quantity(text);
            (name, unit)
        };
        assert_eq!(of("current A"), ("current".into(), "A".into()));
        assert_eq!(of("torque N m"), ("torque".into(), "N m".into()));
        assert_eq!(of("motor current [A]"), ("motor current".into(), "A".into()));
        assert_eq!(of("force (N)"), ("force".into(), "N".into()));
        assert_eq!(of("voltage"), ("voltage".into(), String::new()));
    }

    #[test]
    fn every_header_key_sets_its_own_field() {
        assert_eq!(header("name", "axis test").metadata.name.as_deref(), Some("axis test"));
        assert_eq!(header("machine", "mill 3").metadata.machine.as_deref(), Some("mill 3"));
        assert_eq!(header("axis", "X").metadata.axis.as_deref(), Some("X"));
        assert_eq!(header("operator", "Ada").metadata.operator.as_deref(), Some("Ada"));
        assert_eq!(header("label.shift", "night").metadata.labels["shift"], "night");
        assert_eq!(header("loop", "closed").metadata.feedback, Some(Loop::Closed));
        assert_eq!(header("settle_periods", "2").settle_periods, Some(2));
        assert_eq!(header("averages", "16").averages, Some(16.0));
        assert_eq!(header("magnitude", "0.5").magnitude, Some(0.5));
        assert!(header("inverted", "yes").inverted && !header("inverted", "no").inverted);
        assert_eq!(header("sample_s", "0.001").sample_s, Some(0.001));
        assert_eq!(header("decimal", "comma").decimal, Some(Mark::Comma));
        assert_eq!(header("column_names", "a, b c,").column_names.unwrap(), ["a", "b c", ""]);
        assert_eq!(
            header("column_names", "Gain, dB;;b").column_names.unwrap(),
            ["Gain, dB", "", "b"]
        );
        assert_eq!(header("period_s", "6.24").period_s, Some(6.24));
        assert!(header("period_s", "none").aperiodic);
        assert_eq!(header("intersample", "hold").intersample, Some(Intersample::Hold));
        assert_eq!(header("initial_velocity", "-0.5").beginning.velocity, Some(-0.5));
        assert_eq!(header("initial_position", "2").beginning.position, Some(2.0));
        assert_eq!(header("settle_s", "0").beginning.settle_s, Some(0.0));
        assert_eq!(header("response", "Position m").metadata.response_kind, ResponseKind::Position);
        let measured_at = header("measured_at", "2024-05-31T13:45:00+02:00").metadata.measured_at;
        assert_eq!(measured_at, Some("2024-05-31T11:45:00Z".parse().unwrap()));
    }

    #[test]
    fn a_value_that_means_nothing_is_refused_with_its_line_and_key() {
        for (key, value) in [
            ("response", "temperature K"),
            ("response", "velocity rad"),
            ("response", "position [m/s]"),
            ("measured_at", "yesterday"),
            ("loop", "half"),
            ("reference", "tan"),
            ("amplitude", "loud"),
            ("period_s", "-1"),
            ("period_s", "NaN"),
            ("settle_periods", "1.5"),
            ("averages", "0"),
            ("averages", "inf"),
            ("averages", "many"),
            ("settle_periods", "1e300"),
            ("settle_s", "-1"),
            ("initial_velocity", "fast"),
            ("initial_position", "inf"),
            ("intersample", "cubic"),
            ("magnitude", "0"),
            ("decimal", "dot"),
            ("inverted", "half"),
            ("sample_s", "0"),
            ("sheet", ""),
            ("column_names", "a"),
        ] {
            let fault = Header::default().set(Some(7), key, value).unwrap_err().in_file("f.csv");
            assert_eq!((fault.line, fault.column.as_deref()), (Some(7), Some(key)), "{fault}");
        }
    }

    #[test]
    fn a_key_given_twice_with_two_values_is_refused() {
        let mut header = header("axis", "X");
        assert_eq!(header.set(Some(2), "axis", "X"), Ok(true));
        assert!(header.set(Some(3), "axis", "Y").is_err());
    }

    #[test]
    fn what_is_given_beside_the_file_holds_and_a_note_says_so() {
        let mut given = Given::default();
        given.set("axis", "Y").unwrap();
        given.set("loop", "open").unwrap();
        let (mut header, mut notes) = (header("axis", "X"), Vec::new());
        header.take(&given, &mut notes).unwrap();
        assert_eq!(header.metadata.axis.as_deref(), Some("Y"));
        assert_eq!(header.metadata.feedback, Some(Loop::Open));
        assert!(notes.len() == 1 && notes[0].contains("not `X`"), "{notes:?}");
    }

    #[test]
    fn metadata_has_a_size_and_what_is_unknown_is_only_passed_over() {
        let mut header = Header::default();
        let long = "x".repeat(MAX_METADATA + 1);
        assert!(header.set(Some(3), "machine", &long).is_err());
        assert!(header.set(None, "machine", &long[1..]).unwrap());
        assert!(header.set(None, &format!("label.{long}"), "north").is_err());
        assert!(header.set(None, "machine", "press\0").is_err());
        assert!(header.set(None, "label.site\0", "north").is_err());
        assert!(!header.set(None, "remark", &long).unwrap());
        let mut header = Header::default();
        for label in 0..MAX_LABELS {
            header.set(None, &format!("label.{label}"), "a").unwrap();
        }
        assert!(header.set(None, "label.more", "a").is_err());
    }

    #[test]
    fn a_column_tells_what_the_metadata_does_not_and_may_not_contradict_it() {
        let mut silent = Header::default();
        silent.infer("response", "position mm", "Lage (mm)").unwrap();
        assert_eq!(silent.metadata.response_kind, ResponseKind::Position);
        assert_eq!(silent.metadata.response.unit, "mm");
        let mut without_unit = header("input", "force");
        without_unit.infer("input", "current [A]", "I (A)").unwrap();
        assert_eq!(
            without_unit.metadata.input,
            Quantity { name: "force".into(), unit: "A".into() }
        );
        for (key, stated, told) in [
            ("response", "velocity rad/s", "position rad"),
            ("response", "position m", "position mm"),
            ("input", "current A", "current [mA]"),
        ] {
            let error = header(key, stated).infer(key, told, "c").unwrap_err().in_file("f");
            assert!(error.reason.contains(stated), "{error}");
        }
    }

    #[test]
    fn an_unknown_key_is_said_to_be_unknown() {
        assert_eq!(Header::default().set(Some(1), "temperature", "25"), Ok(false));
    }
}
