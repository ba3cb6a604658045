//! The variables of a MATLAB file of level 5 ("MAT-File Format", The MathWorks, chapter 1).
//!
//! A file is a list of elements: a type, a number of bytes, and as many bytes, padded to eight. An
//! array (`miMATRIX`) consists of elements itself; a compressed element unpacks to one. Every length
//! is checked against what is there before it is used.

use std::io::Read;

use flate2::read::ZlibDecoder;

use super::fault::Fault;
use super::limits::{MAX_ROWS, MAX_UNPACKED};

/// Types of elements.
const INT8: u32 = 1;
const UINT8: u32 = 2;
const INT16: u32 = 3;
const UINT16: u32 = 4;
const INT32: u32 = 5;
const UINT32: u32 = 6;
const SINGLE: u32 = 7;
const DOUBLE: u32 = 9;
const INT64: u32 = 12;
const UINT64: u32 = 13;
const MATRIX: u32 = 14;
const COMPRESSED: u32 = 15;

/// Classes of arrays.
const STRUCTURE: u8 = 2;
const NUMERIC: std::ops::RangeInclusive<u8> = 6..=15;

/// The flag of a complex array.
const COMPLEX: u8 = 0x08;

/// Most structures within each other, and most variables of a file.
const DEEPEST: usize = 8;
const MOST_VARIABLES: usize = 10_000;

/// Length of the header of a file.
const HEADER: usize = 128;

/// A numeric array of two dimensions.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Variable {
    /// Its name: of a field of a structure `structure.field`.
    pub(super) name: String,
    pub(super) rows: usize,
    pub(super) columns: usize,
    /// Real parts, one column after the other.
    pub(super) re: Vec<f64>,
    /// Imaginary parts of a complex array.
    pub(super) im: Option<Vec<f64>>,
}

/// The numeric arrays of a file, with those in structures.
///
/// # Errors
/// If the file is cut off, or one of its lengths is wrong.
pub(super) fn variables(file: &[u8]) -> Result<Vec<Variable>, Fault> {
    let big = match file.get(126..HEADER) {
        Some(b"IM") => false,
        Some(b"MI") => true,
        _ => return Err(Fault::new("the header of the MATLAB file is damaged")),
    };
    let mut reader = Reader { found: Vec::new(), unpacked: 0, big };
    let mut rest = &file[HEADER..];
    while !rest.is_empty() {
        let element;
        (element, rest) = reader.element(rest)?;
        reader.top(&element)?;
    }
    Ok(reader.found)
}

/// One element.
struct Element<'a> {
    kind: u32,
    data: &'a [u8],
}

struct Reader {
    found: Vec<Variable>,
    unpacked: u64,
    /// Whether numbers begin with their highest byte.
    big: bool,
}

fn cut_off() -> Fault {
    Fault::new("the MATLAB file is cut off or damaged: save it again")
}

impl Reader {
    fn u32(&self, bytes: &[u8], at: usize) -> Result<u32, Fault> {
        let bytes = bytes.get(at..at + 4).and_then(|bytes| <[u8; 4]>::try_from(bytes).ok());
        let bytes = bytes.ok_or_else(cut_off)?;
        Ok(if self.big { u32::from_be_bytes(bytes) } else { u32::from_le_bytes(bytes) })
    }

