//! The experiments of a plan on the plane of frequency and magnitude, and what each effect gains.

use std::f64::consts::TAU;

use servoscope_core::answers::{Plan, PlannedEffect};

use super::canvas::{Anchor, Canvas, MARGIN, Marker, TICK, Trace, WIDTH};
use super::panel::{Key, Look, Naming, Panel, legend};
use super::scale::{DECIMAL, Scale, range};
use super::series::unit_or;
use super::text::{self, number, quantity};
use crate::report::words;

const LEFT: f64 = 64.0;
const HEIGHT: f64 = 260.0;
/// Where the bars of effects begin, and the height of a row.
const BARS: f64 = 190.0;
const ROW: f64 = 20.0;
/// Radius of a point of two repeats, and most.
const RADIUS: f64 = 3.0;
const LARGEST_RADIUS: f64 = 9.0;

pub(super) fn draw(plan: &Plan, input_unit: &str) -> Canvas {
    let says = format!(
        "{} experiments; {} of {} effects are identified with a probability of 90 % or more.",
        plan.experiments.len(),
        plan.nameable,
        plan.effects.len()
    );
    let mut canvas = Canvas::new("plan", "Planned experiments and what they identify", &says, 2);
    legend(
        &mut canvas,
        &[
            Key::new(Look::Marker(Marker::Circle), "s0", "planned; larger with more repeats")
                .toggling("planned"),
            Key::new(Look::Marker(Marker::Diamond), "s1", "logarithmic sweep of the same duration")
                .toggling("sweep"),
        ],
    );
    points(&mut canvas, plan, input_unit);
    effects(&mut canvas, plan);
    canvas
}

/// The plane of frequency and magnitude.
fn points(canvas: &mut Canvas, plan: &Plan, input_unit: &str) {
    let swept = || plan.sweeps.last().into_iter().flat_map(|sweep| &sweep.experiments);
    let all = || plan.experiments.iter().chain(swept());
    let [slow, fast] = range(all().map(|experiment| experiment.omega_rad_s / TAU));
    let [weak, strong] = range(all().map(|experiment| experiment.magnitude));
    let top = canvas.y + 22.0;
    let (right, bottom) = (WIDTH - MARGIN, top + HEIGHT);
    let x = Scale::log([slow / 1.2, fast * 1.2], [LEFT, right]);
    let y = Scale::log([weak / 1.2, strong * 1.2], [bottom, top]);
    let panel = Panel { x, y, left: LEFT, top, right, bottom };
    let unit = text::shorten(unit_or(input_unit, "input units"), 11.5, 100.0);
    let name = format!("Magnitude of the input ({unit})");
    let naming = Naming { x: "Frequency (Hz)", y: &name, ..Naming::default() };
    panel.draw(canvas, &y.vertical_ticks(DECIMAL), naming);
    let groups = [("s1", "sweep", true), ("s0", "planned", false)];
    for (class, name, is_sweep) in groups {
        let trace = Trace { name, keys: name, ..Trace::default() };
        canvas.open_trace(&format!("{class} dense data"), panel.sides(), trace);
        let own: Vec<_> =
            if is_sweep { swept().collect() } else { plan.experiments.iter().collect() };
        for experiment in own {
            let hz = experiment.omega_rad_s / TAU;
            let Some(at) = panel.at(hz, experiment.magnitude) else { continue };
            let serves = experiment.serves.as_deref().map_or_else(String::new, |effect| {
                format!(", mainly for {}", words::effect(effect))
            });
            let hint = format!(
                "{name}, run {}: {} at {} Hz, {} repeats{serves}",
                experiment.run,
                quantity(experiment.magnitude, 3, input_unit),
                number(hz, 3),
                experiment.repeats
            );
            match is_sweep {
                true => canvas.marker(Marker::Diamond, at, RADIUS, &hint),
                false => {
                    let radius = RADIUS * (0.5 * experiment.repeats as f64).sqrt();
                    canvas.marker(Marker::Circle, at, radius.min(LARGEST_RADIUS), &hint);
                }
            }
        }
        canvas.close();
    }
    canvas.y = bottom + 52.0;
}

/// For each effect, the probability that it is named, as planned and by the sweep.
fn effects(canvas: &mut Canvas, plan: &Plan) {
    let mut effects: Vec<&PlannedEffect> = plan.effects.iter().collect();
    effects.sort_by(|a, b| b.score.total_cmp(&a.score));
    let top = canvas.y;
    let (right, bottom) = (WIDTH - MARGIN, top + ROW * effects.len() as f64);
    let x = Scale::linear([0.0, 1.0], [BARS, right]);
    let y = Scale::linear([0.0, effects.len() as f64], [top, bottom]);
    let panel = Panel { x, y, left: BARS, top, right, bottom };
    let name = "Probability that an effect of typical size is identified";
    panel.draw(canvas, &[], Naming { x: name, ..Naming::default() });
    for (index, effect) in effects.iter().enumerate() {
        let y = top + ROW * (index as f64 + 0.5);
        canvas.text(BARS - 8.0, y + 4.0, TICK, Anchor::End, &effect.title);
        if let (Some(from), Some(to)) = (x.at(0.0), x.at(1.0)) {
            canvas.line("grid", [from, y], [to, y]);
        }
        let swept = plan.sweeps.last().and_then(|sweep| sweep.probabilities.get(&effect.effect));
        let marks = [
            ("s1", "sweep", Marker::Diamond, swept.copied(), "by the sweep"),
            ("s0", "planned", Marker::Circle, Some(effect.probability), "as planned"),
        ];
        for (class, keys, shape, share, how) in marks {
            let Some((share, px)) = share.and_then(|share| Some((share, x.at(share)?))) else {
                continue;
            };
            let trace = Trace { name: how, keys, hints: true, ..Trace::default() };
            canvas.open_inside(&format!("{class} measured data"), panel.sides(), trace);
            let hint = format!("{}: {how} {} %", effect.title, number(100.0 * share, 3));
            canvas.marker(shape, [px, y], 4.0, &hint);
            canvas.close();
        }
    }
    canvas.y = bottom + 50.0;
}

#[cfg(test)]
mod tests {
    use servoscope_core::answers::sample;

    use crate::report::figures::{Theme, draw_plan};

    #[test]
    fn a_plan_shows_every_experiment_and_every_effect() {
        let plan = sample::plan();
        let svg = draw_plan(&plan, "N m", Theme::Light);
        roxmltree::Document::parse(&svg).unwrap();
        for effect in &plan.effects {
            assert!(svg.contains(&format!(">{}<", effect.title)), "{svg}");
        }
        let last = plan.experiments.len() - 1;
        assert!(svg.contains(&format!("planned, run {last}: ")), "{svg}");
        assert!(svg.contains("sweep, run 0: "), "{svg}");
        assert!(svg.contains(">Magnitude of the input (N m)<"), "{svg}");
        let unknown = draw_plan(&plan, "", Theme::Light);
        assert!(unknown.contains(">Magnitude of the input (input units)<"), "{unknown}");
    }
}
