//! Logarithmic sweeps of the same duration, which a plan is compared with.

use super::design::{Design, FEWEST_REPEATS, FREQUENCIES, MAGNITUDES, Point};

/// Every how many-th frequency of the grid a sweep may take; each divides the grid.
const STRIDES: [usize; 6] = [1, 2, 3, 4, 6, 8];

/// Magnitudes of the grid of a sweep at one magnitude, and of one at all of them: each twice the one
/// before where the range is as usual.
pub(super) const ONE: [usize; 1] = [MAGNITUDES - 1];
pub(super) const ALL: [usize; 3] = [1, 3, 5];

/// A sweep on the grid.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Sweep {
    /// Magnitudes of the grid, ascending.
    pub magnitudes: Vec<usize>,
    /// Every how many-th frequency.
    pub stride: usize,
    /// Repeats of every point.
    pub repeats: usize,
}

impl Sweep {
    /// The sweep at some magnitudes with the most frequencies that a budget pays for, and then the most
    /// repeats; `None` if it pays for none. Points beyond the limits are left out.
    pub fn within(
        points: &[Point],
        allowed: &[bool],
        magnitudes: &[usize],
        budget_s: f64,
    ) -> Option<Self> {
        let sweep = |stride, repeats| Self { magnitudes: magnitudes.to_vec(), stride, repeats };
        let fits = |sweep: &Self| {
            let design = sweep.design(points, allowed);
            design.measured().next().is_some() && design.duration_s(points) <= budget_s
        };
        let stride = STRIDES.into_iter().find(|stride| fits(&sweep(*stride, FEWEST_REPEATS)))?;
        let more = (FEWEST_REPEATS..).map(|repeats| sweep(stride, repeats));
        more.take_while(fits).last()
    }

    /// Its points, magnitude by magnitude, frequencies ascending.
    pub fn order(&self, allowed: &[bool]) -> Vec<usize> {
        let all = self.magnitudes.iter().flat_map(|magnitude| {
            (0..FREQUENCIES).step_by(self.stride).map(move |f| magnitude * FREQUENCIES + f)
        });
        all.filter(|point| allowed[*point]).collect()
    }

    /// The same as a design.
    pub fn design(&self, points: &[Point], allowed: &[bool]) -> Design {
        let mut design = Design::none(points);
        self.order(allowed).into_iter().for_each(|point| design.0[point] = self.repeats);
        design
    }
}
