//! How the identification converged, stage by stage.

use servoscope_core::answers::{self, ConvergenceRow};

use super::canvas::{self, Canvas, MARGIN, Marker, WIDTH};
use super::panel::{Key, Look, Naming, Panel, legend};
use super::scale::{DECIMAL, Scale, range};
use super::series::counted;
use super::text::number;
use super::{NothingToDraw, Subject};

/// The stage whose rows are losses of a network, not costs of a model.
const NETWORK: &str = "network";

/// Panels side by side.
const COLUMNS: usize = 3;

const LEFT: f64 = 64.0;
const HEIGHT: f64 = 250.0;
const GAP: f64 = 56.0;

/// Decades shown above the smallest of the costs that count: the first points
/// of a search may be wrong beyond measure.
const MOST_DECADES: f64 = 9.0;

/// Costs from here on stand for a model without a response.
const NO_RESPONSE: f64 = 1e100;

/// Rows of one stage at one actuator order.
struct Trace<'a> {
    order: usize,
    rows: Vec<&'a ConvergenceRow>,
}

/// A stage, whatever the order.
struct Stage<'a> {
    name: &'a str,
    traces: Vec<Trace<'a>>,
}

pub(super) fn draw(subject: &Subject<'_>) -> Result<Canvas, NothingToDraw> {
    if subject.convergence.is_empty() {
        return Err(NothingToDraw("there is no history of how it converged".into()));
    }
    let (orders, stages) = stages(subject.convergence);
    let chi2 = subject.identification.is_some_and(|answer| answer.fit.chi2.is_some());
    let mut canvas =
        Canvas::new("convergence", "Convergence by stage", &says(subject), orders.len());
    let mut keys: Vec<Key> = orders
        .iter()
        .enumerate()
        .map(|(i, order)| {
            let text = if order.is_empty() {
                "best so far".to_owned()
            } else {
                format!("best so far, {order}")
            };
            Key::new(Look::Line("line"), format!("s{i}"), text).toggling(format!("s{i}"))
        })
        .collect();
    let has_means =
        stages.iter().flat_map(|s| &s.traces).flat_map(|t| &t.rows).any(|row| row.mean.is_some());
    if has_means {
        let text = "mean of the population, training loss of the network";
        keys.push(Key::new(Look::Line("thin"), "key", text).toggling("mean"));
    }
    let dof = subject.identification.filter(|_| chi2).map(|a| a.fit.dof as f64);
    if dof.is_some_and(|dof| dof > 0.0) {
        let noise = Key::new(Look::Line("floor"), "key", "cost of noise alone");
        keys.push(noise.toggling("noise"));
    }
    if let Some(stage) = stages.iter().find(|stage| is_point(stage)) {
        let text = capitalised(stage.name).to_lowercase();
        keys.push(Key::new(Look::Marker(Marker::Diamond), "key", text).toggling("start"));
    }
    legend(&mut canvas, &keys);
    let cost = if chi2 { "Cost χ²" } else { "Cost" };
    panels(&mut canvas, &stages, cost, dof.filter(|dof| *dof > 0.0));
    Ok(canvas)
}

/// The orders that rows name, and the rows by stage and order, as they come.
fn stages(rows: &[ConvergenceRow]) -> (Vec<&str>, Vec<Stage<'_>>) {
    let mut orders: Vec<&str> = Vec::new();
    let mut stages: Vec<Stage<'_>> = Vec::new();
    for row in rows {
        // Where several orders are tried, a stage says in its name which it is of.
        let (name, order) = match row.stage.split_once(" (") {
            Some((name, order)) => (name, order.trim_end_matches(')')),
            None => (row.stage.as_str(), ""),
        };
        let order = orders.iter().position(|known| *known == order).unwrap_or_else(|| {
            orders.push(order);
            orders.len() - 1
        });
        let stage = stages.iter().position(|stage| stage.name == name).unwrap_or_else(|| {
            stages.push(Stage { name, traces: Vec::new() });
            stages.len() - 1
        });
        let traces = &mut stages[stage].traces;
        match traces.iter_mut().find(|trace| trace.order == order) {
            Some(trace) => trace.rows.push(row),
            None => traces.push(Trace { order, rows: vec![row] }),
        }
    }
    (orders, stages)
}

