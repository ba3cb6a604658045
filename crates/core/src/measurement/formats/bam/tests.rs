use serde_json::{Value, json};

use crate::measurement::formats::{ParseError, Source, read};
use crate::measurement::{Complex, Loop, Measurement};

/// Time between the entries on average, s.
const STEP_S: f64 = 0.005;

/// What the entry at a time holds: a drive that does not repeat, and a velocity that rises.
fn entry(time_s: f64) -> Value {
    let drive = (time_s * (5.0 + 40.0 * time_s)).sin();
    let position = 0.25 * time_s * time_s;
    json!({
        "position": position, "speed": 0.5 * time_s, "load": 100.0 * drive, "input_volts": 7.4,
        "temp": 30, "timestamp": time_s, "goal_position": position + 0.1 * drive,
        "torque_enable": true,
    })
}

fn log(entries: Vec<Value>) -> Value {
    json!({
        "mass": 0.3, "length": 0.12, "kp": 40, "vin": 7.4, "motor": "made up",
        "trajectory": "chirp", "entries": entries,
    })
}

/// Times as a loop without a clock has them: up to 8 % of the step late.
fn uneven(count: usize) -> Vec<f64> {
    let time = |n: usize| (n as f64 + ((n * 37) % 11) as f64 / 125.0) * STEP_S;
    (0..count).map(time).collect()
}

fn even(count: usize) -> Vec<f64> {
    (0..count).map(|n| n as f64 * STEP_S).collect()
}

fn entries(times_s: &[f64]) -> Vec<Value> {
    times_s.iter().map(|time_s| entry(*time_s)).collect()
}

/// A log that says itself what it lacks, with a dropout and entries without torque.
pub(crate) fn readable() -> Vec<u8> {
    let mut entries = entries(&uneven(100));
    entries[30]["position"] = json!(-3.1);
    entries.iter_mut().skip(50).take(5).for_each(|entry| entry["torque_enable"] = json!(false));
    let mut log = log(entries);
    log["input"] = json!("load %");
    log["response"] = json!("position");
    log["period_s"] = json!("none");
    log.to_string().into_bytes()
}

/// Reads a log with lines of what is given beside it.
fn of(log: &Value, given: &str) -> Result<Measurement, ParseError> {
    let text = log.to_string();
    let given = format!("# given with the upload\n{given}");
    let sources = [
        Source { name: "log.json", bytes: text.as_bytes() },
        Source { name: "given", bytes: given.as_bytes() },
    ];
    read(&sources)
}

#[track_caller]
fn refused(log: &Value, given: &str, column: &str, word: &str) {
    let error = of(log, given).unwrap_err();
    assert_eq!(error.column.as_deref(), Some(column), "{error}");
    assert!(error.reason.contains(word), "{error}");
}

#[track_caller]
fn says(measurement: &Measurement, word: &str) -> bool {
    measurement.notes().iter().any(|note| note.contains(word))
}

const LOAD: &str = "# input: load %\n# response: velocity\n";

#[test]
fn a_log_is_asked_for_what_drives_the_axis_and_for_its_response() {
    let log = log(entries(&uneven(160)));
    let asked = of(&log, "").unwrap_err();
    let lacks: Vec<_> = asked.lacks.iter().map(|lack| (lack.key, lack.example.as_str())).collect();
    assert_eq!(lacks, [("input", "load"), ("response", "velocity")]);
    for part in ["it may be `load` or `error`", "--input load", "--response velocity"] {
        assert!(asked.reason.contains(part), "{asked}");
    }
    let keys = |given: &str| {
        let error = of(&log, given).unwrap_err();
        error.lacks.iter().map(|lack| lack.key).collect::<Vec<_>>()
    };
    assert_eq!(keys("# input: load\n"), ["response"]);
    assert_eq!(keys("# response: position\n"), ["input"]);
}

