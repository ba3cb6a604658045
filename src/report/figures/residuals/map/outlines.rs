//! Outlines of patterns on the map, with their numbers.

use std::collections::BTreeSet;

use servoscope_core::answers::Pattern;

use super::super::super::canvas::{Canvas, Trace};
use super::super::{badge, within};
use super::{Block, Cell};

/// Outlines what belongs to each pattern and numbers it in every block.
pub(super) fn mark(canvas: &mut Canvas, blocks: &[Block], patterns: &[Pattern]) {
    // Each with the block it is in.
    let mut outlines: Vec<([f64; 4], Vec<Edge>)> = Vec::new();
    let mut badges: Vec<(usize, [f64; 2])> = Vec::new();
    let mut of_badges = Vec::new();
    for (index, pattern) in patterns.iter().enumerate() {
        // Outlines of patterns that overlap stand side by side, not on each other.
        let inset = 1.0 + 2.5 * (index % 3) as f64;
        for Block { sides, cells } in blocks {
            let cells: Vec<&Cell> = cells.iter().filter(|c| belongs(pattern, c)).collect();
            let inside: BTreeSet<(usize, usize)> =
                cells.iter().map(|c| (c.row, c.column)).collect();
            let edges = cells.iter().flat_map(|cell| outline(cell, &inside, inset)).collect();
            outlines.push((*sides, edges));
            if let Some(first) = cells.iter().min_by_key(|cell| (cell.row, cell.column)) {
                badges.push((index, free_place(first, &badges)));
                of_badges.push(*sides);
            }
        }
    }
    // Every outline on top of every halo, every number on top of every outline.
    for class in ["halo", "ink"] {
        for (sides, edges) in outlines.iter().filter(|(_, edges)| !edges.is_empty()) {
            let path = edges.iter().flat_map(|[from, to]| [Some(*from), Some(*to), None]);
            canvas.open_inside("outlines", *sides, Trace::keyed("patterns"));
            canvas.polyline(class, path);
            canvas.close();
        }
    }
    for ((index, place), sides) in badges.into_iter().zip(of_badges) {
        canvas.open_inside("", sides, Trace::keyed("patterns"));
        badge(canvas, index, place);
        canvas.close();
    }
}

fn belongs(pattern: &Pattern, cell: &Cell) -> bool {
    let of_run = |runs| cell.run.is_some_and(|run| within(Some(runs), run));
    within(pattern.magnitudes, cell.magnitude)
        && within(pattern.frequencies_hz, cell.frequency_hz)
        && (pattern.harmonics.is_empty() || pattern.harmonics.contains(&cell.order))
        && pattern.runs.is_none_or(of_run)
}

/// Where a number has room beside those there are: the corner of its cell, or
/// right of it.
fn free_place(cell: &Cell, badges: &[(usize, [f64; 2])]) -> [f64; 2] {
    const APART: f64 = 18.0;
    let [left, top, ..] = cell.sides;
    let mut place = [left + 9.0, top + 9.0];
    let taken = |place: [f64; 2]| {
        badges.iter().any(|(_, other)| {
            (other[0] - place[0]).abs() < APART && (other[1] - place[1]).abs() < APART
        })
    };
    while taken(place) {
        place[0] += APART;
    }
    place
}

/// One side of a cell, from a corner to the next.
type Edge = [[f64; 2]; 2];

/// The sides of a cell at which its pattern ends, moved inwards.
fn outline(cell: &Cell, inside: &BTreeSet<(usize, usize)>, inset: f64) -> Vec<Edge> {
    let (row, column) = (cell.row, cell.column);
    let open = |dr: isize, dc: isize| {
        let moved = row.checked_add_signed(dr).zip(column.checked_add_signed(dc));
        !moved.is_some_and(|place| inside.contains(&place))
    };
    let [above, below, before, after] = [open(-1, 0), open(1, 0), open(0, -1), open(0, 1)];
    let pull = |end: bool| if end { inset } else { 0.0 };
    let [left, top, right, bottom] = cell.sides;
    let (x0, x1) = (left + pull(before), right - pull(after));
    let (y0, y1) = (top + pull(above), bottom - pull(below));
    [
        (above, [[x0, y0], [x1, y0]]),
        (below, [[x0, y1], [x1, y1]]),
        (before, [[x0, y0], [x0, y1]]),
        (after, [[x1, y0], [x1, y1]]),
    ]
    .into_iter()
    .filter_map(|(ends, edge)| ends.then_some(edge))
    .collect()
}
