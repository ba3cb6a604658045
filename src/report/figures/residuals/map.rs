//! Stepped sines: a map of harmonic over frequency, one block a magnitude.

mod outlines;

use std::collections::BTreeSet;

use servoscope_core::answers::{ComparedExperiment, ComparedHarmonic, Comparison, Pattern};

use super::super::canvas::{AXIS, Anchor, Canvas, HEADING, NOTE, TICK, Trace, WIDTH};
use super::super::panel::{Key, Look, legend};
use super::super::scale::Scale;
use super::super::series::{Group, by_magnitude, frequency_hz, magnitude_label, sigmas};
use super::super::text::{self, number};
use super::super::theme::SIGMA_CLASSES;
use outlines::mark;

const LEFT: f64 = 128.0;
const RIGHT: f64 = WIDTH - 24.0;
const BLOCK_GAP: f64 = 9.0;

/// The axis of frequencies, as the other figures of a page call it: they move together.
const FREQUENCY: &str = "Frequency (Hz)";

/// Height that all rows together are meant to have.
const WANTED_HEIGHT: f64 = 420.0;

/// Height of a row from which its number has room beside it.
const LABELLED_ROW: f64 = 12.5;

struct Cell {
    sides: [f64; 4],
    row: usize,
    column: usize,
    magnitude: f64,
    frequency_hz: f64,
    order: usize,
    run: Option<f64>,
    sigmas: Option<f64>,
    /// What a pointer on it shows.
    hint: String,
}

/// The cells of a magnitude.
struct Block {
    sides: [f64; 4],
    cells: Vec<Cell>,
}

pub(super) fn draw(canvas: &mut Canvas, comparison: &Comparison, patterns: &[Pattern]) {
    let groups = by_magnitude(comparison);
    if !patterns.is_empty() {
        let outlined = Key::new(Look::Line("ink"), "key", "patterns, by their numbers below");
        legend(canvas, &[outlined.toggling("patterns")]);
    }
    colours(canvas);
    let orders: Vec<Vec<usize>> = groups.iter().map(orders).collect();
    let rows: usize = orders.iter().map(Vec::len).sum();
    let height = (WANTED_HEIGHT / rows.max(1) as f64).clamp(5.0, 24.0);
    let x = frequencies(&groups);
    canvas.text(LEFT - 8.0, canvas.y + 10.0, AXIS, Anchor::End, "Harmonic k");
    let mut y = canvas.y + 18.0;
    let mut blocks: Vec<Block> = Vec::new();
    // The largest magnitude on top, as in a diagram over magnitude.
    for (group, orders) in groups.iter().zip(&orders).rev() {
        let bottom = y + height * orders.len() as f64;
        let sides = [LEFT, y, RIGHT, bottom];
        let is_lowest = blocks.len() + 1 == groups.len();
        axes(canvas, &x, sides, is_lowest);
        let magnitude = magnitude_label(group.magnitude, comparison);
        let cells = cells(group, orders, &x, y, height, comparison);
        for (row, order) in orders.iter().enumerate() {
            let name = format!("k = {order}");
            let trace = Trace { series: &magnitude, name: &name, hints: true, ..Trace::default() };
            canvas.open_inside("cells", sides, trace);
            cells.iter().filter(|cell| cell.row == row).for_each(|cell| tile(canvas, cell));
            canvas.close();
        }
        let label = text::shorten(&magnitude, 12.5, 68.0);
        let middle = if bottom - y > 16.0 { y + 12.0 } else { 0.5 * (y + bottom) + 4.0 };
        canvas.text(24.0, middle, HEADING, Anchor::Start, &label);
        let every = (LABELLED_ROW / height).ceil() as usize;
        for (row, order) in orders.iter().enumerate().step_by(every.max(1)) {
            let middle = y + height * (row as f64 + 0.5) + 4.0;
            canvas.text(LEFT - 8.0, middle, TICK, Anchor::End, &order.to_string());
        }
        y = bottom + BLOCK_GAP;
        blocks.push(Block { sides, cells });
    }
    let bottom = y - BLOCK_GAP;
    let middle = 0.5 * (LEFT + RIGHT);
    canvas.text(middle, bottom + 34.0, AXIS, Anchor::Middle, "Frequency of the input (Hz)");
    mark(canvas, &blocks, patterns);
    canvas.y = bottom + 50.0;
}

/// What a reader's zoom moves: the frequencies, not the rows. The numbers of the frequencies stand
/// below the lowest block.
fn axes(canvas: &mut Canvas, x: &Scale, sides: [f64; 4], is_lowest: bool) {
    let [_, top, _, bottom] = sides;
    let rows = format!("rows 0 1 {bottom:.1} {top:.1}");
    canvas.open_grid(sides, [(x.described(), FREQUENCY), (rows, "Harmonic k")], [is_lowest, false]);
    if is_lowest {
        for tick in x.horizontal_ticks(TICK.size) {
            canvas.line("frame", [tick.px, bottom], [tick.px, bottom + 4.0]);
            canvas.text(tick.px, bottom + 17.0, TICK, Anchor::Middle, &tick.label);
        }
    }
    canvas.close();
}

fn tile(canvas: &mut Canvas, cell: &Cell) {
    let Some(size) = cell.sigmas else { return };
    let [left, top, right, bottom] = cell.sides;
    // A hairline of background keeps neighbours apart.
    let tile = [left + 0.5, top + 0.5, right - 0.5, bottom - 0.5];
    canvas.rectangle(&class(size), tile, &cell.hint);
}

fn orders(group: &Group<'_>) -> Vec<usize> {
    let orders = group.experiments.iter().flat_map(|e| &e.harmonics).map(|h| h.order);
    orders.collect::<BTreeSet<usize>>().into_iter().collect()
}

