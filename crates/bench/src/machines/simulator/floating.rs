//! A load that floats in its gap.
//!
//! Between collisions it keeps its velocity while the motor swings. Each collision takes
//! some of what the two drift apart by, so that the next comes later: in the end the load
//! goes at the motor's mean velocity and touches nothing. Stepping gets there in no finite
//! time; but the motor then moves as if it were alone.

use super::drive::Drive;
use super::mechanics::Mechanics;
use super::shooting::{Cycle, Search, settle};
use super::stepping::Axis;

/// The periodic state in which the load floats, near `state`; `None` where the gap is too
/// narrow for it.
pub(super) fn float<const N: usize>(
    mechanics: &Mechanics,
    drive: &Drive,
    period_s: f64,
    state: [f64; N],
    search: &Search,
) -> Option<[f64; N]> {
    let twist = mechanics.twist()?;
    let gap = mechanics.gap();
    let alone = mechanics.with_gap(f64::INFINITY);
    let drifts = |state: [f64; N], load_velocity: f64| {
        let mut start = state;
        (start[twist], start[twist + 1]) = (0.0, load_velocity);
        let mut axis = Axis::new(&alone, drive, start);
        let (mut largest, mut lowest, mut highest) = (start.map(f64::abs), 0.0_f64, 0.0_f64);
        axis.run_period(&mut |piece| {
            for (largest, value) in largest.iter_mut().zip(piece.end) {
                *largest = largest.max(value.abs());
            }
            (lowest, highest) = (lowest.min(piece.end[twist]), highest.max(piece.end[twist]));
        });
        (axis.state(), largest, lowest, highest)
    };
    let run = |state: [f64; N]| {
        let (mut end, largest, ..) = drifts(state, 0.0);
        (end[twist], end[twist + 1]) = (0.0, 0.0);
        Cycle { end, largest, floats: false }
    };
    let mut start = state;
    (start[twist], start[twist + 1]) = (0.0, 0.0);
    let mut periodic = settle(&run, &|_| None, start, search).ok()??;
    let mean_velocity = drifts(periodic, 0.0).0[twist] / period_s;
    let (_, _, lowest, highest) = drifts(periodic, mean_velocity);
    (periodic[twist], periodic[twist + 1]) = (-0.5 * (lowest + highest), mean_velocity);
    (highest - lowest < gap).then_some(periodic)
}
