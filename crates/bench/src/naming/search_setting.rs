//! Settings of the search by name.

use std::fmt;
use std::str::FromStr;

use serde_json::{Number, Value};
use servoscope_core::identify::SearchSettings;

/// The names and values of all settings; the name of a nested one has a dot.
pub fn search_settings(search: &SearchSettings) -> Vec<(String, Number)> {
    let mut settings = Vec::new();
    collect(&tree(search), "", &mut settings);
    settings
}

fn tree(search: &SearchSettings) -> Value {
    serde_json::to_value(search).expect("numbers by name")
}

fn collect(value: &Value, name: &str, settings: &mut Vec<(String, Number)>) {
    match value {
        Value::Object(members) => {
            let dot = if name.is_empty() { "" } else { "." };
            members.iter().for_each(|(own, v)| collect(v, &format!("{name}{dot}{own}"), settings));
        }
        Value::Number(number) => settings.push((name.to_owned(), number.clone())),
        _ => {}
    }
}

/// A setting with a new value.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SettingChange {
    /// Its name.
    pub name: String,
    /// Its new value.
    pub value: Number,
}

impl SettingChange {
    /// The setting with half its value; a count is rounded down, but at least 1.
    pub(super) fn half(name: &str, value: &Number) -> Self {
        let value = match value.as_u64() {
            Some(count) => Number::from((count / 2).max(1)),
            None => scaled(value, 0.5),
        };
        Self { name: name.to_owned(), value }
    }

    /// The setting with twice its value.
    pub(super) fn double(name: &str, value: &Number) -> Self {
        let value = match value.as_u64() {
            Some(count) => Number::from(2 * count),
            None => scaled(value, 2.0),
        };
        Self { name: name.to_owned(), value }
    }

    /// The settings with this change.
    ///
    /// # Errors
    /// A message: no setting has that name, with a list of those that exist, or the setting cannot
    /// have that value.
    pub fn apply(&self, search: &SearchSettings) -> Result<SearchSettings, String> {
        let Self { name, value } = self;
        let mut tree = tree(search);
        let place = tree.pointer_mut(&format!("/{}", name.replace('.', "/")));
        let Some(place) = place.filter(|place| place.is_number()) else {
            let known: Vec<String> = search_settings(search).into_iter().map(|s| s.0).collect();
            return Err(format!("`{name}` is no setting; there are {}", known.join(", ")));
        };
        let is_count = place.is_u64();
        if is_count && !value.is_u64() {
            return Err(format!("`{name}` is a count, which {value} is not"));
        }
        if !is_count && value.as_f64().is_none_or(|value| value <= 0.0) {
            return Err(format!("`{name}` must be positive, which {value} is not"));
        }
        *place = Value::Number(value.clone());
        serde_json::from_value(tree).map_err(|error| format!("`{name}`: {error}"))
    }
}

fn scaled(value: &Number, factor: f64) -> Number {
    let scaled = value.as_f64().map(|value| factor * value);
    scaled.and_then(Number::from_f64).unwrap_or_else(|| value.clone())
}

/// As on the command line: `NAME=VALUE`.
impl fmt::Display for SettingChange {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}={}", self.name, self.value)
    }
}

impl FromStr for SettingChange {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let Some((name, value)) = text.split_once('=') else {
            return Err(format!("`{text}` is not of the form NAME=VALUE"));
        };
        let value = value.parse().map_err(|_| format!("`{value}` is no number"))?;
        let change = Self { name: name.to_owned(), value };
        change.apply(&SearchSettings::default())?;
        Ok(change)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn changed(text: &str) -> Result<SearchSettings, String> {
        text.parse::<SettingChange>()?.apply(&SearchSettings::default())
    }

    #[test]
    fn every_setting_is_listed_and_can_be_set_to_half_and_to_twice_its_value() {
        let default = SearchSettings::default();
        let settings = search_settings(&default);
        assert!(settings.iter().any(|(name, _)| name == "cosines.single_starts"));
        for (name, value) in &settings {
            let same = SettingChange { name: name.clone(), value: value.clone() };
            assert_eq!(same.apply(&default), Ok(default));
            for change in [SettingChange::half(name, value), SettingChange::double(name, value)] {
                let applied = change.apply(&default).unwrap();
                assert_eq!(applied == default, change.value == *value, "{change}");
                assert_eq!(change.to_string().parse(), Ok(change));
            }
        }
    }

    #[test]
    fn a_setting_is_changed_by_its_name_and_the_others_stay() {
        let mut expected = SearchSettings::default();
        expected.cosines.single_starts = 7;
        assert_eq!(changed("cosines.single_starts=7"), Ok(expected));
        let expected = SearchSettings { rival_share: 0.25, ..SearchSettings::default() };
        assert_eq!(changed("rival_share=0.25"), Ok(expected));
    }

    #[test]
    fn what_is_no_setting_or_no_value_of_it_is_refused_in_words() {
        let refused = |text: &str| changed(text).unwrap_err();
        assert!(refused("rivalshare=1").contains("rival_share"));
        assert!(refused("cosines=1").contains("no setting"));
        assert!(refused("rival_share").contains("NAME=VALUE"));
        assert!(refused("rival_share=half").contains("no number"));
        assert!(refused("rival_share=0").contains("positive"));
        assert!(refused("glance_steps=2.5").contains("count"));
        assert!(refused("glance_steps=-1").contains("count"));
    }
}
