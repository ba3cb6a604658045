//! What a Bode diagram draws: ratios of response to input, by magnitude.

use std::collections::HashMap;

use servoscope_core::answers::{ComparedExperiment, ComparedHarmonic, Comparison};

use super::super::scale::range;
use super::super::series::{
    by_magnitude, excited, experiment_label, frequency_hz, has_many_lines, is_seen,
    largest_measured, magnitude_label, size,
};

/// Most that the phase of an axis and its actuator turns over a band, degrees:
/// beyond it, noise was counted as turns.
const MOST_TURNED_DEG: f64 = 720.0;

/// Branch of the first phase: its middle, degrees. Position, velocity and
/// acceleration of an axis all begin within half a turn of it.
const FIRST_BRANCH_DEG: f64 = -90.0;

/// Angle from which a difference of phases is about half a turn, degrees.
const HALF_TURN_DEG: f64 = 140.0;

#[derive(Debug, Clone, Copy)]
pub(in crate::report::figures) struct Ratio {
    pub(in crate::report::figures) gain_db: f64,
    pub(in crate::report::figures) phase_deg: f64,
}

#[derive(Debug)]
pub(in crate::report::figures) struct Point {
    pub(in crate::report::figures) frequency_hz: f64,
    /// `None` where nothing moved.
    pub(in crate::report::figures) measured: Option<Ratio>,
    pub(in crate::report::figures) simulated: Option<Ratio>,
    /// Of the model with the causes.
    pub(in crate::report::figures) extended: Option<Ratio>,
    /// Standard deviation of the measured ratio, as a share of it; `None` where it is not known.
    pub(in crate::report::figures) noise: Option<f64>,
}

impl Point {
    /// Measured without one of the models: dB and degrees, less than half a turn.
    pub(in crate::report::figures) fn error(&self, model: Option<Ratio>) -> Option<Ratio> {
        let (measured, model) = self.measured.zip(model)?;
        let phase = measured.phase_deg - model.phase_deg;
        Some(Ratio {
            gain_db: measured.gain_db - model.gain_db,
            phase_deg: phase - 360.0 * (phase / 360.0).round(),
        })
    }
}

#[derive(Debug)]
pub(in crate::report::figures) struct Curve {
    pub(in crate::report::figures) label: String,
    pub(in crate::report::figures) points: Vec<Point>,
}

/// The curves of a comparison, whole turns taken out of their phases.
pub(in crate::report::figures) fn curves(
    comparison: &Comparison,
    extended: Option<&Comparison>,
) -> Vec<Curve> {
    let largest = largest_measured(comparison);
    let extended: HashMap<usize, &ComparedExperiment> = extended
        .iter()
        .flat_map(|extended| &extended.experiments)
        .map(|experiment| (experiment.experiment, experiment))
        .collect();
    let point = |experiment: &ComparedExperiment, harmonic: &ComparedHarmonic| {
        let seen = is_seen(comparison, harmonic, largest);
        let same = |other: &&ComparedHarmonic| other.order == harmonic.order;
        let other = extended.get(&experiment.experiment).map(|other| &other.harmonics);
        Point {
            frequency_hz: frequency_hz(experiment, harmonic.order),
            measured: ratio(harmonic.measured, harmonic.input).filter(|_| seen),
            simulated: ratio(harmonic.simulated, harmonic.input),
            extended: other
                .and_then(|harmonics| harmonics.iter().find(same))
                .and_then(|other| ratio(other.simulated, harmonic.input)),
            noise: Some(harmonic.std / size(harmonic.measured))
                .filter(|share| !comparison.std_estimated && *share > 0.0 && share.is_finite()),
        }
    };
    let many = has_many_lines(comparison);
    let mut curves = Vec::new();
    for group in by_magnitude(comparison) {
        let label = magnitude_label(group.magnitude, comparison);
        if !many {
            let points = group.experiments.iter().filter_map(|experiment| {
                let fundamental = excited(experiment).into_iter().next()?;
                Some(point(experiment, fundamental))
            });
            curves.push(Curve { label, points: points.collect() });
            continue;
        }
        for experiment in &group.experiments {
            let label = experiment_label(experiment, comparison);
            let points = excited(experiment).into_iter().map(|h| point(experiment, h)).collect();
            curves.push(Curve { label, points });
        }
    }
    curves.retain(|curve| !curve.points.is_empty());
    curves.iter_mut().for_each(unwrap);
    curves
}

