use flate2::Compression;
use flate2::read::GzDecoder;
use flate2::write::GzEncoder;
use std::io::{Read as _, Write as _};

use super::*;

fn table(name: &str) -> &'static Table {
    TABLES.iter().find(|table| table.name == name).unwrap()
}

fn point(best: f64) -> Vec<Cell> {
    let text = |text: &str| Cell::Text(text.into());
    let number = Cell::Integer;
    vec![
        text("a"),
        number(1),
        number(i64::MAX),
        text("\"\\\n\u{0}ü"),
        number(-3),
        number(4),
        Cell::Real(best),
        Cell::Null,
        Cell::Real(0.1),
    ]
}

fn file(bytes: &[u8]) -> Vec<Cell> {
    let text = |text: &str| Cell::Text(text.into());
    vec![text("m"), Cell::Integer(0), text("a"), text("b"), Cell::Bytes(bytes.to_vec())]
}

/// A backup with two tables.
fn written() -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut writer = Writer::new(&mut bytes).unwrap();
    writer.begin(table("measurement_files")).unwrap();
    writer.row(&file(b"")).unwrap();
    writer.row(&file(b"[1]\n{\"sha256\":1}\n\x00\xff")).unwrap();
    writer.begin(table("convergence")).unwrap();
    for best in [1e-300, f64::INFINITY, -0.0, 1.0 / 3.0] {
        writer.row(&point(best)).unwrap();
    }
    assert_eq!(writer.finish().unwrap().to_string(), "measurement_files 2, convergence 4");
    bytes
}

fn read(bytes: &[u8]) -> Result<Vec<(&'static str, Vec<Cell>)>, BackupError> {
    let mut reader = Reader::new(bytes)?;
    let mut all = Vec::new();
    while let Some(section) = reader.section()? {
        while let Some(row) = reader.row()? {
            all.push((section.name(), row));
        }
    }
    Ok(all)
}

fn unpacked(bytes: &[u8]) -> Vec<u8> {
    let mut plain = Vec::new();
    GzDecoder::new(bytes).read_to_end(&mut plain).unwrap();
    plain
}

fn packed(plain: &[u8]) -> Vec<u8> {
    let mut packed = GzEncoder::new(Vec::new(), Compression::fast());
    packed.write_all(plain).unwrap();
    packed.finish().unwrap()
}

#[test]
fn what_was_written_is_read_again() {
    let rows = read(&written()).unwrap();
    let expected = [
        ("measurement_files", file(b"")),
        ("measurement_files", file(b"[1]\n{\"sha256\":1}\n\x00\xff")),
        ("convergence", point(1e-300)),
        ("convergence", point(f64::INFINITY)),
        ("convergence", point(-0.0)),
        ("convergence", point(1.0 / 3.0)),
    ];
    // Of a zero the sign counts, too.
    assert_eq!(format!("{rows:?}"), format!("{expected:?}"));
}

#[test]
fn a_backup_that_is_cut_off_anywhere_is_refused() {
    let whole = written();
    for length in 0..whole.len() {
        assert!(read(&whole[..length]).is_err(), "{length} bytes of {}", whole.len());
    }
    let plain = unpacked(&whole);
    for length in 0..plain.len() {
        assert!(read(&packed(&plain[..length])).is_err(), "{length} bytes of {}", plain.len());
    }
}

#[test]
fn a_backup_with_a_wrong_byte_is_refused() {
    let plain = unpacked(&written());
    for at in 0..plain.len() {
        let mut other = plain.clone();
        other[at] ^= 1;
        assert!(read(&packed(&other)).is_err(), "byte {at}");
    }
    let more = [plain, b"{}\n".to_vec()].concat();
    assert!(matches!(read(&packed(&more)), Err(BackupError::Damaged(_))));
}

#[test]
fn another_file_and_a_newer_backup_are_told_apart() {
    let said = |plain: &str| read(&packed(plain.as_bytes())).unwrap_err().to_string();
    assert!(matches!(read(b"time_s,input\n"), Err(BackupError::Foreign)));
    assert!(said("{}\n").contains("not a backup"));
    assert!(said("{\"servoscope_backup\":2}\n{}\n").contains("version 2 of the format"));
    let newer = "{\"servoscope_backup\":1}\n{\"table\":\"jobs\",\"columns\":[\"id\",\"mood\"]}\n";
    assert!(said(newer).contains("a column \"mood\" of jobs"));
    let newer = newer.replace("jobs", "moods");
    assert!(said(&newer).contains("a table moods"));
}
