//! What holds for every figure, whatever it is drawn of.

mod causes;

use roxmltree::{Document, Node};
use servoscope_core::answers::sample;

use super::fixtures::{Known, diagnosed, extended, extremes, record, stepped};
use super::{Subject, Theme, available, draw, draw_for_phone, names, text};

/// The largest file, bytes: what a page of several figures may weigh.
const MOST_BYTES: usize = 300_000;

/// Calls `check` with every figure that can be drawn of every extreme.
fn every_figure(check: impl Fn(&str, &str, &Document<'_>)) {
    for (case, known) in extremes() {
        for name in available(&known.subject()) {
            let svg = known.draw(name);
            let parsed = Document::parse(&svg);
            check(case, &svg, &parsed.unwrap_or_else(|error| panic!("{case}, {name}: {error}")));
        }
        if let Ok(svg) = draw_for_phone(&known.subject(), Theme::Auto.into()) {
            check(case, &svg, &Document::parse(&svg).unwrap());
        }
    }
}

fn texts<'a>(document: &'a Document<'a>) -> impl Iterator<Item = Node<'a, 'a>> {
    document.descendants().filter(|node| node.has_tag_name("text"))
}

fn number(node: &Node<'_, '_>, attribute: &str) -> f64 {
    node.attribute(attribute).unwrap().parse().unwrap()
}

/// Left, top, right and bottom of a text, from its estimated width.
fn text_box(node: &Node<'_, '_>) -> [f64; 4] {
    let [x, y, size] = ["x", "y", "font-size"].map(|attribute| number(node, attribute));
    let width = text::width(node.text().unwrap_or_default(), size);
    let left = match node.attribute("text-anchor") {
        Some("middle") => x - 0.5 * width,
        Some("end") => x - width,
        _ => x,
    };
    [left, y - 0.75 * size, left + width, y + 0.2 * size]
}

/// Markers of measured points: those in groups of data.
fn markers(document: &Document<'_>) -> usize {
    let is_data =
        |node: &Node<'_, '_>| node.attribute("class").is_some_and(|c| c.ends_with("data"));
    let groups = document.descendants().filter(is_data);
    groups.map(|group| group.children().filter(Node::is_element).count()).sum()
}

#[test]
fn every_figure_is_well_formed_and_says_what_it_is() {
    every_figure(|case, svg, document| {
        let root = document.root_element();
        assert_eq!(root.attribute("role"), Some("img"), "{case}");
        let labels = root.attribute("aria-labelledby").unwrap();
        for id in labels.split(' ') {
            let node = document.descendants().find(|node| node.attribute("id") == Some(id));
            assert!(node.is_some_and(|node| !node.text().unwrap_or_default().is_empty()), "{id}");
        }
        for word in ["NaN", "inf", "<script", "http://", "https://", "@import"] {
            let found = svg.replace("http://www.w3.org/2000/svg", "").contains(word);
            assert!(!found, "{case}: {word}");
        }
    });
}

#[test]
fn no_text_meets_another_or_leaves_the_figure() {
    let wrong = std::cell::RefCell::new(Vec::new());
    every_figure(|case, _, document| {
        let name = document.root_element().attribute("id").unwrap();
        let [width, height] =
            ["width", "height"].map(|side| number(&document.root_element(), side));
        let boxes: Vec<([f64; 4], &str)> =
            texts(document).map(|node| (text_box(&node), node.text().unwrap_or(""))).collect();
        for (i, ([left, top, right, bottom], text)) in boxes.iter().enumerate() {
            let inside = *left >= 0.0 && *top >= 0.0 && *right <= width && *bottom <= height;
            if !inside {
                wrong.borrow_mut().push(format!("{case}, {name}: `{text}` leaves the figure"));
            }
            for ([l, t, r, b], other) in &boxes[..i] {
                let meet = left < r && l < right && top < b && t < bottom;
                if meet {
                    wrong.borrow_mut().push(format!("{case}, {name}: `{text}` meets `{other}`"));
                }
            }
        }
    });
    assert!(wrong.borrow().is_empty(), "{:#?}", wrong.borrow());
}

#[test]
fn every_axis_says_its_unit() {
    let axes: [(&str, &[&str]); 7] = [
        ("bode", &["Gain (dB re 1 (rad/s)/A)", "Phase (degrees)", "Frequency (Hz)"]),
        ("bode-errors", &["Error of the gain (dB)", "Error of the phase (degrees)"]),
        ("linearity", &["Amplitude (rad/s)", "Frequency (Hz)"]),
        ("spectrum", &["Amplitude (rad/s)", "Harmonic k"]),
        ("residuals", &["|residual| (σ)", "Harmonic k", "Frequency of the input (Hz)"]),
        ("convergence", &["Held-out loss", "Cost χ²", "Epoch"]),
        ("friction", &["Friction (A)", "Velocity (rad/s)"]),
    ];
    // What is drawn after is drawn alike.
    let drawn = names().filter(|name| !name.ends_with("-after"));
    assert!(axes.iter().map(|(name, _)| *name).eq(drawn));
    let known = diagnosed();
    for (name, labels) in axes {
        let svg = known.draw(name);
        let document = Document::parse(&svg).unwrap();
        for label in labels {
            let found = texts(&document).any(|node| node.text() == Some(label));
            assert!(found, "{name}: {label}");
        }
    }
}

