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
    /// Its points, magnitude by magnitude, frequencies ascending.
    pub order: Vec<usize>,
    /// Their repeats.
    pub design: Design,
}

impl Sweep {
    /// The sweep at some magnitudes with the most frequencies that a budget pays for, and then the most
    /// repeats: the same number of every point, and one more of the first points that the rest pays for.
    /// `None` if it pays for none. Points beyond the limits are left out.
    pub fn within(
        points: &[Point],
        allowed: &[bool],
        magnitudes: &[usize],
        budget_s: f64,
    ) -> Option<Self> {
        let fits = |design: &Design| design.duration_s(points) <= budget_s;
        let mut sweep = STRIDES
            .into_iter()
            .map(|stride| Self::of(points, allowed, magnitudes, stride))
            .find(|sweep| !sweep.order.is_empty() && fits(&sweep.design))?;
        loop {
            let before = sweep.design.clone();
            for point in &sweep.order {
                sweep.design.0[*point] += 1;
                if !fits(&sweep.design) {
                    sweep.design.0[*point] -= 1;
                }
            }
            if sweep.design == before {
                return Some(sweep);
            }
        }
    }

    /// Every `stride`-th frequency at some magnitudes, with the fewest repeats.
    fn of(points: &[Point], allowed: &[bool], magnitudes: &[usize], stride: usize) -> Self {
        let all = magnitudes.iter().flat_map(|magnitude| {
            (0..FREQUENCIES).step_by(stride).map(move |f| magnitude * FREQUENCIES + f)
        });
        let order: Vec<usize> = all.filter(|point| allowed[*point]).collect();
        let mut design = Design::none(points);
        order.iter().for_each(|point| design.0[*point] = FEWEST_REPEATS);
        Self { order, design }
    }
}
