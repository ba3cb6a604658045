//! Reads one dataset 58 of a universal file, ASCII or binary.
//!
//! The layout is that of the *Universal File Datasets* of the Structural Dynamics Research
//! Laboratory, University of Cincinnati: 11 lines of header, then the ordinates, or pairs of
//! abscissa and ordinate where the spacing is uneven. Files vary: lines end with LF, CRLF, CR or
//! CRCRLF, labels are not ASCII, and the last line of numbers is not filled.

use super::encoding;
use super::fault::Fault;
use super::limits::MAX_ROWS;

/// One function of a universal file.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Dataset {
    /// Function type: 1 is a time record, 4 a frequency response.
    pub(super) function: u32,
    /// Line of the file in which it begins.
    pub(super) line: u64,
    /// Abscissas.
    pub(super) x: Vec<f64>,
    /// Real parts of the ordinates.
    pub(super) re: Vec<f64>,
    /// Imaginary parts, where the ordinates are complex.
    pub(super) im: Option<Vec<f64>>,
    /// What the abscissa is.
    pub(super) abscissa: Axis,
    /// What the ordinate is: of a frequency response, the response.
    pub(super) numerator: Axis,
    /// Of a frequency response, the input.
    pub(super) denominator: Axis,
}

/// What an axis of a function is.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Axis {
    /// Number of the physical quantity, 0 if unknown: 8, 11 and 12 are position, velocity and
    /// acceleration, 9 and 13 forces, 17 is a time, 18 a frequency.
    pub(super) quantity: u32,
    pub(super) label: String,
    pub(super) unit: String,
}

/// Goes through the bytes of a file line by line.
pub(super) struct Lines<'a> {
    rest: &'a [u8],
    /// Number of lines passed.
    pub(super) passed: u64,
}

impl<'a> Lines<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        Self { rest: bytes, passed: 0 }
    }

    pub(super) fn next(&mut self) -> Option<&'a [u8]> {
        if self.rest.is_empty() {
            return None;
        }
        let is_end = |byte: &u8| matches!(byte, b'\n' | b'\r');
        let end = self.rest.iter().position(is_end).unwrap_or(self.rest.len());
        let (line, mut rest) = self.rest.split_at(end);
        while let Some(after) = rest.strip_prefix(b"\r") {
            rest = after;
        }
        self.rest = rest.strip_prefix(b"\n").unwrap_or(rest);
        self.passed += 1;
        Some(line)
    }

    fn take(&mut self, count: usize) -> Option<&'a [u8]> {
        let (taken, rest) = self.rest.split_at_checked(count)?;
        self.rest = rest;
        self.passed += taken.iter().filter(|byte| **byte == b'\n').count() as u64;
        Some(taken)
    }

    fn header(&mut self) -> Result<String, Fault> {
        let line = self.next().ok_or_else(|| self.fault("the file ends in the header"))?;
        Ok(encoding::decode(line).map(|(text, _)| text.into_owned()).unwrap_or_default())
    }

    pub(super) fn fault(&self, reason: impl Into<String>) -> Fault {
        Fault::new(reason).at_line(Some(self.passed.max(1)))
    }
}

/// How the numbers of a binary dataset are stored.
#[derive(Clone, Copy)]
struct Binary {
    little_endian: bool,
    bytes: usize,
}

impl Dataset {
    /// Reads the dataset whose first line is `id`: `58`, or `58b` with what follows.
    pub(super) fn read(lines: &mut Lines<'_>, id: &str) -> Result<Self, Fault> {
        let line = lines.passed;
        let binary = id.starts_with("58b").then(|| binary(id, lines)).transpose()?;
        for _ in 0..5 {
            lines.header()?;
        }
        let function = integers(&lines.header()?, 1, lines)?[0];
        let form = lines.header()?;
        let [kind, count, spacing] = integers(&form, 3, lines)?[..] else {
            return Err(lines.fault("the form of the data is not said"));
        };
        let (wide, complex) = match kind {
            2 => (false, false),
            4 => (true, false),
            5 => (false, true),
            6 => (true, true),
            _ => {
                return Err(
                    lines.fault(format!("the ordinate data type {kind} is none of 2, 4, 5, 6"))
                );
            }
        };
        let even = spacing == 1;
        let [first, step] = match even {
            true => {
                let numbers = numbers(form.as_bytes(), lines)?;
                [3, 4].map(|at| numbers.get(at).copied().unwrap_or(f64::NAN))
            }
            false => [0.0; 2],
        };
        if count as usize > MAX_ROWS {
            return Err(lines.fault(format!("more than {MAX_ROWS} values")));
        }
        let abscissa = axis(&lines.header()?, lines)?;
        let numerator = axis(&lines.header()?, lines)?;
        let denominator = axis(&lines.header()?, lines)?;
        lines.header()?;
        let width = 1 + usize::from(complex) + usize::from(!even);
        let count = count as usize;
        let values = match binary {
            Some(binary) => binary_values(lines, binary, wide, even, width, count)?,
            None => text_values(lines, width * count)?,
        };
        let column = |at: usize| values.iter().skip(at).step_by(width).copied().collect::<Vec<_>>();
        let offset = usize::from(!even);
        Ok(Self {
            function,
            line,
            x: match even {
                true => (0..count).map(|index| first + step * index as f64).collect(),
                false => column(0),
            },
            re: column(offset),
            im: complex.then(|| column(offset + 1)),
            abscissa,
            numerator,
            denominator,
        })
    }
}

