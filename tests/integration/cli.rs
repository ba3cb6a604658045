//! The command line.

use std::process::Output;

use serde_json::Value;

use crate::process::{servoscope, simulated};

fn code(output: &Output) -> Option<i32> {
    output.status.code()
}

fn error(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).unwrap()
}

#[test]
fn bad_usage_ends_with_2() {
    for arguments in [
        &["identify"][..],
        &["divine"],
        &["serve", "--listen", "here"],
        &["identify", "--seed", "x", "f"],
    ] {
        assert_eq!(code(&servoscope(arguments)), Some(2), "{arguments:?}");
    }
    assert_eq!(code(&servoscope(&["--help"])), Some(0));
}

#[test]
fn a_file_that_is_not_there_ends_with_2_and_its_name() {
    let output = servoscope(&["identify", "nowhere.csv"]);
    assert_eq!(code(&output), Some(2));
    assert_eq!(error(&output), "servoscope: nowhere.csv: there is no such file\n");
    assert!(output.stdout.is_empty());
}

#[test]
fn what_is_unknown_is_refused_with_what_is_known() {
    let cases = [
        (
            ["--method", "magic"],
            "abc-ann, pso-ann, aga-ann, ga-ann, two-magnitude, least-squares, cma-es",
        ),
        (["--actuator-order", "3"], "0, 1, 2"),
        (["--options", "{\"sead\": 1}"], "`seed`"),
        (["--options", "{"], "--options: this is not JSON: EOF while parsing an object at line 1"),
        (["--noise-std", "0"], "positive"),
    ];
    for (flag, known) in cases {
        let output = servoscope(&["identify", flag[0], flag[1], "nowhere.csv"]);
        assert_eq!(code(&output), Some(2), "{flag:?}");
        assert!(error(&output).contains(known), "{flag:?}: {}", error(&output));
    }
}

/// A folder with a noisy measurement of the first system of the paper, and its path.
fn noisy() -> (tempfile::TempDir, String) {
    let directory = tempfile::tempdir().unwrap();
    let file = directory.path().join("g1.csv").to_str().unwrap().to_owned();
    let output = servoscope(&["simulate", "--noise-db", "60", "--output", &file]);
    assert_eq!(code(&output), Some(0), "{}", error(&output));
    assert!(output.stdout.is_empty());
    (directory, file)
}

#[test]
fn identify_prints_the_result_object_alone_on_standard_output() {
    let (_directory, file) = noisy();
    let arguments = ["identify", &file, "--json", "--actuator-order", "0", "--seed", "3"];
    let output = servoscope(&arguments);
    assert_eq!(code(&output), Some(0), "{}", error(&output));
    let result: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(result["seed"], 3);
    assert_eq!(result["noise"], "given");
    assert_eq!(result["fit"]["adequate"], true, "{}", result["fit"]);
    for (name, truth) in [("pole", -10.0), ("constant", 10.0), ("fc_plus", 0.5), ("fc_minus", 0.4)]
    {
        let parameter = &result["parameters"][name];
        let [value, std] = ["value", "std"].map(|key| parameter[key].as_f64().unwrap());
        // The seed of the noise is fixed; beyond four deviations the deviation is wrong.
        assert!((value - truth).abs() < 4.0 * std, "{name}: {value} ± {std}, not {truth}");
        assert!(std < 1e-3 * truth.abs(), "{name}: {std} at 60 dB");
    }
}

#[test]
fn identify_draws_its_figures_into_a_folder_and_says_which() {
    let (directory, file) = noisy();
    let figures = directory.path().join("drawn").join("here");
    let folder = figures.to_str().unwrap();
    let arguments = ["identify", &file, "--actuator-order", "0", "--figures", folder, "--json"];
    let output = servoscope(&[&arguments[..], &["--theme", "light"]].concat());
    assert_eq!(code(&output), Some(0), "{}", error(&output));
    assert!(serde_json::from_slice::<Value>(&output.stdout).is_ok());
    for name in ["bode", "spectrum", "residuals", "convergence", "friction"] {
        let path = figures.join(format!("{name}.svg"));
        assert!(error(&output).contains(path.to_str().unwrap()), "{}", error(&output));
        let svg = std::fs::read_to_string(path).unwrap();
        assert!(svg.starts_with("<svg") && !svg.contains("prefers-color-scheme"), "{name}");
    }
    let sepia = servoscope(&["identify", &file, "--figures", folder, "--theme", "sepia"]);
    assert_eq!(code(&sepia), Some(2));
    assert!(error(&sepia).contains("auto, light, dark"), "{}", error(&sepia));
}

#[test]
fn whoever_closes_the_pipe_ends_no_command_with_an_error() {
    let program = env!("CARGO_BIN_EXE_servoscope");
    let script = format!("({program} openapi; echo $? >&2) | head -c 10 >/dev/null");
    let output = std::process::Command::new("sh").args(["-c", &script]).output().unwrap();
    assert_eq!(error(&output).trim(), "0");
}

