//! The channels of a TDMS file ("TDMS File Format Internal Structure", National Instruments).
//!
//! A file is a list of segments. Each begins with a lead-in of 28 bytes, then says which objects it
//! has (the file, groups and channels, with properties), and then gives the values of the channels in
//! chunks, one channel after the other or interleaved. What a segment does not say of its channels is
//! as in the segment before. Every length is checked against what is there before it is used.

mod bytes;

use std::collections::HashMap;

use super::fault::Fault;
use super::limits::{MAX_CELLS_IN_ROW, MAX_ROWS};
use bytes::{Bytes, Property, STRING, cut_off, width};

/// Bits of the table of contents.
const HAS_META_DATA: u32 = 1 << 1;
const NEW_OBJECTS: u32 = 1 << 2;
const HAS_RAW_DATA: u32 = 1 << 3;
const INTERLEAVED: u32 = 1 << 5;
const BIG_ENDIAN: u32 = 1 << 6;
const DAQMX: u32 = 1 << 7;

/// Lengths of a raw data index that mean something else.
const NO_RAW_DATA: u32 = 0xffff_ffff;
const AS_BEFORE: u32 = 0;
/// Digits of a card before its scaling.
const UNSCALED: [u32; 2] = [0x1269, 0x1369];

const LEAD_IN: usize = 28;

/// A channel with what its properties say.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Channel {
    /// Its name, without that of its group.
    pub(super) name: String,
    /// Its unit; empty if it has none.
    pub(super) unit: String,
    /// Time between two samples, s.
    pub(super) step_s: Option<f64>,
    /// Its values.
    pub(super) values: Vec<f64>,
    kind: u32,
    /// Values in a chunk of the segment.
    count: usize,
}

/// The channels of a file that have numbers, in the order in which the file names them.
///
/// # Errors
/// If the file is cut off or damaged, or holds the digits of a card before its scaling.
pub(super) fn channels(file: &[u8]) -> Result<Vec<Channel>, Fault> {
    let mut reader = Reader::default();
    let mut rest = file;
    while !rest.is_empty() {
        rest = reader.segment(rest)?;
    }
    Ok(reader.channels.into_iter().filter(|channel| !channel.values.is_empty()).collect())
}

#[derive(Default)]
struct Reader {
    channels: Vec<Channel>,
    by_path: HashMap<String, usize>,
    /// Channels with values in the segment, in their order.
    active: Vec<usize>,
    samples: usize,
}

