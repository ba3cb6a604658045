//! Optimal design for model discrimination: the next experiment that best separates two models.
//!
//! Both models were fitted to all data. The point at which their predictions differ most in units
//! of the noise tells them apart soonest (Hunter and Reiner 1965,
//! doi:10.1080/00401706.1965.10490265). A grid of magnitudes and frequencies is scanned for it.

use rayon::prelude::*;

use crate::answers::NextExperiment;
use crate::diagnose::residuals::sentence::{rounded, short};
use crate::identify::{FitSession, Model};
use crate::measurement::after_number;

/// Number of frequencies on the grid.
const FREQUENCIES: usize = 24;

/// Ratio of the highest frequency on the grid to the highest one measured. Lags, delays and load
/// resonances differ most above the measured band.
const HIGHEST_FREQUENCY_RATIO: f64 = 4.0;

/// Magnitudes on the grid, on a logarithmic scale that is 0 at the smallest and 1 at the largest
/// measured magnitude. One lies below the measured range, as far as a rig will allow.
const MAGNITUDE_SHARES: [f64; 6] = [-0.15, 0.0, 0.25, 0.5, 0.75, 1.0];

/// The experiment in which the predictions of `named` and `rival` differ most; each comes with the
/// id of the effect that the other lacks.
pub(crate) fn between(
    session: &FitSession<'_>,
    named: (&Model, &str),
    rival: (&Model, &str),
) -> Option<NextExperiment> {
    let experiments = session.measurement().experiments();
    let span = |value: &dyn Fn(usize) -> f64| {
        let values = || (0..experiments.len()).map(value).filter(|value| *value > 0.0);
        (values().fold(f64::INFINITY, f64::min), values().fold(0.0, f64::max))
    };
    let (weak, strong) = span(&|e| experiments[e].magnitude);
    let (slow, fast) = span(&|e| experiments[e].omega_rad_s);
    let between = |low: f64, high: f64, share: f64| low * (high / low).powf(share);
    let points: Vec<(f64, f64)> = MAGNITUDE_SHARES
        .into_iter()
        .flat_map(|share| {
            let frequency = move |i: usize| i as f64 / (FREQUENCIES - 1) as f64;
            (0..FREQUENCIES).map(move |i| (share, frequency(i)))
        })
        .map(|(m, omega)| {
            (between(weak, strong, m), between(slow, HIGHEST_FREQUENCY_RATIO * fast, omega))
        })
        .collect();
    let separated: Vec<Option<f64>> = points
        .par_iter()
        .map(|(m, omega)| session.separation([named.0, rival.0], *m, *omega))
        .collect();
    let (chi2, (magnitude, omega_rad_s)) = separated
        .into_iter()
        .zip(points)
        .filter_map(|(chi2, point)| Some((chi2.filter(|chi2| chi2.is_finite())?, point)))
        .max_by(|a, b| a.0.total_cmp(&b.0))?;
    let unit = after_number(&session.measurement().metadata().input.unit);
    let beyond = match (magnitude < weak, omega_rad_s > fast) {
        (true, true) => Some("below the magnitudes and above the frequencies"),
        (true, false) => Some("below the magnitudes"),
        (false, true) => Some("above the frequencies"),
        (false, false) => None,
    };
    let beyond = beyond.map_or(String::new(), |beyond| {
        format!("; this is {beyond} measured so far: check that the rig allows it")
    });
    let reason = format!(
        "measure at magnitude {}{unit} and {} Hz: there the predictions of {} and {}, which explain \
         the data almost equally well, differ most, by {} standard deviations of the noise in all \
         harmonics together{beyond}",
        rounded(magnitude, 3),
        rounded(omega_rad_s / std::f64::consts::TAU, 3),
        named.1,
        rival.1,
        short(chi2.sqrt()),
    );
    Some(NextExperiment { magnitude, omega_rad_s, reason })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::tests::{exact, noisy, request};
    use crate::effects;
    use crate::machines::draw::NoiseStatement;
    use crate::observer::Silent;

    // To first order in ωT a delay and a lag are the same. Their difference grows with (ωT)²,
    // faster than the response falls with frequency.
    #[test]
    fn a_delay_and_a_lag_are_told_apart_beyond_the_highest_frequency() {
        let (measurement, request) = (noisy(&exact(), NoiseStatement::Std, 1), request());
        let session = FitSession::new(&measurement, &request, &Silent).unwrap();
        let models = ["transport_delay", "sensor_lag"].map(|id| {
            let mut model = session.extend(session.base(), effects::find(id).unwrap());
            model.set(model.parameters_of(0).start, 1e-3);
            model
        });
        let [delay, lag] = [(&models[0], "transport_delay"), (&models[1], "sensor_lag")];
        let next = between(&session, delay, lag).unwrap();
        let measured = measurement.experiments().iter().map(|e| e.omega_rad_s);
        let highest = measured.fold(0.0, f64::max);
        assert!(next.omega_rad_s > highest && next.omega_rad_s < 4.01 * highest, "{next:?}");
        let said = &next.reason;
        assert!(said.starts_with("measure at magnitude "), "{said}");
        assert!(said.contains("the predictions of transport_delay and sensor_lag"), "{said}");
        assert!(said.contains("above the frequencies measured so far"), "{said}");
    }
}