/// Whether a stage is a single evaluation: a point, shown where the next begins.
fn is_point(stage: &Stage<'_>) -> bool {
    stage.name != NETWORK && stage.traces.iter().all(|trace| trace.rows.len() == 1)
}

fn panels(canvas: &mut Canvas, stages: &[Stage<'_>], cost: &str, noise: Option<f64>) {
    let (points, panels): (Vec<&Stage<'_>>, Vec<_>) = stages.iter().partition(|s| is_point(s));
    let (points, panels) = if panels.iter().any(|stage| stage.name != NETWORK) {
        (points, panels)
    } else {
        (Vec::new(), stages.iter().collect())
    };
    let costs = stages.iter().filter(|s| s.name != NETWORK).flat_map(|s| &s.traces);
    let costs = costs.flat_map(|t| &t.rows).map(|row| row.best).chain(noise);
    let costs = limits(costs);
    let columns = panels.len().clamp(1, COLUMNS);
    let width = (WIDTH - MARGIN - LEFT - GAP * (columns as f64 - 1.0)) / columns as f64;
    let start = canvas.y + 38.0;
    let mut first_cost = true;
    for (place, stage) in panels.iter().enumerate() {
        let left = LEFT + (place % columns) as f64 * (width + GAP);
        let top = start + (place / columns) as f64 * (HEIGHT + 92.0);
        let (right, bottom) = (left + width, top + HEIGHT);
        let is_network = stage.name == NETWORK;
        let rows = || stage.traces.iter().flat_map(|t| &t.rows);
        let position: fn(&ConvergenceRow) -> f64 =
            if is_network { |row| row.cycle as f64 } else { |row| row.evaluations as f64 };
        let [low, high] = range(rows().map(|row| position(row)));
        let sizes = match is_network {
            true => limits(rows().flat_map(|row| [Some(row.best), row.mean]).flatten()),
            false => costs,
        };
        let x = Scale::linear([low.min(0.0), high], [left, right]);
        let y = Scale::log(sizes, [bottom, top]);
        let panel = Panel { x, y, left, top, right, bottom };
        let heading = capitalised(stage.name);
        let (x_name, y_name) = match is_network {
            true => ("Epoch", "Held-out loss"),
            false => ("Simulations in the stage", cost),
        };
        let naming = Naming { heading: &heading, x: x_name, y: y_name, ..Naming::default() };
        panel.draw(canvas, &y.vertical_ticks(DECIMAL), naming);
        traces(canvas, &panel, stage, position, noise.filter(|_| !is_network));
        if !is_network && first_cost {
            first_cost = false;
            starts(canvas, &panel, &points);
        }
        canvas.y = bottom + 44.0;
    }
}

fn traces(
    canvas: &mut Canvas,
    panel: &Panel,
    stage: &Stage<'_>,
    position: fn(&ConvergenceRow) -> f64,
    noise: Option<f64>,
) {
    canvas.open_trace("", panel.sides(), canvas::Trace::keyed("noise"));
    if let Some(y) = noise.and_then(|noise| panel.y.at(noise)) {
        canvas.line("floor", [panel.left, y], [panel.right, y]);
    }
    canvas.close();
    for Trace { order, rows } in &stage.traces {
        let rows = thinned(rows);
        // A stage that runs again begins a line of its own.
        let begins: Vec<bool> =
            (0..rows.len()).map(|i| i > 0 && position(rows[i]) < position(rows[i - 1])).collect();
        let (class, series) = (format!("s{order}"), format!("order {order}"));
        let both = format!("mean {class}");
        let named = |name, keys| canvas::Trace { series: &series, name, keys, hints: false };
        canvas.open_trace(&class, panel.sides(), named("mean", &both));
        let mean = rows.iter().map(|row| panel.at(position(row), row.mean?));
        canvas.polyline("thin", mean.zip(&begins).flat_map(broken));
        canvas.close();
        canvas.open_trace(&class, panel.sides(), named("best", &class));
        let best = rows.iter().map(|row| panel.at(position(row), row.best));
        canvas.polyline("line", best.zip(&begins).flat_map(broken));
        canvas.close();
    }
    for Trace { order, rows } in &stage.traces {
        let Some(last) = rows.last() else { continue };
        let Some([x, y]) = panel.at(position(last), last.best) else { continue };
        let inside = [x, y.clamp(panel.top, panel.bottom)];
        let keys = format!("s{order}");
        let class = format!("{keys} measured");
        canvas.open_inside(&class, panel.sides(), canvas::Trace::keyed(&keys));
        let hint = format!("{}: {}", last.stage, number(last.best, 5));
        canvas.marker(Marker::Circle, inside, 3.4, &hint);
        canvas.close();
    }
}

/// A point of a line, after a break where the line begins anew.
fn broken((point, begins): (Option<[f64; 2]>, &bool)) -> impl Iterator<Item = Option<[f64; 2]>> {
    begins.then_some(None).into_iter().chain([point])
}

/// Where the search begins: a stage that is one evaluation.
fn starts(canvas: &mut Canvas, panel: &Panel, points: &[&Stage<'_>]) {
    for Trace { order, rows } in points.iter().flat_map(|stage| &stage.traces) {
        let Some([x, y]) = rows.last().and_then(|row| panel.at(0.0, row.best)) else { continue };
        let keys = format!("start s{order}");
        let class = format!("s{order} measured");
        canvas.open_inside(&class, panel.sides(), canvas::Trace::keyed(&keys));
        let y = y.clamp(panel.top, panel.bottom);
        canvas.marker(Marker::Diamond, [x, y], 4.0, "closed form");
        canvas.close();
    }
}

/// At most about a thousand rows: more than there are pixels say no more.
fn thinned<'a>(rows: &[&'a ConvergenceRow]) -> Vec<&'a ConvergenceRow> {
    let stride = rows.len().div_ceil(1000).max(1);
    let last = rows.len().saturating_sub(1);
    let kept = rows.iter().enumerate().filter(|(i, _)| i % stride == 0 || *i == last);
    kept.map(|(_, row)| *row).collect()
}

