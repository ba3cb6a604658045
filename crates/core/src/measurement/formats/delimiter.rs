//! What separates the columns of a text.

use super::limits::MAX_LINE;

/// What separates the columns of a text.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Delimiter {
    Comma,
    Semicolon,
    Tab,
    /// One or more spaces.
    Blanks,
}

impl Delimiter {
    /// All of them, the more telling ones first.
    pub(super) const ALL: [Self; 4] = [Self::Tab, Self::Semicolon, Self::Comma, Self::Blanks];

    /// The delimiter that a line `sep=;` states. Spreadsheets write it as the first line.
    pub(super) fn stated(line: &str) -> Option<Self> {
        let line = line.trim_end_matches(['\r', '\n']).trim_matches('"');
        let mark = line.strip_prefix("sep=").or_else(|| line.strip_prefix("SEP="))?;
        Self::ALL.into_iter().find(|delimiter| mark.bytes().eq([delimiter.byte()]))
    }

    pub(super) fn byte(self) -> u8 {
        match self {
            Self::Comma => b',',
            Self::Semicolon => b';',
            Self::Tab => b'\t',
            Self::Blanks => b' ',
        }
    }

    /// Its name in the plural, for messages.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Comma => "commas",
            Self::Semicolon => "semicolons",
            Self::Tab => "tabs",
            Self::Blanks => "blanks",
        }
    }

    /// The cells of one line without the blanks and quotes around them; none of a line that is longer
    /// than any table has.
    pub(super) fn cells(self, line: &str) -> Vec<String> {
        if line.len() > MAX_LINE {
            return Vec::new();
        }
        let row = line.trim_end_matches(['\r', '\n']);
        if row.is_empty() || row.starts_with('#') {
            return Vec::new();
        }
        // Without quotes a row is what stands between the delimiters. To set up a CSV reader for it
        // takes longer than to read it.
        if row.contains(['"', '\r', '\n']) {
            return self.quoted_cells(row);
        }
        self.kept(row.split(char::from(self.byte())).map(str::trim)).map(str::to_owned).collect()
    }

    fn quoted_cells(self, row: &str) -> Vec<String> {
        let mut record = csv::StringRecord::new();
        // A line that is not CSV has no cells; the reader of the whole text says why.
        let _ = self.reader(row.as_bytes()).read_record(&mut record);
        self.kept(record.iter()).map(unquoted).collect()
    }

    /// Without the empty cells between two blanks, where blanks delimit.
    fn kept<'a>(self, cells: impl Iterator<Item = &'a str>) -> impl Iterator<Item = &'a str> {
        cells.filter(move |cell| self != Self::Blanks || !cell.is_empty())
    }

    /// A reader of rows of any length. Lines that begin with `#` are comments.
    pub(super) fn reader(self, text: &[u8]) -> csv::Reader<&[u8]> {
        csv::ReaderBuilder::new()
            .has_headers(false)
            .flexible(true)
            .trim(csv::Trim::All)
            .comment(Some(b'#'))
            .delimiter(self.byte())
            .from_reader(text)
    }
}

fn unquoted(cell: &str) -> String {
    unquote(cell).to_owned()
}

/// Removes quotes around a cell. The CSV reader keeps those that follow a space as part of the
/// cell.
pub(super) fn unquote(cell: &str) -> &str {
    let inner = cell.strip_prefix('"').and_then(|cell| cell.strip_suffix('"'));
    inner.unwrap_or(cell).trim()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_spreadsheet_may_state_its_delimiter() {
        assert_eq!(Delimiter::stated("sep=;\r\n"), Some(Delimiter::Semicolon));
        assert_eq!(Delimiter::stated("\"sep=\t\""), Some(Delimiter::Tab));
        assert_eq!(Delimiter::stated("sep=,"), Some(Delimiter::Comma));
        assert_eq!(Delimiter::stated("sep=||"), None);
        assert_eq!(Delimiter::stated("separator"), None);
    }

    #[test]
    fn a_line_without_an_end_is_not_taken_apart() {
        assert_eq!(Delimiter::Comma.cells(&"0,".repeat(MAX_LINE / 2)).len(), MAX_LINE / 2 + 1);
        assert!(Delimiter::Comma.cells(&"0,".repeat(MAX_LINE / 2 + 1)).is_empty());
    }

    #[test]
    fn a_line_without_quotes_has_the_cells_that_a_csv_reader_finds() {
        for delimiter in Delimiter::ALL {
            for line in ["1,2;3\t4 5", " 1 , 2 ;\t3 \r\n", ",;\t ", " # 1", "1\r2,3"] {
                let row = line.trim_end_matches(['\r', '\n']);
                assert_eq!(
                    delimiter.cells(line),
                    delimiter.quoted_cells(row),
                    "{delimiter:?} {line:?}"
                );
            }
            for line in ["", "\r\n", "# 1,2", "# \"1\""] {
                assert!(delimiter.cells(line).is_empty(), "{line:?}");
            }
        }
    }

    #[test]
    fn cells_lose_the_quotes_and_blanks_around_them() {
        let cells = |delimiter: Delimiter, line| delimiter.cells(line).join("|");
        assert_eq!(cells(Delimiter::Semicolon, "a ;\"b;c\"; \"d\"\r\n"), "a|b;c|d");
        assert_eq!(cells(Delimiter::Blanks, "  1   2 3\r\n"), "1|2|3");
        assert_eq!(cells(Delimiter::Tab, "1\t\t3\n"), "1||3");
    }
}
