//! A problem on coarser grids, whose simulations are cheaper.

use super::{Prepared, Problem};
use crate::measurement::{Complex, EXCITED_SHARE};

/// Fewest samples of a coarse grid for each cycle of the highest line that is both excited and
/// compared. Quintics interpolate that line with a relative error of 2e-3: (2π/3)⁶/46080.
const FEWEST_SAMPLES_PER_CYCLE: usize = 3;

impl Prepared {
    /// The highest line of the input that is excited and compared; 0 if there is none.
    fn highest_excited(&self) -> usize {
        let lines = || self.excitation.input().iter().enumerate().skip(1);
        let largest = lines().map(|(_, u)| u.norm()).fold(0.0, f64::max);
        let is_excited =
            |(k, u): &(usize, &Complex)| *k <= self.highest && u.norm() > EXCITED_SHARE * largest;
        lines().rfind(is_excited).map_or(0, |(k, _)| k)
    }
}

impl Problem {
    /// The same problem on coarser grids, which interpolate inputs to this error, relative to
    /// their rms without the mean; `None` if no experiment has one.
    pub fn coarser(&self, error: f64) -> Option<Self> {
        let mut coarse = self.clone();
        let mut any = false;
        for experiment in &mut coarse.experiments {
            let fewest = FEWEST_SAMPLES_PER_CYCLE * experiment.highest_excited();
            if let Some(excitation) = experiment.excitation.coarser(error, fewest) {
                experiment.excitation = excitation;
                any = true;
            }
        }
        any.then_some(coarse)
    }
}