fn frequencies(groups: &[Group<'_>]) -> Scale {
    let every = groups.iter().flat_map(|group| bounds(group).into_iter().flatten());
    let (low, high) = every.fold((f64::INFINITY, 0.0_f64), |(low, high), frequency| {
        (low.min(frequency), high.max(frequency))
    });
    Scale::log([low, high], [LEFT, RIGHT])
}

/// Where the column of each experiment begins and ends, hertz: half-way to its
/// neighbours on a logarithmic axis.
fn bounds(group: &Group<'_>) -> Vec<[f64; 2]> {
    let at: Vec<f64> = group.experiments.iter().map(|e| frequency_hz(e, 1)).collect();
    let mut distinct = at.clone();
    distinct.dedup_by(|a, b| (*a / *b - 1.0).abs() < 1e-9);
    let bounds: Vec<[f64; 2]> = (0..distinct.len())
        .map(|i| {
            let here = distinct[i];
            let before = (i > 0).then(|| (here / distinct[i - 1]).sqrt());
            let after = distinct.get(i + 1).map(|next| (next / here).sqrt());
            // At the ends as wide as towards the one neighbour; alone, an octave.
            let [before, after] = match (before, after) {
                (None, None) => [f64::sqrt(2.0); 2],
                (before, after) => [before.or(after), after.or(before)].map(|w| w.unwrap_or(1.0)),
            };
            [here / before, here * after]
        })
        .collect();
    // Experiments of the same frequency (repeated at another time) share a column.
    at.iter()
        .flat_map(|frequency| {
            let index = distinct.iter().position(|d| (d / frequency - 1.0).abs() < 1e-9)?;
            let sharing = at.iter().filter(|f| (*f / frequency - 1.0).abs() < 1e-9).count();
            Some((index, sharing))
        })
        .scan((usize::MAX, 0_usize), |(last, nth), (index, sharing)| {
            *nth = if *last == index { *nth + 1 } else { 0 };
            *last = index;
            let [from, to] = bounds[index];
            let part = (to / from).powf(1.0 / sharing as f64);
            Some([from * part.powi(*nth as i32), from * part.powi(*nth as i32 + 1)])
        })
        .collect()
}

fn cells(
    group: &Group<'_>,
    orders: &[usize],
    x: &Scale,
    top: f64,
    height: f64,
    comparison: &Comparison,
) -> Vec<Cell> {
    let mut cells = Vec::new();
    for (column, (experiment, bounds)) in group.experiments.iter().zip(bounds(group)).enumerate() {
        let [Some(left), Some(right)] = bounds.map(|frequency| x.at(frequency)) else { continue };
        for harmonic in &experiment.harmonics {
            let Ok(row) = orders.binary_search(&harmonic.order) else { continue };
            let y = top + height * row as f64;
            cells.push(Cell {
                sides: [left, y, right, y + height],
                row,
                column,
                magnitude: group.magnitude,
                frequency_hz: frequency_hz(experiment, 1),
                order: harmonic.order,
                run: experiment.run,
                sigmas: sigmas(harmonic),
                hint: hint(experiment, harmonic, comparison),
            });
        }
    }
    cells
}

fn hint(
    experiment: &ComparedExperiment,
    harmonic: &ComparedHarmonic,
    comparison: &Comparison,
) -> String {
    let size = sigmas(harmonic).map_or_else(String::new, |size| number(size, 3));
    format!(
        "{}, {} Hz, k = {}: {size} σ",
        magnitude_label(experiment.magnitude, comparison),
        number(frequency_hz(experiment, 1), 3),
        harmonic.order
    )
}

fn class(sigmas: f64) -> String {
    let index = SIGMA_CLASSES.iter().rposition(|from| sigmas >= *from).unwrap_or(0);
    format!("q{index}")
}

/// The legend of the colours.
fn colours(canvas: &mut Canvas) {
    const WIDTH: f64 = 56.0;
    let (mut x, y) = (LEFT, canvas.y + 4.0);
    canvas.text(24.0, y + 11.0, NOTE, Anchor::Start, "|residual| (σ)");
    for (index, from) in SIGMA_CLASSES.iter().enumerate() {
        canvas.rectangle(&format!("q{index}"), [x, y, x + WIDTH, y + 14.0], "");
        let label = match SIGMA_CLASSES.get(index + 1) {
            Some(to) => format!("{from}–{to}"),
            None => format!("≥ {from}"),
        };
        canvas.text(x + 0.5 * WIDTH, y + 28.0, TICK, Anchor::Middle, &label);
        x += WIDTH;
    }
    canvas.text(x + 14.0, y + 11.0, NOTE, Anchor::Start, "grey: compatible with noise");
    canvas.y = y + 46.0;
}

#[cfg(test)]
mod tests {
    use super::*;

    fn experiment(omega_rad_s: f64) -> ComparedExperiment {
        let harmonics = Vec::new();
        ComparedExperiment { experiment: 0, magnitude: 1.0, omega_rad_s, run: None, harmonics }
    }

    #[test]
    fn columns_meet_half_way_and_share_a_frequency_measured_twice() {
        let experiments = [1.0, 4.0, 4.0, 16.0].map(|hz| experiment(std::f64::consts::TAU * hz));
        let group = Group { magnitude: 1.0, experiments: experiments.iter().collect() };
        let wanted = [[0.5, 2.0], [2.0, 4.0], [4.0, 8.0], [8.0, 32.0]];
        for (got, wanted) in bounds(&group).iter().flatten().zip(wanted.iter().flatten()) {
            // Rounding of a few roots and powers.
            assert!((got / wanted - 1.0).abs() < 1e-12, "{got} {wanted}");
        }
    }
}