/// Reads the first line of a binary dataset: byte order, form of the numbers, lines of the header
/// and bytes behind it.
fn binary(id: &str, lines: &Lines<'_>) -> Result<Binary, Fault> {
    let fields = integers(id.trim_start_matches("58b"), 4, lines)?;
    let [order, form, header, bytes] = fields[..] else {
        return Err(lines.fault("the line of the binary dataset is not whole"));
    };
    if !matches!(order, 1 | 2) || form != 2 || header != 11 {
        return Err(lines.fault(
            "binary data are read with byte order 1 or 2, IEEE numbers (2) and 11 lines of header",
        ));
    }
    Ok(Binary { little_endian: order == 1, bytes: bytes as usize })
}

/// What an axis is. The label and the unit stand at fixed places.
fn axis(line: &str, lines: &Lines<'_>) -> Result<Axis, Fault> {
    let quantity = integers(line, 1, lines)?[0];
    let text = |from: usize| {
        let text: String = line.chars().skip(from).take(20).collect();
        let text = text.trim().to_owned();
        if text.eq_ignore_ascii_case("none") { String::new() } else { text }
    };
    Ok(Axis { quantity, label: text(26), unit: text(47) })
}

/// The first so many integers of a line.
fn integers(line: &str, count: usize, lines: &Lines<'_>) -> Result<Vec<u32>, Fault> {
    let words = line.split_whitespace().take(count);
    let integers: Option<Vec<u32>> = words.map(|word| word.parse().ok()).collect();
    match integers {
        Some(integers) if integers.len() == count => Ok(integers),
        _ => Err(lines.fault(format!("{count} whole numbers are needed in this line"))),
    }
}

/// The numbers of a line; those of fixed width may have no blank between them.
fn numbers(line: &[u8], lines: &Lines<'_>) -> Result<Vec<f64>, Fault> {
    let mut text = String::new();
    let mut last = b' ';
    for byte in line {
        let sign = matches!(byte, b'-' | b'+') && !matches!(last, b'e' | b'E' | b'd' | b'D');
        if sign {
            text.push(' ');
        }
        // Fortran writes the exponent of a double with a D.
        text.push(if matches!(byte, b'd' | b'D') { 'E' } else { char::from(*byte) });
        last = *byte;
    }
    let number = |word: &str| {
        word.parse().map_err(|_| {
            let shown: String = word.chars().take(40).collect();
            lines.fault(format!("`{shown}` is not a number"))
        })
    };
    text.split_whitespace().map(number).collect()
}

/// So many numbers in text, up to the line `-1`.
fn text_values(lines: &mut Lines<'_>, count: usize) -> Result<Vec<f64>, Fault> {
    let mut values = Vec::new();
    while let Some(line) = lines.next() {
        if line.trim_ascii() == b"-1" {
            break;
        }
        values.extend(numbers(line, lines)?);
        if values.len() > count {
            break;
        }
    }
    match values.len() == count {
        true => Ok(values),
        false => Err(lines.fault(format!(
            "the dataset announces {count} numbers and has {}{}",
            values.len(),
            if values.len() > count { " or more" } else { "" }
        ))),
    }
}

/// So many numbers in binary form.
fn binary_values(
    lines: &mut Lines<'_>,
    binary: Binary,
    wide: bool,
    even: bool,
    width: usize,
    count: usize,
) -> Result<Vec<f64>, Fault> {
    let size = if wide { 8 } else { 4 };
    // With doubles at uneven abscissas, these are singles in some files and doubles in others.
    let short = count * (4 + (width - 1) * size);
    let narrow_x = wide && !even && binary.bytes == short;
    if binary.bytes != width * count * size && !narrow_x {
        return Err(lines.fault(format!(
            "{count} values of this form take {} bytes, not {}",
            width * count * size,
            binary.bytes
        )));
    }
    let mut bytes = lines
        .take(binary.bytes)
        .ok_or_else(|| lines.fault("the file ends before the last of the binary data"))?;
    let mut values = Vec::with_capacity(width * count);
    for index in 0..width * count {
        let size = if narrow_x && index % width == 0 { 4 } else { size };
        let Some((number, rest)) = bytes.split_at_checked(size) else { break };
        bytes = rest;
        values.push(number_of(number, binary.little_endian));
    }
    Ok(values)
}

/// A number of 4 or 8 bytes.
fn number_of(bytes: &[u8], little_endian: bool) -> f64 {
    let mut bits = [0; 8];
    for (index, byte) in bytes.iter().enumerate() {
        bits[if little_endian { bytes.len() - 1 - index } else { index }] = *byte;
    }
    match bytes.len() {
        4 => f64::from(f32::from_be_bytes([bits[0], bits[1], bits[2], bits[3]])),
        _ => f64::from_be_bytes(bits),
    }
}
