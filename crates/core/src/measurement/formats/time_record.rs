//! Reads time records: groups the samples by segment.

use super::columns::{self, Column};
use super::fault::Fault;
use super::header::Header;
use super::limits::{MAX_EXPERIMENTS, too_many_experiments};
use super::part::{Part, Remarked};
use super::table::Table;
use crate::measurement::record::{Record, RecordStatement};
use crate::measurement::record_error::RecordError;
use crate::measurement::transient::FEWEST;
use crate::measurement::{Experiment, Lines, Transient};

/// Samples of one segment, and the index of its first row in the table.
struct Segment {
    index: Option<u64>,
    row: usize,
    record: Record,
}

/// Result of reading one segment.
pub(super) enum Read {
    /// A periodic experiment.
    Periods(Remarked<Experiment>),
    /// A motion that does not repeat.
    Motion(Remarked<Transient>),
}

impl Read {
    /// Appends it to the list of its kind.
    pub(super) fn push(
        self,
        experiments: &mut Vec<Remarked<Experiment>>,
        transients: &mut Vec<Remarked<Transient>>,
    ) {
        match self {
            Self::Periods(experiment) => experiments.push(experiment),
            Self::Motion(transient) => transients.push(transient),
        }
    }
}

/// Reads a time record, one experiment or motion per segment.
pub(super) fn read(table: &Table, header: Header, notes: Vec<String>) -> Result<Part, Fault> {
    let mut notes = notes;
    let mut segments = segments(table, &header)?;
    let used: usize = segments.iter().map(|segment| segment.record.time_s.len()).sum();
    if used < table.len() {
        let unused = table.len() - used;
        notes.push(format!(
            "{unused} samples without a segment (blank_segments: unused) are left out"
        ));
    }
    let runs_from_clock = number_runs(&mut segments);
    let (mut experiments, mut transients) = (Vec::new(), Vec::new());
    for segment in &segments {
        read_segment(table, segment, &header)?.push(&mut experiments, &mut transients);
    }
    Ok(Part { header, experiments, transients, notes, lines: Lines::new(), runs_from_clock })
}

/// Reads a table that is a single segment.
pub(super) fn read_one(table: &Table, run: Option<f64>, header: &Header) -> Result<Read, Fault> {
    let mut segments = segments(table, header)?;
    let Some(mut segment) = segments.pop() else {
        return Err(table.fault(None, "the record has no sample"));
    };
    segment.record.run = run;
    read_segment(table, &segment, header)
}

fn read_segment(table: &Table, segment: &Segment, header: &Header) -> Result<Read, Fault> {
    let record = &segment.record;
    let motion = |remark: &str| match record
        .transient(header.intersample.unwrap_or_default(), header.beginning)
    {
        Ok(content) => {
            let taken = match content.rests(&header.metadata) {
                true => "it begins and ends at rest, so that a fit takes it as one whole period",
                false => "a validation takes it, a fit does not",
            };
            let remarks = vec![format!("{remark}; {taken}")];
            Ok(Read::Motion(Remarked { content, remarks }))
        }
        Err(error) => Err(fault(table, segment, error)),
    };
    if header.aperiodic {
        return motion("one motion that does not repeat");
    }
    let moves = record.output.iter().any(|value| *value != record.output[0]);
    let stated = RecordStatement {
        kind: header.metadata.response_kind,
        feedback: header.metadata.feedback,
        intersample: header.intersample,
        period_s: header.period_s,
        settle_periods: header.settle_periods,
    };
    match record.experiment(stated) {
        Ok((mut content, remarks)) => {
            for one in content.bad_samples.iter_mut().flat_map(|bad| &mut bad.samples) {
                one.line = table.row(segment.row + one.first).line();
            }
            Ok(Read::Periods(Remarked { content, remarks }))
        }
        Err(RecordError::NoPeriodFound { .. }) if record.time_s.len() >= FEWEST && moves => motion(
            "no period is found in the input: it is taken as one motion that does not repeat; where \
             it repeats, give period_s",
        ),
        Err(error) => Err(fault(table, segment, error)),
    }
}

fn fault(table: &Table, segment: &Segment, error: RecordError) -> Fault {
    let reason = match segment.index {
        Some(index) => format!("segment {index}: {error}"),
        None => error.to_string(),
    };
    match error {
        RecordError::NotIncreasing { sample, .. } | RecordError::UnequalSampling { sample, .. } => {
            table.row(segment.row + sample).fault(Column::TimeS, reason)
        }
        RecordError::NoPeriodFound { .. }
        | RecordError::NotRepeating { .. }
        | RecordError::OtherPeriod { .. } => table.row(segment.row).fault(Column::Input, reason),
        RecordError::TooShort { .. }
        | RecordError::Undersampled { .. }
        | RecordError::NoWholePeriod { .. } => table.row(segment.row).fault(Column::TimeS, reason),
    }
}

fn segments(table: &Table, header: &Header) -> Result<Vec<Segment>, Fault> {
    for column in columns::TIME_RECORD.iter().filter(|column| **column != Column::Segment) {
        if !table.has(*column) {
            return Err(table.fault(
                Some(*column),
                "the column is missing: a time record needs time_s, input and output",
            ));
        }
    }
    let mut segments: Vec<Segment> = Vec::new();
    let mut ended = std::collections::HashSet::new();
    for row in table.rows() {
        if header.blank_segments_unused
            && table.has(Column::Segment)
            && row.get(Column::Segment).is_none()
        {
            continue;
        }
        let index = row.required_index(Column::Segment)?;
        if segments.last().is_none_or(|segment| segment.index != index) {
            if segments.len() == MAX_EXPERIMENTS {
                let reason = too_many_experiments(segments.len() + 1);
                return Err(row.fault(Column::Segment, reason));
            }
            if !ended.insert(index) {
                return Err(row.fault(
                    Column::Segment,
                    "the segment goes on after another one: its rows must be together",
                ));
            }
            segments.push(Segment { index, row: row.index(), record: Record::default() });
        }
        if let Some(segment) = segments.last_mut() {
            segment.record.time_s.push(row.require(Column::TimeS)?);
            segment.record.input.push(row.require(Column::Input)?);
            let output = row.require(Column::Output)?;
            segment.record.output.push(if header.inverted { -output } else { output });
        }
    }
    Ok(segments)
}

/// Numbers the segments in order of acquisition if one clock runs through all of them, and returns
/// whether it does.
fn number_runs(segments: &mut [Segment]) -> bool {
    let one_clock = segments
        .windows(2)
        .all(|pair| pair[0].record.time_s.last() < pair[1].record.time_s.first());
    if segments.len() < 2 || !one_clock {
        return false;
    }
    for (run, segment) in segments.iter_mut().enumerate() {
        segment.record.run = Some(run as f64);
    }
    true
}
