//! Records of many lines: amplitude over frequency, one panel a record.

use servoscope_core::answers::{ComparedExperiment, ComparedHarmonic, Comparison};

use super::super::canvas::{Canvas, MARGIN, Marker, Trace, WIDTH};
use super::super::panel::{Key, Look, Naming, Panel, legend};
use super::super::scale::{DECIMAL, Scale, range};
use super::super::series::{excited, experiment_label, frequency_hz, left_out, size, spread};
use super::super::{NothingToDraw, Subject};
use super::{LEFT, MOST_PANELS, amplitude_name, amplitudes};

/// Amplitude over frequency, one panel a record.
pub(super) fn records(
    subject: &Subject<'_>,
    comparison: &Comparison,
) -> Result<Canvas, NothingToDraw> {
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
    keys.extend(super::keys(comparison).pop());
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