#[test]
fn identify_prints_a_report_for_a_person() {
    let (_directory, file) = noisy();
    let output = servoscope(&["identify", &file, "--actuator-order", "0", "--full"]);
    assert_eq!(code(&output), Some(0), "{}", error(&output));
    let report = String::from_utf8(output.stdout).unwrap();
    for part in ["ADEQUATE", "Parameters", "Transfer function", "Stages", "refinement"] {
        assert!(report.contains(part), "{report}");
    }
    assert_eq!(report.lines().next(), report.lines().last());
}

#[test]
fn diagnose_says_where_the_base_model_is_wrong_and_names_the_cause() {
    let directory = tempfile::tempdir().unwrap();
    let file = directory.path().join("sticky.csv").to_str().unwrap().to_owned();
    let stiction = ["--fs-plus", "0.8", "--fs-minus", "0.6", "--noise-db", "60"];
    let output = servoscope(&[&["simulate"], &stiction[..], &["--output", &file]].concat());
    assert_eq!(code(&output), Some(0), "{}", error(&output));
    let output = servoscope(&["diagnose", &file, "--actuator-order", "0", "--json"]);
    assert_eq!(code(&output), Some(0), "{}", error(&output));
    let stored = directory.path().join("result.json").to_str().unwrap().to_owned();
    std::fs::write(&stored, output.stdout).unwrap();
    let report = String::from_utf8(servoscope(&["show", &stored]).stdout).unwrap();
    assert!(report.starts_with("EXPLAINED") && report.lines().count() <= 40, "{report}");
    // No terminal: neither escape sequences nor lines of more than 100 columns.
    assert!(!report.contains('\u{1b}'), "{report}");
    assert!(report.lines().all(|line| line.chars().count() <= 100), "{report}");
    let report = String::from_utf8(servoscope(&["show", &stored, "--full"]).stdout).unwrap();
    assert!(report.starts_with("EXPLAINED"), "{report}");
    let page = directory.path().join("page.html").to_str().unwrap().to_owned();
    assert_eq!(code(&servoscope(&["show", &stored, "--report", &page])), Some(2));
    assert_eq!(code(&servoscope(&["show", &stored, &file, "--report", &page])), Some(0));
    assert!(std::fs::read_to_string(page).unwrap().contains("lacks static friction"));
    let parts =
        ["1. static_friction", "Where it is wrong", "Residual, part by part", "Is it noise?"];
    for part in parts.into_iter().chain(["The model with static_friction\n\nADEQUATE"]) {
        assert!(report.contains(part), "{report}");
    }
    let (_directory, clean) = noisy();
    let output = servoscope(&["diagnose", &clean, "--json", "--actuator-order", "0"]);
    let result: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(result["verdict"], "adequate", "{}", result["discrepancy"]);
    assert_eq!(result["base"]["noise"], "given");
}

#[test]
fn an_actuator_that_is_simulated_is_found_and_its_order_too() {
    let actuator = ["--natural-frequency", "31.6", "--damping-ratio", "0.08"];
    let table = simulated(&[&actuator[..], &["--noise-std", "0.001", "--repeats", "4"]].concat());
    let directory = tempfile::tempdir().unwrap();
    let file = directory.path().join("g2.csv");
    std::fs::write(&file, table).unwrap();
    let output = servoscope(&["identify", "--json", file.to_str().unwrap()]);
    assert_eq!(code(&output), Some(0), "{}", error(&output));
    let result: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(result["order_choice"]["actuator_order"], 2);
    assert_eq!(result["noise"], "repeats");
    for (name, truth) in [("natural_frequency", 31.6), ("damping_ratio", 0.08)] {
        let parameter = &result["parameters"][name];
        let [value, std] = ["value", "std"].map(|key| parameter[key].as_f64().unwrap());
        // As above; the scale of the noise is estimated, too.
        assert!((value - truth).abs() < 4.0 * std, "{name}: {value} ± {std}, not {truth}");
    }
}

#[test]
fn a_plan_without_an_axis_or_with_a_wrong_one_says_which_option_is_missing_or_wrong() {
    let axis = ["--pole", "-3", "--constant", "1", "--fc-plus", "1"];
    let wrong = ["--pole", "3", "--constant", "1", "--fc-plus", "1"];
    for (axis, budget, told) in [
        (&[][..], "5", "describe the axis with --pole"),
        (&axis[..], "-5", "--budget-s: "),
        (&wrong[..], "5", "--pole: 3 is not negative"),
    ] {
        let output = servoscope(&[&["plan", "--budget-s", budget], axis].concat());
        assert_eq!(code(&output), Some(2), "{told}: {}", error(&output));
        assert!(error(&output).contains(told), "{told}: {}", error(&output));
    }
}

#[test]
fn simulate_refuses_what_it_cannot_simulate_with_what_would_be_right() {
    let cases: [(&[&str], &str); 3] = [
        (&["--pole", "10"], "--pole -10"),
        (
            &["--magnitudes", "0.1", "--noise-db", "60"],
            "raise --magnitudes above the friction, 0.5",
        ),
        (&["--damping-ratio", "0.1"], "--natural-frequency"),
    ];
    for (arguments, known) in cases {
        let output = servoscope(&[&["simulate"], arguments].concat());
        assert_eq!(code(&output), Some(2), "{arguments:?}");
        assert!(error(&output).contains(known), "{arguments:?}: {}", error(&output));
        assert!(output.stdout.is_empty());
    }
}