fn ratio(response: [f64; 2], input: [f64; 2]) -> Option<Ratio> {
    let gain_db = 20.0 * (size(response) / size(input)).log10();
    let phase_deg = (response[1].atan2(response[0]) - input[1].atan2(input[0])).to_degrees();
    (gain_db.is_finite() && phase_deg.is_finite()).then_some(Ratio { gain_db, phase_deg })
}

/// Takes whole turns out of the phases: the simulated curve follows itself, the
/// measured points follow the simulated curve, which has no noise.
fn unwrap(curve: &mut Curve) {
    follow(curve, true);
    let phases = curve.points.iter().filter_map(|point| point.simulated.or(point.measured));
    let [low, high] = range(phases.map(|ratio| ratio.phase_deg));
    if high - low > MOST_TURNED_DEG {
        follow(curve, false);
    }
}

/// Moves every phase by whole turns towards its predecessor, or all towards the
/// branch of the first.
fn follow(curve: &mut Curve, predecessor: bool) {
    let near = |phase: f64, reference: f64| phase - 360.0 * ((phase - reference) / 360.0).round();
    let mut previous = FIRST_BRANCH_DEG;
    let mut neighbour: Option<f64> = None;
    for point in &mut curve.points {
        let mut turn = |ratio: &mut Ratio, leads: bool| {
            ratio.phase_deg = near(ratio.phase_deg, previous);
            if predecessor && leads {
                previous = ratio.phase_deg;
            }
        };
        point.simulated.iter_mut().for_each(|ratio| turn(ratio, true));
        point.extended.iter_mut().for_each(|ratio| turn(ratio, false));
        let answers = point.simulated.is_some();
        point.measured.iter_mut().for_each(|ratio| turn(ratio, !answers));
        // Half a turn off the model, noise alone would choose the side: that of its neighbour.
        let (Some(ratio), true) = (&mut point.measured, answers) else { continue };
        if (ratio.phase_deg - previous).abs() > HALF_TURN_DEG
            && let Some(neighbour) = neighbour
        {
            ratio.phase_deg = near(ratio.phase_deg, neighbour);
        }
        neighbour = Some(ratio.phase_deg);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn measured_points_half_a_turn_off_the_model_stay_together() {
        let ratio = |phase_deg: f64| Some(Ratio { gain_db: 0.0, phase_deg });
        let point = |measured: f64| Point {
            frequency_hz: 1.0,
            measured: ratio(measured),
            simulated: ratio(0.0),
            extended: None,
            noise: None,
        };
        let points = [100.0, 150.0, 178.0, -179.0, 177.0].map(point);
        let mut curve = Curve { label: String::new(), points: points.into() };
        unwrap(&mut curve);
        let phases: Vec<f64> =
            curve.points.iter().map(|point| point.measured.unwrap().phase_deg).collect();
        assert_eq!(phases, [100.0, 150.0, 178.0, 181.0, 177.0]);
    }

    #[test]
    fn phases_have_no_jumps_of_a_whole_turn() {
        let truth: Vec<f64> = (0..40).map(|i| -20.0 - 15.0 * f64::from(i)).collect();
        let wrapped = |phase: f64| (phase + 180.0).rem_euclid(360.0) - 180.0;
        let ratio = |phase_deg: f64| Some(Ratio { gain_db: 0.0, phase_deg: wrapped(phase_deg) });
        let points = truth.iter().enumerate().map(|(i, phase)| Point {
            frequency_hz: 1.0,
            measured: ratio(phase + 7.0),
            // A point of rest in the middle does not lose the count of turns.
            simulated: ratio(*phase).filter(|_| i != 20),
            extended: ratio(*phase),
            noise: None,
        });
        let mut curve = Curve { label: String::new(), points: points.collect() };
        unwrap(&mut curve);
        for (point, phase) in curve.points.iter().zip(truth) {
            let [measured, extended] =
                [point.measured, point.extended].map(|ratio| ratio.unwrap().phase_deg);
            assert!((extended - phase).abs() < 1e-9, "{extended} {phase}");
            // Rounding of angles of a few hundred degrees.
            assert!((measured - phase - 7.0).abs() < 1e-9, "{measured} {phase}");
        }
    }
}
