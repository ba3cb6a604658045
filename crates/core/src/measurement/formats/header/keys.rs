//! The keys of the metadata, and what their values set.

use super::Header;
use crate::measurement::formats::convention::{AmplitudeUnit, Reference};
use crate::measurement::formats::decimal::Mark;
use crate::measurement::formats::values::{
    averages, magnitude, names, number, period, sample, settle_periods,
};
use crate::measurement::units;
use crate::measurement::{Intersample, Loop, Metadata, Quantity, ResponseKind};

impl Header {
    /// Sets what a key in lower case states; returns `false` if the key is unknown.
    pub(super) fn apply(&mut self, key: &str, value: &str) -> Result<bool, String> {
        let metadata = &mut self.metadata;
        let text = || (!value.is_empty()).then(|| value.to_owned());
        let word = value.to_ascii_lowercase();
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
                metadata.feedback = Some(match word.as_str() {
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
                self.convention.reference = match word.as_str() {
                    "cos" => Reference::Cosine,
                    "sin" => Reference::Sine,
                    _ => return Err(format!("`{value}` is neither cos nor sin")),
                };
            }
            "amplitude" => {
                self.convention.amplitude = match word.as_str() {
                    "peak" => AmplitudeUnit::Peak,
                    "rms" => AmplitudeUnit::Rms,
                    "peak-to-peak" => AmplitudeUnit::PeakToPeak,
                    _ => return Err(format!("`{value}` is not peak, rms or peak-to-peak")),
                };
            }
            "period_s" if word == "none" => (self.period_s, self.aperiodic) = (None, true),
            "period_s" => (self.period_s, self.aperiodic) = (Some(period(value)?), false),
            "intersample" => {
                self.intersample = match word.as_str() {
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
                self.decimal = match word.as_str() {
                    "comma" => Some(Mark::Comma),
                    "point" => Some(Mark::Point),
                    _ => return Err(format!("`{value}` is neither comma nor point")),
                };
            }
            "inverted" => {
                self.inverted = match word.as_str() {
                    "yes" => true,
                    "no" => false,
                    _ => return Err(format!("`{value}` is neither yes nor no")),
                };
            }
            "blank_segments" => {
                self.blank_segments_unused = match word.as_str() {
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
                self.repeats_are_periods = match word.as_str() {
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
pub(super) fn quantity(text: &str) -> Quantity {
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
