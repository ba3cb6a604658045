//! Records of many lines: residuals over the frequency of the line.

use servoscope_core::answers::{ComparedExperiment, Comparison, Pattern};

use super::super::canvas::{Canvas, MARGIN, Marker, Trace, WIDTH};
use super::super::panel::{Key, Look, Naming, Panel, legend};
use super::super::scale::{DECIMAL, Scale, range};
use super::super::series::{experiment_label, frequency_hz, sigmas, spread};
use super::{badge, within};

/// Records shown at most.
pub(super) const MOST_PANELS: usize = 4;

const LEFT: f64 = 64.0;

pub(super) fn draw(canvas: &mut Canvas, comparison: &Comparison, patterns: &[Pattern]) {
    let mut experiments: Vec<&ComparedExperiment> = comparison.experiments.iter().collect();
    experiments.sort_by(|a, b| a.magnitude.total_cmp(&b.magnitude));
    let shown = spread(experiments.len(), MOST_PANELS);
    legend(
        canvas,
        &[
            Key::new(Look::Marker(Marker::Circle), "s0", "one harmonic").toggling("residual"),
            Key::new(Look::Line("floor"), "key", "one standard deviation: noise").toggling("noise"),
        ],
    );
    let every = || shown.iter().flat_map(|i| lines(experiments[*i]));
    let [low, high] = range(every().map(|line| line.0));
    let [smallest, largest] = range(every().map(|line| line.1).filter(|size| *size > 0.0));
    // Down to the smallest: none is put at an edge where it does not belong.
    let sizes = [0.8 * smallest.min(0.5), largest.max(3.0) * 1.5];
    let few = shown.len() == 1;
    for (series, &index) in shown.iter().enumerate() {
        let experiment = experiments[index];
        let top = canvas.y + if few { 30.0 } else { 46.0 };
        let bottom = top + if few { 320.0 } else { 190.0 };
        let (left, right) = (LEFT, WIDTH - MARGIN);
        let x = Scale::log([low / 1.1, high * 1.1], [left, right]);
        let y = Scale::log(sizes, [bottom, top]);
        let panel = Panel { x, y, left, top, right, bottom };
        let label = experiment_label(experiment, comparison);
        let heading = if few { String::new() } else { label };
        let naming = Naming {
            heading: &heading,
            x: "Frequency (Hz)",
            y: "|Residual| (σ)",
            ..Naming::default()
        };
        let bands = bands(canvas, &panel, experiment, patterns);
        panel.draw(canvas, &y.vertical_ticks(DECIMAL), naming);
        canvas.open_trace("", panel.sides(), Trace::keyed("noise"));
        canvas.polyline("floor", [panel.at(low / 2.0, 1.0), panel.at(high * 2.0, 1.0)]);
        canvas.close();
        points(canvas, &panel, series, experiment);
        bands.into_iter().for_each(|(index, x)| badge(canvas, index, [x, top + 11.0]));
        canvas.y = bottom + 44.0;
    }
}

/// Frequency and size of every residual but the mean's.
fn lines(experiment: &ComparedExperiment) -> impl Iterator<Item = (f64, f64)> {
    let harmonics = experiment.harmonics.iter().filter(|h| h.order > 0);
    harmonics.filter_map(|h| Some((frequency_hz(experiment, h.order), sigmas(h)?)))
}

fn points(canvas: &mut Canvas, panel: &Panel, series: usize, experiment: &ComparedExperiment) {
    let radius = if experiment.harmonics.len() > 300 { 1.8 } else { 2.6 };
    let trace = Trace { name: "residual", keys: "residual", ..Trace::default() };
    canvas.open_inside(&format!("s{series} dense data"), panel.sides(), trace);
    for (frequency, size) in lines(experiment).filter(|(_, size)| *size > 0.0) {
        let Some(at) = panel.at(frequency, size) else { continue };
        canvas.marker(Marker::Circle, at, radius, "");
    }
    canvas.close();
}

/// Shades the band of frequencies of each pattern, and says where it is numbered.
fn bands(
    canvas: &mut Canvas,
    panel: &Panel,
    experiment: &ComparedExperiment,
    patterns: &[Pattern],
) -> Vec<(usize, f64)> {
    let mut badges: Vec<(usize, f64)> = Vec::new();
    for (index, pattern) in patterns.iter().enumerate() {
        let of_run = experiment.run.is_none_or(|run| within(pattern.runs, run));
        if !within(pattern.magnitudes, experiment.magnitude) || !of_run {
            continue;
        }
        let [left, right] = match pattern.frequencies_hz {
            None => [panel.left, panel.right],
            Some(band) => band.map(|frequency| {
                panel.x.at(frequency).unwrap_or(panel.left).clamp(panel.left, panel.right)
            }),
        };
        // A single line is a band of some width, too.
        let (left, right) = (left.min(right - 3.0), right.max(left + 3.0));
        canvas.rectangle("shade", [left, panel.top, right, panel.bottom], "");
        let mut x = (left + 11.0).min(panel.right - 11.0);
        while badges.iter().any(|(_, other)| (other - x).abs() < 18.0) {
            x += 18.0;
        }
        badges.push((index, x));
    }
    badges
}
