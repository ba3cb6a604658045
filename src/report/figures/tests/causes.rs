//! Figures of a model with causes beside those of the identified one.

use servoscope_core::answers::ComparedExperiment;

use super::*;

#[test]
fn the_model_with_its_causes_is_the_line_and_the_base_model_a_thin_one_beside_it() {
    let lines = |svg: &str, class: &str| svg.matches(&format!("class=\"{class}\"")).count();
    let [before, after] = [diagnosed(), extended()].map(|known| known.draw("bode"));
    assert_eq!(lines(&before, "thin"), 0);
    // At each of three magnitudes gain and phase, and in the legend.
    assert_eq!(lines(&after, "thin"), 3 * 2 + 1);
    assert_eq!(lines(&after, "line"), lines(&before, "line"));
    let says = "Simulated with static_friction and actuator_saturation: median error";
    assert!(after.contains(says), "{after}");
    assert!(before.contains("Simulated: median error of the gain"), "{before}");
}

#[test]
fn what_is_drawn_after_is_the_model_with_the_causes() {
    let known = extended();
    let Some(extended) = known.extended.clone() else { panic!("it is extended") };
    for name in ["spectrum", "residuals", "friction"] {
        let after = known.draw(&format!("{name}-after"));
        // Its title alone says which model it is of.
        let unnamed = after.replace(": with static_friction and actuator_saturation", "");
        assert_eq!(unnamed, Known::of(extended.clone()).draw(name));
        assert!(unnamed != after || name == "friction", "{name}");
    }
    assert_ne!(known.draw("residuals-after"), known.draw("residuals"));
    let without = Known::of(sample::comparison());
    let error = draw("friction-after", &without.subject(), Theme::Auto).unwrap_err();
    assert!(error.to_string().contains("a model with causes"), "{error}");
}

#[test]
fn errors_are_drawn_before_and_after_with_the_noise_and_the_bands_that_are_not_valid() {
    let mut known = extended();
    let svg = known.draw("bode-errors");
    for part in ["error before", "error after", "noise, ± 2σ", "class=\"noise\""] {
        assert!(svg.contains(part), "{part}");
    }
    assert!(!svg.contains("model not valid"), "{svg}");
    known.valid_band = sample::diagnosis().valid_band;
    let svg = known.draw("bode-errors");
    // In both columns, the response and its error.
    assert_eq!(svg.matches("class=\"invalid\"").count(), 1 + 4, "{svg}");
    assert!(svg.contains("model not valid"));
    // The first point of the first magnitude, as the figure has it and as it is.
    let mut experiments: Vec<&ComparedExperiment> = known.comparison.experiments.iter().collect();
    experiments.sort_by(|a, b| {
        a.magnitude.total_cmp(&b.magnitude).then(a.omega_rad_s.total_cmp(&b.omega_rad_s))
    });
    let first = experiments[0].harmonics.iter().find(|harmonic| harmonic.order == 1).unwrap();
    let size = |[re, im]: [f64; 2]| re.hypot(im);
    let expected = 20.0 * (size(first.measured) / size(first.simulated)).log10();
    let document = Document::parse(&svg).unwrap();
    let before =
        document.descendants().find(|node| node.attribute("data-name") == Some("error before"));
    let path = before.unwrap().first_element_child().unwrap().attribute("d").unwrap();
    let panel = before.unwrap().attribute("data-in").unwrap();
    let grid = document.descendants().find(|node| node.attribute("data-panel") == Some(panel));
    let scale: Vec<f64> = grid.unwrap().attribute("data-y").unwrap()["linear ".len()..]
        .split(' ')
        .map(|number| number.parse().unwrap())
        .collect();
    let first: f64 = path[1..].split(['L', ' ']).nth(1).unwrap().parse().unwrap();
    let share = (first - scale[2]) / (scale[3] - scale[2]);
    let decibels = scale[0] + share * (scale[1] - scale[0]);
    // A tenth of a pixel of 132 for the whole axis.
    let pixel = (scale[1] - scale[0]) / 1320.0;
    assert!((decibels - expected).abs() < pixel, "{decibels} dB, not {expected} dB");
}