impl Reader {
    /// Reads a segment; returns what follows it.
    fn segment<'a>(&mut self, bytes: &'a [u8]) -> Result<&'a [u8], Fault> {
        if bytes.len() < LEAD_IN || &bytes[..4] != b"TDSm" {
            return Err(cut_off());
        }
        let mut lead_in = Bytes { rest: &bytes[4..LEAD_IN], big: false };
        let contents = lead_in.u32()?;
        lead_in.u32()?;
        let body = &bytes[LEAD_IN..];
        // A segment that was being written when the power failed has no length.
        let length = lead_in.u64()?;
        let length = if length == u64::MAX { body.len() } else { size(length)? };
        let raw = size(lead_in.u64()?)?;
        let segment = body.get(..length).ok_or_else(cut_off)?;
        let data = segment.get(raw..).ok_or_else(cut_off)?;
        if contents & DAQMX != 0 {
            return Err(unscaled());
        }
        let big = contents & BIG_ENDIAN != 0;
        if contents & NEW_OBJECTS != 0 {
            self.active.clear();
        }
        if contents & HAS_META_DATA != 0 {
            self.objects(Bytes { rest: &segment[..raw], big })?;
        }
        if contents & HAS_RAW_DATA != 0 {
            self.values(Bytes { rest: data, big }, contents & INTERLEAVED != 0)?;
        }
        Ok(&body[length..])
    }

    fn objects(&mut self, mut bytes: Bytes<'_>) -> Result<(), Fault> {
        for _ in 0..bytes.u32()? {
            let path = bytes.string()?;
            let index = bytes.u32()?;
            let channel = self.channel(&path)?;
            match index {
                NO_RAW_DATA => {}
                AS_BEFORE => self.activate(channel.ok_or_else(cut_off)?),
                index if UNSCALED.contains(&index) => return Err(unscaled()),
                _ => {
                    let channel = channel.ok_or_else(cut_off)?;
                    let (kind, dimension, count) = (bytes.u32()?, bytes.u32()?, bytes.u64()?);
                    if kind == STRING {
                        bytes.u64()?;
                    }
                    if dimension != 1 {
                        return Err(cut_off());
                    }
                    self.channels[channel].kind = kind;
                    self.channels[channel].count = size(count)?;
                    self.activate(channel);
                }
            }
            for _ in 0..bytes.u32()? {
                let name = bytes.string()?;
                let value = bytes.property()?;
                let Some(channel) = channel.map(|channel| &mut self.channels[channel]) else {
                    continue;
                };
                match (name.as_str(), value) {
                    ("unit_string" | "NI_UnitDescription", Property::Text(unit)) => {
                        channel.unit = unit;
                    }
                    ("wf_increment", Property::Number(step)) if step > 0.0 => {
                        channel.step_s = Some(step);
                    }
                    _ => {}
                }
            }
        }
        Ok(())
    }

    /// The channel of a path `/'group'/'channel'`; `None` of any other object.
    fn channel(&mut self, path: &str) -> Result<Option<usize>, Fault> {
        if let Some(known) = self.by_path.get(path) {
            return Ok(Some(*known));
        }
        let Some((_, name)) = path.strip_prefix("/'").and_then(|path| path.split_once("'/'"))
        else {
            return Ok(None);
        };
        if self.channels.len() == MAX_CELLS_IN_ROW {
            let reason = format!("the TDMS file has more than {MAX_CELLS_IN_ROW} channels");
            return Err(Fault::new(reason));
        }
        let name = name.trim_end_matches('\'').replace("''", "'");
        self.channels.push(Channel { name, ..Channel::default() });
        self.by_path.insert(path.to_owned(), self.channels.len() - 1);
        Ok(Some(self.channels.len() - 1))
    }

    fn activate(&mut self, channel: usize) {
        if !self.active.contains(&channel) {
            self.active.push(channel);
        }
    }

    /// The values of the active channels, in as many chunks as there are.
    fn values(&mut self, mut bytes: Bytes<'_>, interleaved: bool) -> Result<(), Fault> {
        let active = self.active.clone();
        let mut chunk = 0_usize;
        for channel in &active {
            let Channel { kind, count, .. } = self.channels[*channel];
            let width = width(kind).ok_or_else(|| no_number(&self.channels[*channel].name))?;
            chunk = chunk.saturating_add(width.saturating_mul(count));
        }
        if chunk == 0 {
            return Ok(());
        }
        // The last chunk may be cut off where the power failed.
        for _ in 0..bytes.rest.len() / chunk {
            if interleaved {
                let most = active.iter().map(|channel| self.channels[*channel].count).max();
                for _ in 0..most.unwrap_or(0) {
                    for channel in &active {
                        self.value(*channel, &mut bytes)?;
                    }
                }
            } else {
                for channel in &active {
                    for _ in 0..self.channels[*channel].count {
                        self.value(*channel, &mut bytes)?;
                    }
                }
            }
        }
        Ok(())
    }

    fn value(&mut self, channel: usize, bytes: &mut Bytes<'_>) -> Result<(), Fault> {
        self.samples += 1;
        if self.samples > 16 * MAX_ROWS {
            return Err(Fault::new("the TDMS file has too many samples: save less of it"));
        }
        let channel = &mut self.channels[channel];
        channel.values.push(bytes.number(channel.kind)?);
        Ok(())
    }
}

fn unscaled() -> Fault {
    Fault::new(
        "the TDMS file has the digits of a card before its scaling: save it scaled, or as text",
    )
}

fn no_number(channel: &str) -> Fault {
    Fault::new(format!(
        "the channel `{channel}` of the TDMS file has no real numbers: save the channels alone \
         that are needed"
    ))
}

fn size(length: u64) -> Result<usize, Fault> {
    usize::try_from(length).map_err(|_| cut_off())
}
