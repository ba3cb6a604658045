//! TDMS files of National Instruments: the channels of a recording, with the time between samples.

use super::column_table::ColumnTable;
use super::fault::Fault;
use super::format::Format;
use super::given::Given;
use super::header::Header;
use super::lack;
use super::part::Part;
use super::tdms_segment::{Channel, channels};

/// A file that begins with a segment.
pub(super) const FORMAT: Format = Format {
    name: "TDMS",
    is: |content| content.bytes.starts_with(b"TDSm"),
    read: |content, given| read(content.bytes, given),
    see: |content, given| Some(table(content.bytes, Some(1.0)).ok()?.sight("TDMS", given)),
};

fn read(bytes: &[u8], given: &Given) -> Result<Part, Fault> {
    let mut notes = Vec::new();
    let mut header = Header::default();
    header.take(given, &mut notes)?;
    table(bytes, header.sample_s)?.read(header, notes)
}

/// The channels, with the time between samples where that is stated.
fn table(bytes: &[u8], sample_s: Option<f64>) -> Result<ColumnTable, Fault> {
    let channels = channels(bytes)?;
    if channels.is_empty() {
        return Err(Fault::new("the TDMS file has no channel with numbers"));
    }
    let times = channels.iter().map(|channel| times(channel, sample_s));
    Ok(ColumnTable {
        times: times.collect::<Result<_, _>>()?,
        names: channels
            .iter()
            .map(|channel| (channel.name.clone(), channel.unit.clone()))
            .collect(),
        values: channels.iter().map(|channel| channel.values.clone()).collect(),
    })
}

/// The times of a channel's samples, s.
fn times(channel: &Channel, stated: Option<f64>) -> Result<Vec<f64>, Fault> {
    let Some(step) = stated.or(channel.step_s) else {
        let lack = lack::ask("sample_s", "0.001");
        return Err(Fault::new(format!(
            "the channel `{}` of the TDMS file has no `wf_increment`, the time between samples: \
             {lack}",
            channel.name,
        ))
        .lacking(lack));
    };
    Ok((0..channel.values.len()).map(|sample| sample as f64 * step).collect())
}

#[cfg(test)]
pub(super) mod tests;
