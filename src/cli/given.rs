//! What a command states beside its files: settings and metadata that they lack.

use std::path::{Path, PathBuf};

use servoscope_core::measurement::formats::Given;

use super::Failure;

/// Arguments of every command that reads measurements. They hold for all files, and before what
/// the files say.
#[derive(Debug, Default, clap::Args)]
#[group(skip)]
#[command(next_help_heading = "How the files are read")]
pub(super) struct Args {
    /// Takes any of the following from a TOML file, such as `sample_s = 0.001`; an option on the
    /// command line takes precedence.
    #[arg(long, value_name = "FILE")]
    mapping: Option<PathBuf>,
    /// Magnitude of the input at every frequency [default: the column of the table].
    #[arg(long, value_name = "M")]
    magnitude: Option<String>,
    /// What the input is, such as `current A` [default: as the file says].
    #[arg(long, value_name = "NAME UNIT")]
    input: Option<String>,
    /// What the response is, such as `velocity rad/s`, `position mm` or `acceleration m/s²`
    /// [default: as the file says].
    #[arg(long, value_name = "KIND UNIT")]
    response: Option<String>,
    /// Whether the axis was measured in an open or a closed loop [default: as the file says].
    #[arg(long = "loop", value_name = "KIND", value_parser = ["open", "closed"])]
    feedback: Option<String>,
    /// What the amplitudes are [default: peak].
    #[arg(long, value_name = "KIND", value_parser = ["peak", "rms", "peak-to-peak"])]
    amplitude: Option<String>,
    /// Period of a time record, seconds; `none` for a record without a period [default: found in
    /// the record].
    #[arg(long, value_name = "S")]
    period_s: Option<String>,
    /// Decimal mark of the numbers in a text [default: found from the numbers].
    #[arg(long, value_name = "MARK", value_parser = ["comma", "point"])]
    decimal: Option<String>,
    /// Names of the columns in their order, separated by semicolons, such as `time [s]; ; current
    /// [A]`; an empty one is not used [default: the header of the file].
    #[arg(long, value_name = "NAMES")]
    column_names: Option<String>,
    /// Time between samples, seconds [default: the column of times].
    #[arg(long, value_name = "S")]
    sample_s: Option<String>,
    /// Sheet of a workbook [default: the one that has a table].
    #[arg(long, value_name = "NAME")]
    sheet: Option<String>,
    /// `yes` if the recorded response is inverted (turned by 180°), as Bode 100 loop gains are
    /// [default: no].
    #[arg(long, value_name = "ANSWER", value_parser = ["yes", "no"])]
    inverted: Option<String>,
}

impl Args {
    /// What is given, as a file to read with the others.
    ///
    /// # Errors
    /// [`Failure::Input`] for a value that means nothing, and for a mapping that cannot be read.
    pub(super) fn file(&self) -> Result<Option<(String, Vec<u8>)>, Failure> {
        let (given, _) = self.checked()?;
        Ok(given.text().map(|text| (Given::NAME.to_owned(), text.into_bytes())))
    }

    /// The same as keys and values.
    ///
    /// # Errors
    /// As for [`Args::file`].
    pub(super) fn pairs(&self) -> Result<Vec<(String, String)>, Failure> {
        Ok(self.checked()?.1)
    }

    fn checked(&self) -> Result<(Given, Vec<(String, String)>), Failure> {
        let flags = [
            ("magnitude", &self.magnitude),
            ("input", &self.input),
            ("response", &self.response),
            ("loop", &self.feedback),
            ("amplitude", &self.amplitude),
            ("period_s", &self.period_s),
            ("decimal", &self.decimal),
            ("column_names", &self.column_names),
            ("sample_s", &self.sample_s),
            ("sheet", &self.sheet),
            ("inverted", &self.inverted),
        ];
        let (mut given, mut pairs) = (Given::default(), Vec::new());
        for (key, value) in flags {
            let Some(value) = value else { continue };
            given.set(key, value).map_err(|error| {
                Failure::Input(format!("--{}: {}", key.replace('_', "-"), error.reason))
            })?;
            pairs.push((key.to_owned(), value.clone()));
        }
        let by_flag = |key: &str| flags.iter().any(|(flag, value)| *flag == key && value.is_some());
        if let Some(path) = &self.mapping {
            for (key, value) in mapping(path)?.into_iter().filter(|(key, _)| !by_flag(key)) {
                given.set(&key, &value).map_err(|error| {
                    Failure::Input(format!("{}: {key}: {}", path.display(), error.reason))
                })?;
                pairs.push((key, value));
            }
        }
        Ok((given, pairs))
    }
}

/// The keys and values of a mapping.
fn mapping(path: &Path) -> Result<Vec<(String, String)>, Failure> {
    let wrong = |reason: String| Failure::Input(format!("{}: {reason}", path.display()));
    let text = std::fs::read_to_string(path).map_err(|error| Failure::unread(path, &error))?;
    let table: toml::Table =
        toml::from_str(&text).map_err(|error| wrong(error.to_string().trim().to_owned()))?;
    let entry = |(key, value): (String, toml::Value)| match value {
        toml::Value::String(value) => Ok((key, value)),
        toml::Value::Integer(_) | toml::Value::Float(_) => Ok((key, value.to_string())),
        toml::Value::Boolean(value) => Ok((key, if value { "yes" } else { "no" }.to_owned())),
        _ => Err(wrong(format!("{key} is neither a text nor a number"))),
    };
    table.into_iter().map(entry).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mapping_holds_for_what_no_flag_says() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("rig.toml");
        let text = "sample_s = 0.001\nresponse = \"velocity rad/s\"\ninverted = true\n";
        std::fs::write(&path, text).unwrap();
        let mapping = Some(path.clone());
        let args = Args { mapping, response: Some("position m".into()), ..Args::default() };
        let (_, given) = args.file().unwrap().unwrap();
        let given = String::from_utf8(given).unwrap();
        for line in ["# sample_s: 0.001\n", "# response: position m\n", "# inverted: yes\n"] {
            assert!(given.contains(line), "{given}");
        }
        std::fs::write(&path, "samples_s = 1\n").unwrap();
        let refused = args.file().unwrap_err().to_string();
        assert!(refused.contains("rig.toml") && refused.contains("samples_s"), "{refused}");
    }

    #[test]
    fn a_value_that_means_nothing_is_refused_by_its_flag() {
        let args = Args { period_s: Some("soon".into()), ..Args::default() };
        let failure = args.file().unwrap_err().to_string();
        assert!(failure.contains("--period-s") && failure.contains("`soon`"), "{failure}");
        assert!(Args::default().file().unwrap().is_none());
    }
}
