//! How long the next step is.

use crate::plant::Scalar;

use super::super::wave::Cell;
use super::affine::Affine;

/// How steps are taken.
pub(super) enum Pace<S, const M: usize> {
    /// Exactly, no longer than this, by the equations of every mode seen; the
    /// step's length comes `again` where it is an even part of a cell.
    Exact { longest_s: f64, steps: Vec<Affine<S, M>>, again: bool },
    /// By Runge–Kutta stages, as long as the error allows.
    Controlled { length_s: f64 },
}

impl<S: Scalar, const M: usize> Pace<S, M> {
    /// The share of a cell to try from position `from`.
    #[inline]
    pub fn width(&mut self, cell: &Cell<S>, from: S) -> S {
        let left = -from + 1.0;
        match self {
            Pace::Exact { longest_s, again, .. } => {
                // The cell's own even parts, so that their steps come again.
                let parts = (cell.length_s / *longest_s).ceil().max(1.0);
                let done = from.value() * parts;
                let fixed = (0..S::LANES).all(|lane| from.lane(lane) == 0.0);
                *again = fixed && (done - done.round()).abs() < 1e-6;
                if *again {
                    return S::constant(1.0 / parts);
                }
                -from + (((done + 1e-6).floor() + 1.0) / parts).min(1.0)
            }
            Pace::Controlled { length_s } => {
                let share = *length_s / cell.length_s;
                // No sliver at the end of a cell.
                if share * 1.1 >= left.value() { left } else { S::constant(share) }
            }
        }
    }

    /// Whether a step's error is allowed, and how long the next may be.
    #[inline]
    pub fn accepts(&mut self, error: f64, tried_s: f64, cell_s: f64) -> bool {
        let Pace::Controlled { length_s } = self else { return true };
        let growth = 0.9 * f64::from((error.max(1e-10) as f32).powf(-0.2));
        if error > 1.0 {
            *length_s = tried_s * growth.max(0.2);
            return false;
        }
        // The end of a cell may have cut it short: it says nothing then.
        *length_s = (length_s.max(tried_s) * growth.clamp(0.3, 4.0)).min(cell_s.max(tried_s));
        true
    }
}
