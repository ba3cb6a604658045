//! What was measured, as curves: the response over frequency, or one period over time.

use std::f64::consts::TAU;

use servoscope_core::measurement::{Complex, Experiment, Measurement, Transient};

use crate::report::figures::Theme;
use crate::report::figures::chart::{self, Line, Plot, Stroke};

/// The most magnitudes, or records, that are told apart.
const MOST_LINES: usize = 6;

/// Points of a period in time.
const POINTS: usize = 800;

/// The most samples of a motion that are drawn.
const MOST_POINTS: usize = 4000;

/// The least share of the largest line of an input that counts as excited.
const EXCITED_SHARE: f64 = 0.02;

/// Draws a measurement as an SVG document: gain and phase of the response over frequency, and of
/// records one period over time.
pub(super) fn draw(measurement: &Measurement) -> String {
    if let [motion, ..] = measurement.transients() {
        return of_motion(measurement, motion);
    }
    let experiments = measurement.experiments();
    let mut magnitudes: Vec<f64> = experiments.iter().map(|e| e.magnitude).collect();
    magnitudes.sort_by(f64::total_cmp);
    magnitudes.dedup();
    let step = magnitudes.len().div_ceil(MOST_LINES).max(1);
    let [input, output] = units(measurement);
    let levels: Vec<f64> = magnitudes.into_iter().step_by(step).collect();
    let label = |magnitude: f64| match magnitude {
        0.01.. => format!("{} {input}", three_digits(magnitude)),
        _ => format!("{magnitude:.2e} {input}"),
    };

    let [mut gains, mut phases, mut inputs, mut outputs] = <[Vec<Line>; 4]>::default();
    for level in levels {
        let of_level: Vec<&Experiment> =
            experiments.iter().filter(|e| e.magnitude == level).collect();
        let mut points: Vec<(f64, Complex)> =
            of_level.iter().flat_map(|experiment| ratios(experiment)).collect();
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        let line =
            |points: Vec<[f64; 2]>| Line { label: label(level), points, stroke: Stroke::Solid };
        gains.push(line(points.iter().map(|(hz, ratio)| [*hz, ratio.norm()]).collect()));
        phases.push(line(unwrapped(&points)));
        if let Some(record) = of_level.iter().find(|experiment| experiment.from_record) {
            let period = TAU / record.omega_rad_s;
            inputs.push(line(over_time(&record.input, period)));
            outputs.push(line(over_time(&dense(record), period)));
        }
    }
    let bode = |y: String, lines: Vec<Line>, is_gain: bool| Plot {
        x: "Frequency (Hz)".into(),
        y,
        logarithmic: [true, is_gain],
        floor: None,
        lines,
    };
    let mut plots = vec![
        bode(format!("Gain ({output} per {input})"), gains, true),
        bode("Phase (°)".into(), phases, false),
    ];
    if !inputs.is_empty() {
        let x = "Time within a period (s)";
        plots.push(over(x, format!("Input ({input})"), inputs));
        plots.push(over(x, format!("Response ({output})"), outputs));
    }
    let says = "Gain and phase of the measured response over frequency, at each magnitude of the \
                input";
    chart::lines("measured", "What was measured", says, &plots, Theme::Auto)
}

/// The first motion that does not repeat, over time.
fn of_motion(measurement: &Measurement, motion: &Transient) -> String {
    let [input, output] = units(measurement);
    let line = |values: &[f64]| {
        let every = values.len().div_ceil(MOST_POINTS);
        let samples = values.iter().enumerate().step_by(every);
        let points = samples.map(|(i, value)| [i as f64 * motion.step_s, *value]).collect();
        vec![Line { label: "measured".into(), points, stroke: Stroke::Solid }]
    };
    let plots = [
        over("Time (s)", format!("Input ({input})"), line(&motion.input)),
        over("Time (s)", format!("Response ({output})"), line(&motion.output)),
    ];
    let says = "Input and response over time; the input does not repeat";
    chart::lines("measured", "What was measured", says, &plots, Theme::Auto)
}

/// Axes over time.
fn over(x: &str, y: String, lines: Vec<Line>) -> Plot {
    Plot { x: x.into(), y, logarithmic: [false, false], floor: None, lines }
}

