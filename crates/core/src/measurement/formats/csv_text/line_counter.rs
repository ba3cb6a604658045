//! Line numbers of the records of a CSV text.

/// Finds the line number of a record from its byte offset.
///
/// The CSV reader's own line number is that of the first blank line or comment before the record,
/// and it falls behind in files with CRLF.
pub(super) struct LineCounter<'a> {
    pub(super) bytes: &'a [u8],
    pub(super) at: usize,
    pub(super) line: u64,
}

impl LineCounter<'_> {
    /// The line of the record that the reader began to search for at byte `start`.
    pub(super) fn line_of_record(&mut self, start: usize) -> u64 {
        self.advance_to(start);
        while let Some(byte) = self.bytes.get(self.at) {
            match byte {
                b'\n' | b'\r' => self.advance_to(self.at + 1),
                b'#' => {
                    let rest = &self.bytes[self.at..];
                    let end = rest.iter().position(|byte| *byte == b'\n');
                    self.advance_to(self.at + end.unwrap_or(rest.len()));
                }
                _ => break,
            }
        }
        self.line
    }

    fn advance_to(&mut self, target: usize) {
        let target = target.min(self.bytes.len());
        let passed = &self.bytes[self.at.min(target)..target];
        self.line += passed.iter().filter(|byte| **byte == b'\n').count() as u64;
        self.at = self.at.max(target);
    }
}
