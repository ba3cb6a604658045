//! Harmonics of the response, measured, simulated and the noise between them.

use servoscope_core::answers::{ComparedExperiment, ComparedHarmonic, Comparison};

use super::canvas::{Canvas, MARGIN, Marker, TICK, Trace, WIDTH};
use super::panel::{Key, Look, Naming, Panel, legend};
use super::scale::{DECIMAL, Scale, Tick, range};
use super::series::{
    by_magnitude, excited, experiment_label, frequency_hz, has_many_lines, left_out,
    magnitude_label, size, spread, unit_or,
};
use super::text::{self, number};
use super::{NothingToDraw, Subject, comparison};

/// Panels at most: a few representative experiments say more than all.
const MOST_PANELS: usize = 4;

/// Decades shown below the largest amplitude, at most.
const MOST_DECADES: f64 = 10.0;

const LEFT: f64 = 64.0;

pub(super) fn draw(subject: &Subject<'_>) -> Result<Canvas, NothingToDraw> {
    let comparison = comparison(subject)?;
    if has_many_lines(comparison) {
        records(subject, comparison)
    } else {
        stepped(subject, comparison)
    }
}

/// Amplitudes from the largest down to a third of the noise or of the smallest.
fn amplitudes<'a>(harmonics: impl Iterator<Item = &'a ComparedHarmonic>) -> [f64; 2] {
    let (mut high, mut low): (f64, f64) = (0.0, f64::INFINITY);
    for harmonic in harmonics {
        let [measured, simulated] = [harmonic.measured, harmonic.simulated].map(size);
        high = high.max(measured).max(simulated);
        let sizes = [measured, simulated, harmonic.std];
        low = sizes.into_iter().filter(|value| *value > 0.0).fold(low, f64::min);
    }
    if high > 0.0 {
        [(low / 2.0).max(high * 10.0_f64.powf(-MOST_DECADES)), high * 2.0]
    } else {
        [0.1, 10.0]
    }
}

fn amplitude_name(comparison: &Comparison) -> String {
    let unit = unit_or(&comparison.response_unit, "response units");
    text::shorten(&format!("Amplitude ({unit})"), 11.5, 200.0)
}

fn keys(comparison: &Comparison) -> Vec<Key> {
    let noise =
        if comparison.std_estimated { "std, estimated from the residual" } else { "noise (std)" };
    vec![
        Key::new(Look::Marker(Marker::Circle), "key", "measured").toggling("measured"),
        Key::new(Look::Line("bar"), "key", "simulated").toggling("simulated"),
        Key::new(Look::Line("floor"), "key", noise).toggling("noise"),
    ]
}

/// One panel a magnitude: the experiment whose harmonics are largest.
fn stepped(subject: &Subject<'_>, comparison: &Comparison) -> Result<Canvas, NothingToDraw> {
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

/// Amplitude over frequency, one panel a record.
fn records(subject: &Subject<'_>, comparison: &Comparison) -> Result<Canvas, NothingToDraw> {
    let mut shown: Vec<&ComparedExperiment> = comparison.experiments.iter().collect();
    shown.sort_by(|a, b| a.magnitude.total_cmp(&b.magnitude));
    let all = shown.len();
    let shown: Vec<&ComparedExperiment> =
        spread(all, MOST_PANELS - 1).into_iter().map(|i| shown[i]).collect();
    let lines: usize = shown.iter().map(|e| e.harmonics.len()).sum();
    let input: usize = shown.iter().map(|e| excited(e).len()).sum();
    let subtitle = format!(
        "{lines} harmonics, {input} of them lines of the input; the others show what is not linear."
    );
    let mut canvas =
        Canvas::new("spectrum", &subject.titled("Spectrum of the response"), &subtitle, 2);
    let mut keys = vec![
        Key::new(Look::Marker(Marker::Circle), "s1", "measured at lines of the input")
            .toggling("input"),
        Key::new(Look::Marker(Marker::Circle), "s0", "at other harmonics").toggling("other"),
        Key::new(Look::Line("line"), "s1", "simulated").toggling("simulated"),
    ];
    keys.extend(self::keys(comparison).pop());
    legend(&mut canvas, &keys);
    for experiment in shown {
        record(&mut canvas, comparison, experiment, all > 1);
    }
    if let Some(sentence) = left_out(comparison) {
        canvas.note(&sentence);
    }
    Ok(canvas)
}

fn record(
    canvas: &mut Canvas,
    comparison: &Comparison,
    experiment: &ComparedExperiment,
    several: bool,
) {
    // The mean has no place on a logarithmic axis of frequency.
    let shown: Vec<&ComparedHarmonic> =
        experiment.harmonics.iter().filter(|h| h.order > 0).collect();
    let [low, high] = range(shown.iter().map(|h| frequency_hz(experiment, h.order)));
    let top = canvas.y + if several { 38.0 } else { 22.0 };
    let bottom = top + if several { 220.0 } else { 330.0 };
    let (left, right) = (LEFT, WIDTH - MARGIN);
    let x = Scale::log([low / 1.1, high * 1.1], [left, right]);
    let y = Scale::log(amplitudes(shown.iter().copied()), [bottom, top]);
    let panel = Panel { x, y, left, top, right, bottom };
    let heading = match several {
        true => experiment_label(experiment, comparison),
        false => String::new(),
    };
    let name = amplitude_name(comparison);
    let naming = Naming { heading: &heading, x: "Frequency (Hz)", y: &name, ..Naming::default() };
    panel.draw(canvas, &y.vertical_ticks(DECIMAL), naming);
    let place =
        |h: &ComparedHarmonic, value: f64| panel.at(frequency_hz(experiment, h.order), value);
    let lines = excited(experiment);
    let is_line = |h: &ComparedHarmonic| lines.iter().any(|line| line.order == h.order);
    let (input, other): (Vec<&ComparedHarmonic>, Vec<_>) = shown.iter().partition(|h| is_line(h));
    for (class, look, harmonics) in [("s0", "faint", &other), ("s1", "line", &input)] {
        let trace = Trace { name: "simulated", keys: "simulated", ..Trace::default() };
        canvas.open_trace(class, panel.sides(), trace);
        let line = with_gaps(harmonics).map(|h| h.and_then(|h| place(h, size(h.simulated))));
        canvas.polyline(look, line);
        canvas.close();
    }
    let radius = if shown.len() > 300 { 1.7 } else { 2.4 };
    for (class, keys, harmonics) in [("s0", "other", other), ("s1", "input", input)] {
        let trace = Trace { name: "measured", keys, ..Trace::default() };
        canvas.open_trace(&format!("{class} dense data"), panel.sides(), trace);
        for harmonic in harmonics {
            if let Some(at) = place(harmonic, size(harmonic.measured)) {
                canvas.marker(Marker::Circle, at, radius, "");
            }
        }
        canvas.close();
    }
    canvas.open_trace("", panel.sides(), Trace::keyed("noise"));
    canvas.polyline("floor", shown.iter().map(|h| place(h, h.std)));
    canvas.close();
    canvas.y = bottom + 44.0;
}

/// Harmonics with a break where many in a row are missing: a line across would
/// claim what nobody simulated.
fn with_gaps<'a>(
    harmonics: &[&'a ComparedHarmonic],
) -> impl Iterator<Item = Option<&'a ComparedHarmonic>> {
    let mut previous: Option<usize> = None;
    harmonics.iter().flat_map(move |harmonic| {
        let gap = previous.is_some_and(|before| harmonic.order > before + 4 + before / 4);
        previous = Some(harmonic.order);
        gap.then_some(None).into_iter().chain([Some(*harmonic)])
    })
}