/// The units of input and response, or words in their place.
fn units(measurement: &Measurement) -> [String; 2] {
    let metadata = measurement.metadata();
    let or = |unit: &str, word: &str| if unit.is_empty() { word } else { unit }.to_owned();
    [or(&metadata.input.unit, "input"), or(&metadata.response.unit, "response")]
}

/// Frequency (Hz) and ratio of response to input at every excited line.
fn ratios(experiment: &Experiment) -> Vec<(f64, Complex)> {
    let lines = || experiment.input.iter().enumerate().skip(1);
    let largest = lines().map(|(_, u)| u.norm()).fold(0.0, f64::max);
    let excited = lines().filter(|(_, u)| u.norm() > EXCITED_SHARE * largest);
    let ratio = |(order, u): (usize, &Complex)| {
        let hertz = order as f64 * experiment.omega_rad_s / TAU;
        let ratio = experiment.harmonic(order)?.value / u;
        (ratio.norm() > 0.0).then_some((hertz, ratio))
    };
    excited.filter_map(ratio).collect()
}

/// The phase in degrees, without jumps of a whole turn.
fn unwrapped(points: &[(f64, Complex)]) -> Vec<[f64; 2]> {
    let mut last = 0.0;
    let phase = |(hertz, ratio): &(f64, Complex)| {
        let turned = ratio.arg().to_degrees();
        last = turned + 360.0 * ((last - turned) / 360.0_f64).round();
        [*hertz, last]
    };
    points.iter().map(phase).collect()
}

/// The harmonics of a response, with zeros for those that were not measured.
fn dense(experiment: &Experiment) -> Vec<Complex> {
    let mut harmonics = vec![Complex::new(0.0, 0.0); experiment.highest_harmonic() + 1];
    experiment.response.iter().for_each(|harmonic| harmonics[harmonic.order] = harmonic.value);
    harmonics
}

/// x(t) = Re Σ Xₖ exp(jkωt) over one period.
fn over_time(harmonics: &[Complex], period: f64) -> Vec<[f64; 2]> {
    let largest = harmonics.iter().map(|x| x.norm()).fold(0.0, f64::max);
    let heard: Vec<(usize, &Complex)> =
        harmonics.iter().enumerate().filter(|(_, x)| x.norm() > 1e-3 * largest).collect();
    let at = |i: usize| {
        let share = i as f64 / POINTS as f64;
        let turn = |k: usize| Complex::from_polar(1.0, TAU * (k as f64 * share).fract());
        [share * period, heard.iter().map(|(k, x)| (*x * turn(*k)).re).sum()]
    };
    (0..=POINTS).map(at).collect()
}

/// A positive number to three significant digits.
fn three_digits(value: f64) -> f64 {
    let step = 10.0_f64.powf(2.0 - value.log10().floor());
    (step * value).round() / step
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_magnitude_is_written_to_three_digits() {
        let written = [148.428, 6.4, 0.05, 12_345.0].map(|value| three_digits(value).to_string());
        assert_eq!(written, ["148", "6.4", "0.05", "12300"]);
    }

    #[test]
    fn a_phase_goes_on_where_it_passes_half_a_turn() {
        let point = |hz: f64, degrees: f64| (hz, Complex::from_polar(1.0, degrees.to_radians()));
        let phases = unwrapped(&[point(1.0, -100.0), point(2.0, -170.0), point(3.0, 160.0)]);
        let expected = [[1.0, -100.0], [2.0, -170.0], [3.0, -200.0]];
        for (phase, expected) in phases.iter().zip(expected) {
            assert!((phase[1] - expected[1]).abs() < 1e-9, "{phase:?}");
        }
    }

    #[test]
    fn a_period_is_the_sum_of_its_harmonics() {
        let wave = over_time(&[Complex::new(1.0, 0.0), Complex::new(0.0, 2.0)], 4.0);
        // 1 − 2 sin(2πt/4), at a quarter of the period.
        let [t, value] = wave[POINTS / 4];
        assert!((t - 1.0).abs() < 1e-12 && (value + 1.0).abs() < 1e-12);
    }
}
