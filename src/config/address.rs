//! The address of a broker or a database, which may hold a password.

use std::convert::Infallible;
use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize, Serializer};

/// An address as it was given. Wherever it is shown, its password is not.
#[derive(Clone, PartialEq, Eq, Deserialize)]
pub struct Address(String);

impl Address {
    /// The whole address, for the connection alone.
    pub fn reveal(&self) -> &str {
        &self.0
    }

    /// The address with `***` for its password and for whatever follows a question mark.
    fn shown(&self) -> String {
        let address = self.with_password_hidden();
        match address.split_once('?') {
            Some((address, _)) => format!("{address}?***"),
            None => address,
        }
    }

    fn with_password_hidden(&self) -> String {
        let Some((before, host)) = self.0.rsplit_once('@') else { return self.0.clone() };
        let (scheme, user) = before.split_once("://").unwrap_or(("", before));
        match user.split_once(':') {
            Some((user, _)) => format!("{scheme}://{user}:***@{host}"),
            None => self.0.clone(),
        }
    }
}

impl FromStr for Address {
    type Err = Infallible;

    // Checked later: the words of the parser of arguments would repeat the address.
    fn from_str(text: &str) -> Result<Self, Infallible> {
        Ok(Self(text.to_owned()))
    }
}

impl fmt::Display for Address {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(&self.shown())
    }
}

impl fmt::Debug for Address {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "{self}")
    }
}

impl Serialize for Address {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(&self.shown())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_address_is_shown_without_its_password() {
        for (address, shown) in [
            ("mqtt://bench:se@cret@host:1883", "mqtt://bench:***@host:1883"),
            ("bench:secret@host", "://bench:***@host"),
            ("mqtt://bench@host", "mqtt://bench@host"),
            ("mqtt://host:1883", "mqtt://host:1883"),
            ("postgres://host/bench?password=secret", "postgres://host/bench?***"),
            ("postgres://bench:se?cret@host/bench", "postgres://bench:***@host/bench"),
            ("postgres://host/a?user=b&password=se@cret", "postgres://host/a?***"),
        ] {
            let address = Address(address.into());
            assert_eq!(format!("{address:?}"), shown);
            assert_eq!(toml::Value::try_from(&address).unwrap().as_str(), Some(shown));
        }
    }
}