#[test]
fn every_measured_point_is_a_marker_at_rest_or_moving() {
    let counted = |known: &Known, name: &str| {
        let svg = known.draw(name);
        markers(&Document::parse(&svg).unwrap())
    };
    // 18 experiments of one line each, in gain and in phase.
    assert_eq!(counted(&diagnosed(), "bode"), 2 * 18);
    // What rests has no phase.
    let mut stuck = diagnosed();
    stuck.comparison.experiments[7].harmonics.iter_mut().for_each(|h| h.measured = [0.0; 2]);
    assert_eq!(counted(&stuck, "bode"), 2 * 17 + 1);
    // Three magnitudes, harmonics 0 to 3.
    assert_eq!(counted(&stuck, "spectrum"), 3 * 4);
    // Excited: 550 of the harmonics 1 to 1100; the mean has no place on a log axis.
    assert_eq!(counted(&record(), "spectrum"), 1100);
    assert_eq!(counted(&record(), "residuals"), 1100);
    let svg = stepped().draw("residuals");
    let document = Document::parse(&svg).unwrap();
    let cells = document.descendants().find(|n| n.attribute("class") == Some("cells"));
    let blocks = document.descendants().filter(|n| n.attribute("class") == Some("cells"));
    assert!(cells.is_some());
    assert_eq!(blocks.map(|b| b.children().count()).sum::<usize>(), 48 * 9);
}

#[test]
fn the_largest_records_stay_below_the_limit() {
    for known in [record(), stepped()] {
        for name in available(&known.subject()) {
            let bytes = known.draw(name).len();
            assert!(bytes < MOST_BYTES, "{name}: {bytes} bytes");
        }
    }
}

#[test]
fn patterns_are_numbered_in_the_map_and_explained_below() {
    let svg = diagnosed().draw("residuals");
    let document = Document::parse(&svg).unwrap();
    for (number, count) in [("1", 2), ("2", 4), ("3", 3)] {
        let badges = texts(&document).filter(|node| {
            node.attribute("class") == Some("badge-text") && node.text() == Some(number)
        });
        // In every block of the map it reaches into, and beside its sentence.
        assert_eq!(badges.count(), count, "{number}");
    }
    assert!(svg.contains("It grows with the run."));
}

#[test]
fn a_theme_that_is_forced_leaves_no_choice_to_the_reader() {
    let known = diagnosed();
    let [auto, light, dark] = [Theme::Auto, Theme::Light, Theme::Dark]
        .map(|theme| draw("bode", &known.subject(), theme).unwrap());
    assert!(auto.contains("prefers-color-scheme:dark"));
    for forced in [&light, &dark] {
        assert!(!forced.contains("prefers-color-scheme"));
    }
    assert_ne!(light, dark);
}

#[test]
fn what_is_missing_is_said_and_what_can_be_drawn_is_listed() {
    let known = diagnosed();
    let only_history = Subject { convergence: &known.convergence, ..Subject::default() };
    assert_eq!(available(&only_history), ["convergence"]);
    let all = Known { discrepancy: known.discrepancy.clone(), ..extended() };
    assert_eq!(available(&all.subject()), names().collect::<Vec<_>>());
    let error = draw("bode", &only_history, Theme::Auto).unwrap_err().to_string();
    assert!(error.contains("compares measured with simulated"), "{error}");
    assert!(draw("pie", &known.subject(), Theme::Auto).is_err());
}

#[test]
fn static_levels_and_a_mean_level_are_shown_where_they_are_known() {
    let mut known = diagnosed();
    let level = known.identification.parameters["fc_plus"].clone();
    known.identification.parameters.insert("fs_plus".into(), level.clone());
    assert!(known.draw("friction").contains("static level"));
    known.identification.parameters.retain(|name, _| !name.starts_with('f'));
    known.identification.parameters.insert("fc_mean".into(), level);
    assert!(known.draw("friction").contains("only the mean"));
    known.identification.parameters.shift_remove("fc_mean");
    assert!(draw("friction", &known.subject(), Theme::Auto).is_err());
}

#[test]
fn what_moves_with_axes_lies_in_a_panel_that_says_what_they_are() {
    let mut panels = 0;
    for known in [extended(), diagnosed()] {
        for name in available(&known.subject()) {
            let svg = known.draw(name);
            let document = Document::parse(&svg).unwrap();
            let with = |key: &'static str| {
                let found = document.descendants().filter_map(move |node| node.attribute(key));
                found.collect::<Vec<_>>()
            };
            let sides = with("data-panel");
            for inside in with("data-in") {
                assert!(sides.contains(&inside), "{name}: {inside} is in no panel of {sides:?}");
            }
            for scale in with("data-x").into_iter().chain(with("data-y")) {
                let (kind, numbers) = scale.split_once(' ').unwrap();
                assert!(["log", "linear", "rows"].contains(&kind), "{name}: {scale}");
                let numbers: Vec<f64> = numbers.split(' ').map(|n| n.parse().unwrap()).collect();
                assert!(numbers.len() == 4 && numbers[0] < numbers[1], "{name}: {scale}");
            }
            let toggled = with("data-toggle");
            let traces: std::collections::BTreeSet<String> =
                with("data-name").into_iter().map(Into::into).collect();
            // The map of residuals has no legend: its rows are named beside them.
            let several = traces.len() > 1 && !name.starts_with("residuals");
            assert!(!several || !toggled.is_empty(), "{name}: {traces:?} cannot be hidden");
            let keys: Vec<&str> = with("data-keys").iter().flat_map(|k| k.split(' ')).collect();
            for key in toggled {
                assert!(keys.contains(&key), "{name}: nothing is shown or hidden by {key}");
            }
            panels += sides.len();
        }
    }
    assert!(panels > 10, "{panels}");
}
