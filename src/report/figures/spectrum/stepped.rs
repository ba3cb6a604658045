//! Stepped sines: amplitude over harmonic, one panel a magnitude.

use servoscope_core::answers::{ComparedExperiment, ComparedHarmonic, Comparison};

use super::super::canvas::{Canvas, MARGIN, Marker, TICK, Trace, WIDTH};
use super::super::panel::{Key, Look, Naming, Panel, legend};
use super::super::scale::{DECIMAL, Scale, Tick};
use super::super::series::{by_magnitude, frequency_hz, left_out, magnitude_label, size, spread};
use super::super::text::{self, number};
use super::super::{NothingToDraw, Subject};
use super::{LEFT, MOST_PANELS, amplitude_name, amplitudes, keys};

/// One panel a magnitude: the experiment whose harmonics are largest.
pub(super) fn stepped(
    subject: &Subject<'_>,
    comparison: &Comparison,
) -> Result<Canvas, NothingToDraw> {
    let groups = by_magnitude(comparison);
    let distortion = |experiment: &ComparedExperiment| {
        let others = experiment.harmonics.iter().filter(|h| h.order != 1);
        others.map(|h| size(h.measured).powi(2)).sum::<f64>()
    };
    let chosen: Vec<(usize, &ComparedExperiment)> = spread(groups.len(), MOST_PANELS)
        .into_iter()
        .filter_map(|index| {
            let experiments = groups[index].experiments.iter().copied();
            let largest = experiments.max_by(|a, b| distortion(a).total_cmp(&distortion(b)))?;
            Some((index, largest))
        })
        .collect();
    let highest = chosen.iter().flat_map(|(_, e)| &e.harmonics).map(|h| h.order).max().unwrap_or(1);
    if highest < 2 {
        return Err(NothingToDraw("only means and fundamentals were measured".into()));
    }
    let title = subject.titled("Harmonics of the response");
    let mut canvas = Canvas::new("spectrum", &title, &says(&chosen, comparison), groups.len());
    let mut keys = keys(comparison);
    let lowest = chosen.iter().flat_map(|(_, e)| &e.harmonics);
    let amplitudes = amplitudes(lowest.clone());
    let beyond = lowest.clone().any(|h| size(h.measured) < amplitudes[0]);
    if beyond {
        let below = Key::new(Look::Beyond, "key", "measured, below the plotted range");
        keys.push(below.toggling("below"));
    }
    legend(&mut canvas, &keys);
    let columns = if chosen.len() == 3 { 3 } else { chosen.len().min(2) };
    let gap = 52.0;
    let width = (WIDTH - MARGIN - LEFT - gap * (columns as f64 - 1.0)) / columns as f64;
    let height = if chosen.len() > 3 { 190.0 } else { 270.0 };
    let start = canvas.y + 38.0;
    for (place, (index, experiment)) in chosen.iter().enumerate() {
        let left = LEFT + (place % columns) as f64 * (width + gap);
        let top = start + (place / columns) as f64 * (height + 92.0);
        let (right, bottom) = (left + width, top + height);
        let x = Scale::linear([-0.6, highest as f64 + 0.6], [left, right]);
        let y = Scale::log(amplitudes, [bottom, top]);
        let panel = Panel { x, y, left, top, right, bottom };
        let magnitude = magnitude_label(experiment.magnitude, comparison);
        let frequency = number(frequency_hz(experiment, 1), 3);
        let heading = format!("{magnitude} at {frequency} Hz");
        // All share the axis: once a row says it.
        let name = match place % columns {
            0 => amplitude_name(comparison),
            _ => String::new(),
        };
        let naming = Naming { heading: &heading, x: "Harmonic k", y: &name, ..Naming::default() };
        panel.draw_with(&mut canvas, &orders(&x, highest), &y.vertical_ticks(DECIMAL), naming);
        harmonics(&mut canvas, &panel, *index, experiment);
        canvas.y = bottom + 44.0;
    }
    if let Some(sentence) = left_out(comparison) {
        canvas.note(&sentence);
    }
    Ok(canvas)
}

