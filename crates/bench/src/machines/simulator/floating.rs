//! The periodic state of a load that floats in its gap.
//!
//! Between collisions the load keeps its velocity while the motor oscillates. Each collision
//! reduces the difference between the load's velocity and the motor's mean velocity, so the next
//! one comes later. In the limit the load moves at the motor's mean velocity without contact. Time
//! stepping never reaches that limit, but it is easy to compute: the motor moves as if alone.

use super::drive::Drive;
use super::mechanics::Mechanics;
use super::shooting::{Cycle, Search, settle};
use super::stepping::Axis;

/// The periodic state near `state` in which the load floats; `None` if the gap is too narrow.
pub(super) fn float<const N: usize>(
    mechanics: &Mechanics,
    drive: &Drive,
    period_s: f64,
    state: [f64; N],
    search: &Search,
) -> Option<[f64; N]> {
    let twist = mechanics.twist()?;
    let gap = mechanics.gap();
    let without_contact = mechanics.with_gap(f64::INFINITY);
    let run_without_contact = |state: [f64; N], load_velocity: f64| {
        let mut start = state;
        (start[twist], start[twist + 1]) = (0.0, load_velocity);
        let mut axis = Axis::new(&without_contact, drive, start);
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
        let (mut end, largest, ..) = run_without_contact(state, 0.0);
        (end[twist], end[twist + 1]) = (0.0, 0.0);
        Cycle { end, largest, floats: false }
    };
    let mut start = state;
    (start[twist], start[twist + 1]) = (0.0, 0.0);
    let mut periodic = settle(&run, &|_| None, start, search).ok()??;
    let mean_velocity = run_without_contact(periodic, 0.0).0[twist] / period_s;
    let (_, _, lowest, highest) = run_without_contact(periodic, mean_velocity);
    (periodic[twist], periodic[twist + 1]) = (-0.5 * (lowest + highest), mean_velocity);
    (highest - lowest < gap).then_some(periodic)
}
