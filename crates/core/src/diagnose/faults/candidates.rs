//! Faults that a measurement may have, each with the directions in which it would show.
//!
//! A fault changes the data by a linear combination of a few directions: a row that does not belong
//! by anything in that row alone, another gain of one level by the simulated response at that
//! level, another phase by j·k times that response.

use crate::answers::FaultKind;
use crate::measurement::Complex;

use crate::diagnose::residuals::layout::{Cell, Layout};

/// −2 ln of the prior odds of a fault of one kind, as that of an effect.
pub(super) const FAULT_COST: f64 = 6.0;

/// Prior standard deviations: of a gain, relative; of a phase, rad.
const GAIN_DEVIATION: f64 = 0.1;
pub(super) const PHASE_DEVIATION: f64 = 0.1;

/// Fewest experiments of a level that can be told from the others, and fewest rows of one
/// experiment.
const FEWEST_EXPERIMENTS: usize = 3;
const FEWEST_ROWS: usize = 2;

/// Where a fault lies.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Place {
    /// One harmonic of one experiment.
    Row {
        /// Index of the experiment.
        experiment: usize,
        /// Harmonic.
        order: usize,
    },
    /// Everything at one magnitude, input units.
    Level(f64),
    /// One experiment.
    Run(usize),
    /// Everything.
    All,
}

/// A column of a few nonzero entries: row and value.
pub(super) type Column = Vec<(usize, f64)>;

/// One fault that may be there.
pub(super) struct Candidate {
    /// What it is.
    pub kind: FaultKind,
    /// Where it lies.
    pub place: Place,
    /// How the data, in standard deviations, change with each of its parameters.
    pub columns: Vec<Column>,
    /// Prior standard deviation of its parameter; `None` for a row, which may be off by anything.
    pub deviation: Option<f64>,
    /// −2 ln of its prior probability; 0 for a row, of which that depends on how many there are.
    pub price: f64,
    /// Whether its parameter can only be positive.
    pub positive: bool,
}

impl Candidate {
    /// The magnitude at which it lies, if it is that of a level, input units.
    pub fn level(&self) -> Option<f64> {
        match self.place {
            Place::Level(magnitude) => Some(magnitude),
            _ => None,
        }
    }

    /// Index of the experiment in which it lies, if it is that of one.
    pub fn run(&self) -> Option<usize> {
        match self.place {
            Place::Run(experiment) => Some(experiment),
            _ => None,
        }
    }
}

/// Every fault that these residuals could show.
pub(super) fn all(layout: &Layout) -> Vec<Candidate> {
    let cells: Vec<&Cell> = layout.cells.iter().collect();
    let mut candidates: Vec<Candidate> = cells.iter().map(|cell| row(cell)).collect();
    let levels = levels(layout);
    for level in &levels {
        let inside: Vec<&Cell> =
            cells.iter().filter(|cell| cell.input_magnitude == *level).copied().collect();
        let price = FAULT_COST + 2.0 * (levels.len() as f64).ln();
        candidates.push(gain(FaultKind::LevelGain, Place::Level(*level), &inside, price));
        candidates.push(phase(FaultKind::LevelPhase, Place::Level(*level), &inside, price));
    }
    let mut experiments: Vec<usize> = cells.iter().map(|cell| cell.experiment).collect();
    experiments.dedup();
    for experiment in &experiments {
        let inside: Vec<&Cell> =
            cells.iter().filter(|cell| cell.experiment == *experiment).copied().collect();
        if inside.len() < FEWEST_ROWS || experiments.len() < FEWEST_EXPERIMENTS {
            continue;
        }
        let price = FAULT_COST + 2.0 * (experiments.len() as f64).ln();
        candidates.push(gain(FaultKind::RunGain, Place::Run(*experiment), &inside, price));
        candidates.push(phase(FaultKind::RunPhase, Place::Run(*experiment), &inside, price));
    }
    candidates.extend(skew(&cells));
    candidates
}

/// The magnitudes that can be told from each other, if there are several.
pub(super) fn levels(layout: &Layout) -> Vec<f64> {
    let mut experiments: Vec<(usize, f64)> =
        layout.cells.iter().map(|cell| (cell.experiment, cell.input_magnitude)).collect();
    experiments.dedup();
    let mut levels: Vec<f64> = experiments.iter().map(|(_, magnitude)| *magnitude).collect();
    levels.sort_by(f64::total_cmp);
    levels.dedup();
    let count = |level: &f64| experiments.iter().filter(|(_, m)| m == level).count();
    match levels.len() > 1 && levels.iter().all(|level| count(level) >= FEWEST_EXPERIMENTS) {
        true => levels,
        false => Vec::new(),
    }
}

fn row(cell: &Cell) -> Candidate {
    let columns: Vec<Column> = cell.each_row().map(|row| vec![(row, 1.0)]).collect();
    Candidate {
        kind: FaultKind::BadRows,
        place: Place::Row { experiment: cell.experiment, order: cell.order },
        deviation: None,
        columns,
        price: 0.0,
        positive: false,
    }
}

/// Another gain of what these cells hold; the parameter is relative.
pub(super) fn gain(kind: FaultKind, place: Place, cells: &[&Cell], price: f64) -> Candidate {
    let columns = vec![column(cells, |cell| cell.simulated)];
    Candidate { kind, place, columns, deviation: Some(GAIN_DEVIATION), price, positive: false }
}

/// Another phase of what these cells hold; the parameter is that of the fundamental, rad.
pub(super) fn phase(kind: FaultKind, place: Place, cells: &[&Cell], price: f64) -> Candidate {
    let columns = vec![column(cells, |cell| turned(cell, 1.0))];
    Candidate { kind, place, columns, deviation: Some(PHASE_DEVIATION), price, positive: false }
}

/// A response that is ahead of its input; the parameter is the time, in units of the largest
/// angular frequency of a fundamental. A response that is late is that of a machine with a delay.
fn skew(cells: &[&Cell]) -> Option<Candidate> {
    let fastest = cells.iter().map(|cell| cell.frequency_hz).fold(0.0, f64::max);
    (fastest > 0.0).then(|| Candidate {
        kind: FaultKind::ChannelSkew,
        place: Place::All,
        columns: vec![column(cells, |cell| turned(cell, cell.frequency_hz / fastest))],
        deviation: Some(PHASE_DEVIATION),
        price: FAULT_COST,
        positive: true,
    })
}

/// The derivative of a response by the angle of its fundamental: j·k·Ŷ.
fn turned(cell: &Cell, share: f64) -> Complex {
    Complex::new(0.0, cell.order as f64 * share) * cell.simulated
}

/// How the data, in standard deviations, change by this of each cell.
pub(super) fn column(cells: &[&Cell], of: impl Fn(&Cell) -> Complex) -> Column {
    let mut column = Column::new();
    for cell in cells {
        let value = of(cell) / cell.std;
        column.push((cell.rows.0, value.re));
        if let Some(row) = cell.rows.1 {
            column.push((row, value.im));
        }
    }
    column
}