#[test]
fn entries_at_unequal_times_are_read_on_straight_lines_at_their_mean_step() {
    let times_s = uneven(160);
    let m = of(&log(entries(&times_s)), LOAD).unwrap();
    let [motion] = m.transients() else { panic!("one motion") };
    let step_s = (times_s[159] - times_s[0]) / 159.0;
    assert!((motion.step_s / step_s - 1.0).abs() < 1e-9, "{}", motion.step_s);
    assert_eq!(motion.output.len(), 160);
    for (n, speed) in motion.output.iter().enumerate() {
        // A velocity that rises evenly is on the lines; rounding of numbers below one.
        let expected = 0.5 * (times_s[0] + n as f64 * step_s);
        assert!((speed - expected).abs() < 1e-12, "{n}: {speed} for {expected}");
    }
    assert!(says(&m, "ms apart: input and response are read on straight lines"), "{:?}", m.notes());
    assert!(says(&m, "the file is a BAM log (mass 0.3, length 0.12, kp 40"), "{:?}", m.notes());
    assert_eq!(m.metadata().input.unit, "%");
    assert_eq!(m.metadata().response.unit, "rad/s");
}

#[test]
fn entries_at_equal_times_are_left_as_they_are() {
    let times_s = even(160);
    let m = of(&log(entries(&times_s)), LOAD).unwrap();
    let expected: Vec<f64> = times_s.iter().map(|time_s| 0.5 * time_s).collect();
    assert_eq!(m.transients()[0].output, expected);
    assert!(!says(&m, "straight"), "{:?}", m.notes());
}

#[test]
fn a_trajectory_that_repeats_at_unequal_times_gives_the_ratio_of_response_to_input() {
    let entries = uneven(600).into_iter().map(|time_s| {
        let angle = std::f64::consts::TAU * time_s / 0.5;
        let mut entry = entry(time_s);
        entry["load"] = json!(100.0 * angle.cos());
        entry["speed"] = json!(2.0 * (angle - 0.5).cos());
        entry
    });
    let m = of(&log(entries.collect()), LOAD).unwrap();
    let [experiment] = m.experiments() else { panic!("{:?}", m.notes()) };
    let gain = experiment.harmonic(1).unwrap().value / experiment.input[1];
    // A straight line is off by (ωh)²/8 = 5·10⁻⁴ of the amplitude at most.
    assert!((gain - Complex::from_polar(0.02, -0.5)).norm() < 1e-3 * 0.02, "{gain}");
}

#[test]
fn the_control_error_is_goal_less_position_in_radians() {
    let times_s = even(160);
    let m = of(&log(entries(&times_s)), "# input: error\n# response: position\n").unwrap();
    let motion = &m.transients()[0];
    for (input, time_s) in motion.input.iter().zip(&times_s) {
        let expected = 0.1 * (time_s * (5.0 + 40.0 * time_s)).sin();
        assert!((input - expected).abs() < 1e-12, "{input} for {expected}");
    }
    assert_eq!(m.metadata().input.unit, "rad");
    assert_eq!(m.metadata().response.unit, "rad");
    refused(&log(entries(&times_s)), "# input: error V\n# response: position\n", "error", "stated");
}

#[test]
fn what_does_not_drive_the_axis_is_refused_as_its_input() {
    let mut entries = entries(&uneven(160));
    entries.iter_mut().for_each(|entry| entry["load"] = json!(0));
    let log = log(entries);
    for (input, word) in [
        ("input_volts", "is not what drives the axis"),
        ("goal_position", "is not what drives the axis"),
        ("load", "is the same in every entry"),
        ("current", "has no column `current` (it may be `error`"),
    ] {
        let given = format!("# input: {input}\n# response: velocity\n");
        refused(&log, &given, "input", word);
    }
    refused(&log, "# input: error\n# response: acceleration\n", "response", "no acceleration");
}

