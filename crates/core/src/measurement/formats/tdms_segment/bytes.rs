//! Numbers, texts and properties from the bytes of a segment, in either byte order.

use crate::measurement::formats::fault::Fault;

pub(super) const STRING: u32 = 0x20;
const TIMESTAMP: u32 = 0x44;

pub(super) fn cut_off() -> Fault {
    Fault::new("the TDMS file is cut off or damaged: save it again")
}

/// Bytes of a number of this type; `None` for anything else.
pub(super) fn width(kind: u32) -> Option<usize> {
    match kind {
        1 | 5 | 0x21 => Some(1),
        2 | 6 => Some(2),
        3 | 7 | 9 | 0x19 => Some(4),
        4 | 8 | 10 | 0x1a => Some(8),
        _ => None,
    }
}

/// The value of a property.
pub(super) enum Property {
    Number(f64),
    Text(String),
    Other,
}

/// Bytes from which numbers and texts are taken.
pub(super) struct Bytes<'a> {
    pub(super) rest: &'a [u8],
    pub(super) big: bool,
}

impl<'a> Bytes<'a> {
    fn take(&mut self, length: usize) -> Result<&'a [u8], Fault> {
        let (taken, rest) = self.rest.split_at_checked(length).ok_or_else(cut_off)?;
        self.rest = rest;
        Ok(taken)
    }

    /// The next bytes, lowest first, and zeros behind them.
    fn little(&mut self, width: usize) -> Result<[u8; 8], Fault> {
        let mut little = [0; 8];
        little[..width].copy_from_slice(self.take(width)?);
        if self.big {
            little[..width].reverse();
        }
        Ok(little)
    }

    pub(super) fn u32(&mut self) -> Result<u32, Fault> {
        Ok(u64::from_le_bytes(self.little(4)?) as u32)
    }

    pub(super) fn u64(&mut self) -> Result<u64, Fault> {
        Ok(u64::from_le_bytes(self.little(8)?))
    }

    pub(super) fn string(&mut self) -> Result<String, Fault> {
        let length = self.u32()? as usize;
        Ok(String::from_utf8_lossy(self.take(length)?).into_owned())
    }

    pub(super) fn property(&mut self) -> Result<Property, Fault> {
        match self.u32()? {
            STRING => Ok(Property::Text(self.string()?)),
            TIMESTAMP => self.take(16).map(|_| Property::Other),
            kind if width(kind).is_some() => self.number(kind).map(Property::Number),
            _ => Err(cut_off()),
        }
    }

    pub(super) fn number(&mut self, kind: u32) -> Result<f64, Fault> {
        let little = self.little(width(kind).ok_or_else(cut_off)?)?;
        let [a, b, c, d, ..] = little;
        Ok(match kind {
            1 => f64::from(a as i8),
            2 => f64::from(i16::from_le_bytes([a, b])),
            3 => f64::from(i32::from_le_bytes([a, b, c, d])),
            4 => i64::from_le_bytes(little) as f64,
            9 | 0x19 => f64::from(f32::from_le_bytes([a, b, c, d])),
            10 | 0x1a => f64::from_le_bytes(little),
            // The others are not negative, and have zeros behind them.
            _ => u64::from_le_bytes(little) as f64,
        })
    }
}
