//! Measured data and reference responses, as files.

use std::path::Path;

use servoscope_core::measurement::formats::{Source, read, write_harmonic_csv};
use servoscope_core::measurement::{Complex, Experiment, Measurement, ResponseKind};

use crate::reference;
use crate::shared_files::{self, shared};

fn read_text(text: &str) -> Measurement {
    read(&[Source { name: "record.csv", bytes: text.as_bytes() }])
        .unwrap_or_else(|error| panic!("{error}"))
}

/// The text of a record, with and without its line `# period_s`.
fn with_and_without_period(path: &Path) -> [String; 2] {
    let text = std::fs::read_to_string(path).expect("the folder is there");
    let without: String =
        text.split_inclusive('\n').filter(|line| !line.starts_with("# period_s")).collect();
    assert_ne!(text, without);
    [text, without]
}

enum Side {
    Input,
    Output,
}

/// Rms deviation of a period from the mean of all, as a share of its rms.
fn scatter(experiment: &Experiment, side: Side) -> f64 {
    let power = |values: &[Complex]| -> f64 { values[1..].iter().map(Complex::norm_sqr).sum() };
    let output: Vec<Complex> = experiment.response.iter().map(|h| h.value).collect();
    let (mean, deviations): (_, Vec<&[Complex]>) = match side {
        Side::Input => {
            (&experiment.input, experiment.repeats.iter().map(|r| &r.input[..]).collect())
        }
        Side::Output => (&output, experiment.repeats.iter().map(|r| &r.response[..]).collect()),
    };
    let scattered: f64 = deviations.iter().map(|deviation| power(deviation)).sum();
    (scattered / deviations.len() as f64 / power(mean)).sqrt()
}

#[test]
fn the_positioning_stage_gives_its_last_three_periods_of_6240_samples() {
    let Some(data) = shared("data") else { return };
    for text in with_and_without_period(&data.join("emps/emps.csv")) {
        let measurement = read_text(&text);
        let [experiment] = measurement.experiments() else { panic!("one experiment") };
        assert_eq!(measurement.metadata().response_kind, ResponseKind::Position);
        assert_eq!(measurement.metadata().input.unit, "N");
        assert_eq!(experiment.repeats.len(), 3);
        assert_eq!(experiment.input.len(), 3121);
        // The period is 6240 steps of 1 ms to the rounding of the times.
        assert!((experiment.omega_rad_s * 6.24 / std::f64::consts::TAU - 1.0).abs() < 1e-9);
        assert!(experiment.from_record && experiment.input_mean_measured);
        // Beyond an octave of noise there is a disturbance at 433 Hz, line 2703.
        assert!((400..1600).contains(&experiment.highest_harmonic()));
        // "The position repeats to 4e-6 of its size, the force only to 1e-2."
        assert!(scatter(experiment, Side::Output) < 4e-6);
        assert!((1e-3..1e-2).contains(&scatter(experiment, Side::Input)));
        // Mean force of samples 6121 …, 12361 … and 18601 … to the end, summed by hand.
        for (repeat, mean) in experiment.repeats.iter().zip([-3.0731, -3.2714, -3.3126]) {
            assert!((experiment.input[0].re + repeat.input[0].re - mean).abs() < 1e-4);
        }
    }
}

#[test]
fn the_motor_bench_gives_18_periods_of_one_second() {
    let Some(data) = shared("data") else { return };
    for text in with_and_without_period(&data.join("motor-bench/multisine_a.csv")) {
        let measurement = read_text(&text);
        let [experiment] = measurement.experiments() else { panic!("one experiment") };
        assert_eq!(experiment.repeats.len(), 18);
        assert_eq!(experiment.input.len(), 1251);
        // The multisine ends at 250 Hz; lines of the current above it drive too.
        assert!((250..1000).contains(&experiment.highest_harmonic()));
        // Two of the periods scatter by 3 %, most by 1 %.
        assert!(scatter(experiment, Side::Output) < 2e-2);
        assert!((experiment.omega_rad_s / std::f64::consts::TAU - 1.0).abs() < 1e-9);
    }
}

#[test]
fn two_whole_periods_are_enough_to_find_a_period() {
    let Some(data) = shared("data") else { return };
    for (file, samples, period_s) in
        [("emps/emps.csv", 6240, 6.24), ("motor-bench/multisine_a.csv", 2500, 1.0)]
    {
        let text = std::fs::read_to_string(data.join(file)).unwrap();
        let rows = text.lines().filter(|line| line.starts_with(|c: char| c.is_ascii_digit()));
        for count in [2 * samples, 2 * samples + samples / 20, 3 * samples - 1] {
            let part: Vec<&str> = rows.clone().skip(samples / 2).take(count).collect();
            let measurement = read_text(&format!("time_s,input,output\n{}", part.join("\n")));
            let found_s = std::f64::consts::TAU / measurement.experiments()[0].omega_rad_s;
            assert!((found_s / period_s - 1.0).abs() < 1e-9, "{found_s} s in {count} of {file}");
        }
    }
}

#[test]
fn a_real_record_survives_being_written_as_a_table() {
    let Some(data) = shared("data") else { return };
    let text = std::fs::read_to_string(data.join("motor-bench/multisine_a.csv")).unwrap();
    let measurement = read_text(&text);
    let mut table = Vec::new();
    write_harmonic_csv(&measurement, &mut table).unwrap();
    let again = read_text(std::str::from_utf8(&table).unwrap());
    let (before, after) = (&measurement.experiments()[0], &again.experiments()[0]);
    assert_eq!(measurement.metadata(), again.metadata());
    assert_eq!(before.repeats.len(), after.repeats.len());
    assert_eq!(before.input.len(), after.input.len());
    let size = before.response.iter().map(|h| h.value.norm()).fold(0.0, f64::max);
    for (before, after) in before.response.iter().zip(&after.response) {
        // Rounding of 18 sums.
        assert!((before.value - after.value).norm() < 1e-14 * size);
    }
}

#[test]
fn every_reference_response_is_read_whole() {
    for name in reference::names() {
        let text = std::fs::read_to_string(shared_files::reference(&name)).unwrap();
        let measurement = read_text(&text);
        let rows: usize = measurement.experiments().iter().map(|e| e.response.len()).sum();
        assert_eq!(rows, text.lines().count() - 1, "{name}");
        assert!(measurement.notes().is_empty(), "{:?}", measurement.notes());
        assert!(measurement.experiments().iter().all(|e| e.run.is_some() && !e.std_given()));
    }
}