#[test]
fn a_position_that_jumps_and_returns_is_left_out_and_said() {
    let mut with_dropout = entries(&even(160));
    with_dropout[30]["position"] = json!(-3.1);
    with_dropout[30]["speed"] = json!(70);
    let m = of(&log(with_dropout), LOAD).unwrap();
    let speed = m.transients()[0].output[30];
    assert!((speed - 0.5 * 30.0 * STEP_S).abs() < 1e-12, "{speed}");
    assert!(says(&m, "(entries[30]): they are left out"), "{:?}", m.notes());
    let mut with_many = entries(&even(160));
    with_many.iter_mut().skip(1).step_by(2).for_each(|entry| entry["position"] = json!(3));
    refused(&log(with_many), LOAD, "entries[1].position", "not the position of the axis");
}

#[test]
fn a_position_that_jumps_and_stays_is_refused_where_it_is_used() {
    let mut entries = entries(&even(160));
    entries.iter_mut().skip(80).for_each(|entry| entry["position"] = json!(-3));
    let log = log(entries);
    let position = "# input: load\n# response: position\n";
    refused(&log, position, "entries[80].position", "unwrap it");
    refused(&log, "# input: error\n# response: velocity\n", "entries[80].position", "unwrap it");
    assert!(of(&log, LOAD).is_ok());
}

#[test]
fn entries_too_far_apart_are_refused_where_the_pause_is() {
    let later = |time_s: &mut f64| *time_s += 2.0 * STEP_S;
    let mut times_s = uneven(160);
    times_s.iter_mut().skip(40).for_each(later);
    refused(&log(entries(&times_s)), LOAD, "entries[40].timestamp", "too long");
    let mut times_s = uneven(160);
    times_s[40] = times_s[39];
    refused(&log(entries(&times_s)), LOAD, "entries[40].timestamp", "does not increase");
}

#[test]
fn entries_without_torque_are_left_out_and_part_a_log_into_motions() {
    let without_torque = |from: usize, count: usize| {
        let mut entries = entries(&uneven(160));
        let off = entries.iter_mut().skip(from).take(count);
        off.for_each(|entry| entry["torque_enable"] = json!(false));
        log(entries)
    };
    let m = of(&without_torque(60, 30), &format!("{LOAD}# period_s: none\n")).unwrap();
    let lengths: Vec<usize> = m.transients().iter().map(|motion| motion.input.len()).collect();
    assert_eq!(lengths, [60, 70]);
    assert!(says(&m, "in 30 entries the torque is off"), "{:?}", m.notes());
    refused(&without_torque(0, 160), LOAD, "entries", "nothing drives the axis");
}

#[test]
fn the_loop_is_closed_where_nothing_else_is_stated() {
    let log = log(entries(&uneven(160)));
    let feedback = |given: &str| of(&log, given).unwrap().metadata().feedback;
    assert_eq!(feedback(LOAD), Some(Loop::Closed));
    assert_eq!(feedback(&format!("{LOAD}# loop: open\n")), Some(Loop::Open));
}

#[test]
fn a_log_may_say_itself_what_it_lacks() {
    let text = readable();
    let m = read(&[Source { name: "log.json", bytes: &text }]).unwrap();
    assert_eq!(m.metadata().input.name, "load");
    assert_eq!(m.transients().len(), 2);
}

#[test]
fn entries_of_another_form_are_refused_with_their_place() {
    let joints = json!({"timestamp": 0, "r1": entry(0.0), "r2": entry(0.0)});
    refused(&log(vec![joints]), LOAD, "entries[0]", "several joints");
    let mut entries = entries(&uneven(160));
    entries[7].as_object_mut().unwrap().remove("load");
    refused(&log(entries.clone()), LOAD, "entries[7].load", "missing");
    entries[7]["load"] = json!("3");
    refused(&log(entries.clone()), LOAD, "entries[7].load", "a number is needed");
    entries[7] = entry(7.0 * STEP_S);
    entries[7]["torque_enable"] = json!("on");
    refused(&log(entries), LOAD, "entries[7].torque_enable", "true or false");
}
