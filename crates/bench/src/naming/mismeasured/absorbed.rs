//! Whether the model of a machine can take a fault of its measurement into its own parameters.

use crate::machines::draw::DrawError;
use crate::naming::build_case::{Made, MakeError};
use crate::naming::mismeasurement::Mismeasurement;
use crate::naming::rivals::Rivals;

impl Made {
    /// Excess χ² that the machine's own model, the base model with its hidden effect, leaves of the
    /// response with the fault and without noise, everything refitted. Where it is small, other
    /// parameters predict what was measured, and no diagnosis can tell the fault. `None` without such
    /// a fault, of one that moves single rows or none, and of a machine with several effects, or of
    /// a record; infinite if the model is so far off that its errors are not counted in noise.
    ///
    /// # Errors
    /// See [`MakeError`].
    pub fn left_of_fault(&self) -> Result<Option<f64>, MakeError> {
        let Some(mistake) = &self.mistake else { return Ok(None) };
        let moves_all =
            !matches!(mistake.fault, Mismeasurement::BadRows(_) | Mismeasurement::StdFactor { .. });
        if !moves_all || self.hidden.len() > 1 || self.instrument.recording.is_some() {
            return Ok(None);
        }
        let faulty = mistake.fault.apply(&self.exact()?).map_err(DrawError::from)?;
        let fits = Rivals::ask(&faulty, self.machine.plant.actuator.order())?;
        let left = match self.hidden.as_slice() {
            [hidden] => fits.excess_with(hidden.effect),
            _ => Some(fits.excess_alone()),
        };
        Ok(left.map(|excess| if excess.is_nan() { f64::INFINITY } else { excess }))
    }
}

#[cfg(test)]
mod tests {
    use servoscope_core::observer::Silent;

    use super::super::DISTINCT;
    use crate::naming::sizing::Sizing;
    use crate::naming::{Case, build_case};

    fn left(key: &str) -> Option<f64> {
        let case: Case = key.parse().unwrap();
        build_case(&case, 811, Sizing::Amount, &Silent).unwrap().left_of_fault().unwrap()
    }

    // Called peak values, rms values are those of an axis with less gain and the same friction, but
    // for their means. A phase of one level is that of no axis.
    #[test]
    fn a_smaller_gain_takes_rms_values_for_peak_values_and_no_axis_a_phase_of_one_level() {
        assert!(left("mismeasured-50-o2-11").unwrap() < DISTINCT);
        assert!(left("mismeasured-50-o0-4").unwrap() > 100.0);
        assert_eq!(left("mismeasured-50-o0-0"), None, "bad rows");
    }
}