/// A logarithmic range of costs with some space around them.
fn limits(values: impl Iterator<Item = f64>) -> [f64; 2] {
    let [low, high] = range(values.filter(|value| *value > 0.0 && *value < NO_RESPONSE));
    let high = high.min(low * 10.0_f64.powf(MOST_DECADES));
    let space = (high / low).powf(0.06).max(1.05);
    [low / space, high * space]
}

fn capitalised(name: &str) -> String {
    let name = name.replace('_', " ");
    let mut characters = name.chars();
    characters
        .next()
        .map_or_else(String::new, |first| first.to_uppercase().chain(characters).collect())
}

fn says(subject: &Subject<'_>) -> String {
    let Some(answer) = subject.identification else {
        return "Best cost so far in each stage; the stages follow each other.".to_owned();
    };
    let evaluations = answers::Stage::evaluations_of(&answer.stages);
    let seconds: f64 = answer.stages.iter().map(|stage| stage.seconds).sum();
    let order = answer.order_choice.as_ref();
    let taken = order
        .map_or_else(String::new, |o| format!(" Actuator order {} was taken.", o.actuator_order));
    format!(
        "{} in {} s; ended: {}.{taken}",
        counted(evaluations as usize, "simulation", "simulations"),
        number(seconds, 2),
        answer.stop_reason
    )
}
