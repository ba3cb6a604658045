//! Decodes the text of a file.

use std::borrow::Cow;

use encoding_rs::{UTF_16BE, UTF_16LE, WINDOWS_1252};

use super::fault::Fault;

/// Decodes the text of a file, and says how if it is not UTF-8.
///
/// A byte order mark decides for UTF-8 or UTF-16. Without one the text is UTF-8, and where it is
/// not valid as such, Windows-1252 (of which Latin-1 is a part).
///
/// # Errors
/// If the bytes are no text, begin as UTF-8 and do not go on as such, or are not whole UTF-16.
pub(super) fn decode(bytes: &[u8]) -> Result<(Cow<'_, str>, Option<String>), Fault> {
    for (mark, encoding) in [([0xFF, 0xFE], UTF_16LE), ([0xFE, 0xFF], UTF_16BE)] {
        let Some(units) = bytes.strip_prefix(&mark) else { continue };
        return match encoding.decode_without_bom_handling_and_without_replacement(units) {
            Some(text) => Ok((text, Some(format!("the text is {}", encoding.name())))),
            None => Err(Fault::new(format!(
                "the text begins as {} and is not valid as such: save it as UTF-8",
                encoding.name()
            ))),
        };
    }
    let (rest, marked) = match bytes.strip_prefix(b"\xEF\xBB\xBF") {
        Some(rest) => (rest, true),
        None => (bytes, false),
    };
    let error = match std::str::from_utf8(rest) {
        Ok(text) => return Ok((Cow::Borrowed(text), None)),
        Err(error) => error,
    };
    if let Some(line) = bytes.iter().position(|byte| *byte == 0).map(|at| line_at(bytes, at)) {
        return Err(Fault::new(
            "the file is not text, or UTF-16 without a byte order mark: save it as UTF-8",
        )
        .at_line(Some(line)));
    }
    if marked || !rest[..error.valid_up_to()].is_ascii() {
        return Err(Fault::new(
            "the text is UTF-8 up to here and not valid from here on: save it in one encoding",
        )
        .at_line(Some(line_at(rest, error.valid_up_to()))));
    }
    let (text, _) = WINDOWS_1252.decode_without_bom_handling(rest);
    Ok((text, Some("the text is not UTF-8 and is read as Windows-1252".into())))
}

fn line_at(bytes: &[u8], at: usize) -> u64 {
    1 + bytes[..at].iter().filter(|byte| **byte == b'\n').count() as u64
}

#[cfg(test)]
mod tests {
    use super::*;

    fn utf_16(text: &str, bytes_of: fn(u16) -> [u8; 2]) -> Vec<u8> {
        "\u{FEFF}".encode_utf16().chain(text.encode_utf16()).flat_map(bytes_of).collect()
    }

    #[test]
    fn every_encoding_gives_the_same_text_and_says_what_it_was() {
        let text = "Phase (°);Kohärenz\n";
        let windows: Vec<u8> = text.chars().map(|c| c as u8).collect();
        for (bytes, said) in [
            (text.as_bytes().to_vec(), None),
            (format!("\u{FEFF}{text}").into_bytes(), None),
            (utf_16(text, u16::to_le_bytes), Some("UTF-16LE")),
            (utf_16(text, u16::to_be_bytes), Some("UTF-16BE")),
            (windows, Some("Windows-1252")),
        ] {
            let (decoded, note) = decode(&bytes).unwrap();
            assert_eq!(decoded, text);
            assert_eq!(note.is_some(), said.is_some());
            assert!(note.unwrap_or_default().contains(said.unwrap_or_default()));
        }
    }

    #[test]
    fn text_that_changes_its_encoding_is_refused_at_the_line() {
        let fault = decode("# °\n# µ\n".as_bytes()).map(|_| ());
        assert_eq!(fault, Ok(()));
        let mut bytes = "# °\n# ".as_bytes().to_vec();
        bytes.push(0xB5);
        let error = decode(&bytes).unwrap_err().in_file("x");
        assert_eq!(error.line, Some(2));
        assert!(error.reason.contains("UTF-8"), "{error}");
    }

    #[test]
    fn bytes_that_are_no_text_and_halves_of_characters_are_refused() {
        let error = |bytes: &[u8]| decode(bytes).unwrap_err().in_file("x").reason;
        assert!(error(b"a\0\xFF\0").contains("byte order mark"));
        assert!(error(b"\xFF\xFEa").contains("UTF-16LE"));
        assert!(error(b"\xFE\xFF\xD8\x00\x00a").contains("UTF-16BE"));
    }
}