    /// The first element, and what follows it.
    fn element<'a>(&self, bytes: &'a [u8]) -> Result<(Element<'a>, &'a [u8]), Fault> {
        let tag = self.u32(bytes, 0)?;
        // Up to four bytes stand in the tag itself.
        if tag >> 16 != 0 {
            let length = (tag >> 16) as usize;
            let data = bytes.get(4..8).and_then(|data| data.get(..length)).ok_or_else(cut_off)?;
            return Ok((Element { kind: tag & 0xffff, data }, &bytes[8..]));
        }
        let length = self.u32(bytes, 4)? as usize;
        let rest = &bytes[8..];
        let data = rest.get(..length).ok_or_else(cut_off)?;
        let padded = if tag == COMPRESSED { length } else { length.next_multiple_of(8) };
        Ok((Element { kind: tag, data }, rest.get(padded..).unwrap_or_default()))
    }

    fn top(&mut self, element: &Element<'_>) -> Result<(), Fault> {
        match element.kind {
            COMPRESSED => {
                let left = MAX_UNPACKED - self.unpacked;
                let mut bytes = Vec::new();
                let unpacking = ZlibDecoder::new(element.data).take(left + 1);
                { unpacking }.read_to_end(&mut bytes).map_err(|_| cut_off())?;
                self.unpacked += bytes.len() as u64;
                if self.unpacked > MAX_UNPACKED {
                    return Err(Fault::new(format!(
                        "the variables are larger than {MAX_UNPACKED} bytes once unpacked: save \
                         fewer of them"
                    )));
                }
                let (inner, _) = self.element(&bytes)?;
                if inner.kind == MATRIX { self.array(inner.data, "", 0) } else { Ok(()) }
            }
            MATRIX => self.array(element.data, "", 0),
            _ => Ok(()),
        }
    }

    /// Keeps an array if it is numeric, or the arrays in it if it is a structure.
    fn array(&mut self, bytes: &[u8], path: &str, depth: usize) -> Result<(), Fault> {
        if bytes.is_empty() || depth > DEEPEST || self.found.len() >= MOST_VARIABLES {
            return Ok(());
        }
        let (flags, rest) = self.element(bytes)?;
        let flags = self.u32(flags.data, 0)?;
        let (class, is_complex) = ((flags & 0xff) as u8, (flags >> 8) as u8 & COMPLEX != 0);
        let (dimensions, rest) = self.element(rest)?;
        let dimensions: Vec<usize> = (0..dimensions.data.len() / 4)
            .map(|i| Ok(self.u32(dimensions.data, 4 * i)? as usize))
            .collect::<Result<_, Fault>>()?;
        let (name, rest) = self.element(rest)?;
        let own = String::from_utf8_lossy(name.data);
        let name = match (path, &*own) {
            ("", own) => own.to_owned(),
            (path, "") => path.to_owned(),
            (path, own) => format!("{path}.{own}"),
        };
        match (class, &dimensions[..]) {
            (STRUCTURE, [1, 1]) => self.fields(rest, &name, depth),
            (class, &[rows, columns]) if NUMERIC.contains(&class) => {
                let count = rows.checked_mul(columns).filter(|count| *count <= 16 * MAX_ROWS);
                let count = count.ok_or_else(|| {
                    Fault::new(format!("`{name}` has {rows} × {columns} values: save less of it"))
                })?;
                let (re, rest) = self.element(rest)?;
                let re = self.numbers(&re, count)?;
                let im = is_complex.then(|| self.element(rest)).transpose()?;
                let im = im.map(|(im, _)| self.numbers(&im, count)).transpose()?;
                self.found.push(Variable { name, rows, columns, re, im });
                Ok(())
            }
            // Texts, cells, objects, and arrays of more dimensions hold no channel.
            _ => Ok(()),
        }
    }

    fn fields(&mut self, bytes: &[u8], name: &str, depth: usize) -> Result<(), Fault> {
        let (length, rest) = self.element(bytes)?;
        let length = self.u32(length.data, 0)? as usize;
        let (names, mut rest) = self.element(rest)?;
        for field in names.data.chunks_exact(length.max(1)) {
            let end = field.iter().position(|byte| *byte == 0).unwrap_or(field.len());
            let field = String::from_utf8_lossy(&field[..end]);
            let element;
            (element, rest) = self.element(rest)?;
            if element.kind == MATRIX {
                self.array(element.data, &format!("{name}.{field}"), depth + 1)?;
            }
        }
        Ok(())
    }

    /// The numbers of an element. They may be stored in a smaller type than that of their array.
    fn numbers(&self, element: &Element<'_>, count: usize) -> Result<Vec<f64>, Fault> {
        let width = match element.kind {
            INT8 | UINT8 => 1,
            INT16 | UINT16 => 2,
            INT32 | UINT32 | SINGLE => 4,
            DOUBLE | INT64 | UINT64 => 8,
            _ => return Err(cut_off()),
        };
        if element.data.len() / width < count {
            return Err(cut_off());
        }
        let number = |bytes: &[u8]| {
            let mut little = [0; 8];
            little[..width].copy_from_slice(bytes);
            if self.big {
                little[..width].reverse();
            }
            let [a, b, c, d, ..] = little;
            match element.kind {
                INT8 => f64::from(a as i8),
                UINT8 => f64::from(a),
                INT16 => f64::from(i16::from_le_bytes([a, b])),
                UINT16 => f64::from(u16::from_le_bytes([a, b])),
                INT32 => f64::from(i32::from_le_bytes([a, b, c, d])),
                UINT32 => f64::from(u32::from_le_bytes([a, b, c, d])),
                SINGLE => f64::from(f32::from_le_bytes([a, b, c, d])),
                INT64 => i64::from_le_bytes(little) as f64,
                UINT64 => u64::from_le_bytes(little) as f64,
                _ => f64::from_le_bytes(little),
            }
        };
        Ok(element.data.chunks_exact(width).take(count).map(number).collect())
    }
}
