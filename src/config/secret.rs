//! A setting that nobody may see.

use std::convert::Infallible;
use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize, Serializer};

/// What is shown in its place.
const SHOWN: &str = "***";

/// A key as it was given. Wherever it is shown, it is `***`.
#[derive(Clone, PartialEq, Eq, Deserialize)]
pub struct SecretText(String);

impl SecretText {
    /// The key itself.
    pub fn reveal(&self) -> &str {
        &self.0
    }
}

impl From<String> for SecretText {
    fn from(text: String) -> Self {
        Self(text)
    }
}

impl FromStr for SecretText {
    type Err = Infallible;

    // Checked later: the words of the parser of arguments would repeat it.
    fn from_str(text: &str) -> Result<Self, Infallible> {
        Ok(Self(text.to_owned()))
    }
}

impl fmt::Debug for SecretText {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(SHOWN)
    }
}

impl Serialize for SecretText {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(SHOWN)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_key_is_never_shown() {
        let key = SecretText("sk_servoscope_a_b".into());
        assert_eq!(format!("{key:?}"), "***");
        assert_eq!(toml::Value::try_from(&key).unwrap().as_str(), Some("***"));
        assert_eq!(key.reveal(), "sk_servoscope_a_b");
    }
}
