//! The limit of the computing effort for one point.

/// Most effort for one point, as a number of exact steps; beyond it the point counts as not
/// periodic. `BASE_EFFORT` is the same for every input. Each cell of the input adds to it: the
/// first `FEW_CELLS` cells `EFFORT_PER_CELL[0]` each, the others `EFFORT_PER_CELL[1]`. One pass
/// over a long record takes more steps than all passes over a cosine. Tuned: most motions that
/// settle take a fiftieth of this (a fifth for a record), and those that take more hardly ever
/// settle. A cosine takes a few milliseconds at most.
const BASE_EFFORT: usize = 40_000;
const FEW_CELLS: usize = 256;
const EFFORT_PER_CELL: [usize; 2] = [500, 50];

pub(super) fn effort(cells: usize) -> usize {
    let few = cells.min(FEW_CELLS);
    BASE_EFFORT + EFFORT_PER_CELL[0] * few + EFFORT_PER_CELL[1] * (cells - few)
}
