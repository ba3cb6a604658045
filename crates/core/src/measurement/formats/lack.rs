//! What a file lacks, and how to give it.

use std::fmt;

/// What a file lacks and an upload can give. As text, it says how.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Lack {
    /// Key of the metadata.
    pub key: &'static str,
    /// A value that it may have.
    pub example: String,
}

impl fmt::Display for Lack {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { key, example } = self;
        let quote = if example.contains([' ', ';', '(']) { "\"" } else { "" };
        write!(
            out,
            "give {key} as a line `# {key}: {example}` above the header, as --{} \
             {quote}{example}{quote} on the command line, or as the query parameter or form field \
             {key}",
            key.replace('_', "-")
        )
    }
}

/// Asks for what a file lacks.
pub(super) fn ask(key: &'static str, example: impl Into<String>) -> Lack {
    Lack { key, example: example.into() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_question_names_the_line_the_flag_and_the_parameter() {
        let question = ask("period_s", "0.5").to_string();
        for part in ["`# period_s: 0.5`", "--period-s 0.5", "form field period_s"] {
            assert!(question.contains(part), "{question}");
        }
        let quoted = ask("response", "velocity rad/s").to_string();
        assert!(quoted.contains("--response \"velocity rad/s\""), "{quoted}");
    }
}