fn orders(x: &Scale, highest: usize) -> Vec<Tick> {
    let [from, to] = x.edges();
    let each = (to - from) / (highest as f64 + 1.2);
    let room = text::width("000", TICK.size);
    let step = [1, 2, 5, 10, 20, 50, 100].into_iter().find(|s| *s as f64 * each >= room);
    let step = step.unwrap_or(highest.max(1));
    let shown = (0..=highest).step_by(step);
    shown.filter_map(|k| Some(Tick { px: x.at(k as f64)?, label: k.to_string() })).collect()
}

fn harmonics(canvas: &mut Canvas, panel: &Panel, index: usize, experiment: &ComparedExperiment) {
    let half = 0.32;
    let lowest = |value: f64| panel.y.holds(value);
    let span = |h: &ComparedHarmonic, value: f64, half: f64| {
        let k = h.order as f64;
        Some([panel.at(k - half, value)?, panel.at(k + half, value)?])
    };
    let class = format!("s{index}");
    canvas.open_trace(&class, panel.sides(), Trace::keyed("noise"));
    let floor = experiment.harmonics.iter().flat_map(|h| match span(h, h.std, 0.5) {
        Some(ends) => ends.map(Some),
        None => [None; 2],
    });
    canvas.polyline("floor", floor);
    canvas.close();
    canvas.open_trace(&class, panel.sides(), Trace::keyed("measured"));
    for harmonic in &experiment.harmonics {
        let value = size(harmonic.measured);
        if let Some([x, y]) = panel.at(harmonic.order as f64, value).filter(|_| lowest(value)) {
            canvas.line("stem", [x, panel.bottom], [x, y]);
        }
    }
    canvas.close();
    canvas.open_trace(&class, panel.sides(), Trace::keyed("simulated"));
    for harmonic in &experiment.harmonics {
        if let Some([from, to]) = span(harmonic, size(harmonic.simulated), half) {
            canvas.line("bar", from, to);
        }
    }
    canvas.close();
    let (above, below): (Vec<&ComparedHarmonic>, Vec<_>) =
        experiment.harmonics.iter().partition(|h| lowest(size(h.measured)));
    let trace = Trace { name: "measured", keys: "measured", hints: true, ..Trace::default() };
    canvas.open_inside(&format!("s{index} measured data"), panel.sides(), trace);
    for harmonic in above {
        let value = size(harmonic.measured);
        let Some(place) = panel.at(harmonic.order as f64, value) else { continue };
        canvas.marker(Marker::Circle, place, 3.6, &hint(harmonic));
    }
    canvas.close();
    let trace = Trace { name: "below the plotted range", keys: "below", ..trace };
    canvas.open_inside(&format!("s{index} rest data"), panel.sides(), trace);
    for harmonic in below {
        let Some(x) = panel.x.at(harmonic.order as f64) else { continue };
        canvas.marker(Marker::Beyond, [x, panel.bottom - 6.0], 3.6, &hint(harmonic));
    }
    canvas.close();
}

fn hint(harmonic: &ComparedHarmonic) -> String {
    let [measured, simulated] = [harmonic.measured, harmonic.simulated].map(size);
    let values = [measured, simulated, harmonic.std].map(|value| number(value, 4));
    let [measured, simulated, std] = values;
    format!("k = {}: measured {measured}, simulated {simulated}, std {std}", harmonic.order)
}

fn says(chosen: &[(usize, &ComparedExperiment)], comparison: &Comparison) -> String {
    let share = |e: &ComparedExperiment| {
        let fundamental = e.harmonics.iter().find(|h| h.order == 1).map(|h| size(h.measured))?;
        let others = e.harmonics.iter().filter(|h| h.order > 1).map(|h| size(h.measured).powi(2));
        let share = others.sum::<f64>().sqrt() / fundamental;
        share.is_finite().then_some(share)
    };
    let shares = chosen.iter().filter_map(|(_, e)| Some((share(e)?, *e)));
    match shares.max_by(|a, b| a.0.total_cmp(&b.0)) {
        None => "Nothing moved in these experiments.".to_owned(),
        Some((share, experiment)) => format!(
            "Where they are largest at each magnitude. At {} the harmonics above the first reach \
             {} % of it.",
            magnitude_label(experiment.magnitude, comparison),
            number(100.0 * share, 2)
        ),
    }
}
