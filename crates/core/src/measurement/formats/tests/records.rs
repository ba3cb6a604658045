//! Time records.

use super::*;
use crate::measurement::Complex;

mod motions;
mod settling;

#[test]
fn a_record_gives_harmonics_of_its_last_periods() {
    let m = ok(&format!("# period_s: 0.1\n# settle_periods: 1\n{}", record(100, 4)));
    let experiment = &m.experiments()[0];
    assert_eq!(experiment.repeats.len(), 3);
    assert_eq!(experiment.input.len(), 51);
    // Tolerances: six printed decimals, and a scatter of up to 10⁻³.
    assert!((experiment.magnitude - 2.0).abs() < 1e-5);
    assert!((y(&m, 0, 1) - Complex::from_polar(1.0, -0.5)).norm() < 1e-3);
    assert!((y(&m, 0, 3) - Complex::new(0.0, -0.1)).norm() < 1e-3);
    assert!(experiment.from_record && experiment.input_mean_measured);
    assert!((experiment.omega_rad_s * 0.1 / std::f64::consts::TAU - 1.0).abs() < 1e-15);
}

#[test]
fn segments_are_experiments_with_periods_of_their_own() {
    let mut text = String::from("segment,time_s,output,input\n");
    let mut time = 0.0;
    for (segment, period) in [(3, 62.37), (1, 40.0), (2, 101.5)] {
        for n in 0..420 {
            let angle = std::f64::consts::TAU * f64::from(n) / period;
            let y = 0.3 * (angle - 1.0).cos() + 0.01 * (3.0 * angle).sin() + 0.2;
            text += &format!("{segment},{time:.3},{y:.7},{:.7}\n", 2.0 * angle.cos());
            time += 1e-3;
        }
    }
    let m = ok(&text);
    let [first, second, third] = m.experiments() else { panic!("three experiments") };
    for (experiment, period) in [(first, 0.06237), (second, 0.04), (third, 0.1015)] {
        let found = std::f64::consts::TAU / experiment.omega_rad_s;
        // Seven printed digits, and an interpolation accurate to 10⁻⁵.
        assert!((found / period - 1.0).abs() < 1e-5, "{found} for {period}");
        assert!((experiment.magnitude - 2.0).abs() < 1e-4);
        let gain = experiment.harmonic(1).unwrap().value / experiment.input[1];
        assert!((gain - Complex::from_polar(0.15, -1.0)).norm() < 1e-4, "{gain}");
        assert!((experiment.harmonic(0).unwrap().value.re - 0.2).abs() < 1e-4);
    }
    // One clock runs through all segments.
    assert_eq!([first.run, second.run, third.run], [Some(0.0), Some(1.0), Some(2.0)]);
}

#[test]
fn one_period_is_accepted_without_deviations() {
    let m = ok(&format!("# period_s: 0.1\n{}", record(100, 1)));
    assert!(!m.experiments()[0].has_repeats());
    assert!(m.notes().iter().any(|note| note.contains("one whole period")));
}

// There the samples fold a line onto itself.
#[test]
fn a_response_ends_below_the_nyquist_frequency() {
    for (samples, last) in [(20, 9), (21, 10)] {
        let mut text = format!("# period_s: 0.0{samples}\ntime_s,input,output\n");
        for n in 0..4 * samples {
            let at = |place: i32| f64::from(u8::from(n % samples == place));
            let scatter = 1e-4 * f64::from((n * 7919) % 101);
            text += &format!("{:.3},{},{:.6}\n", f64::from(n) * 1e-3, at(3), at(5) + scatter);
        }
        let m = ok(&text);
        assert_eq!(m.experiments()[0].highest_harmonic(), last);
        assert_eq!(m.experiments()[0].input.len() as i32, samples / 2 + 1);
    }
}

#[test]
fn periods_that_are_copies_say_nothing_of_the_noise() {
    let one = record(100, 1);
    let rows: Vec<&str> = one.lines().skip(1).map(|row| row.split_once(',').unwrap().1).collect();
    let mut text = String::from("# period_s: 0.1\ntime_s,input,output\n");
    for n in 0..300 {
        text += &format!("{:.3},{}\n", f64::from(n) * 1e-3, rows[n as usize % 100]);
    }
    let m = ok(&text);
    assert!(!m.experiments()[0].has_repeats());
    assert!(m.notes().iter().any(|note| note.contains("copies")));
}

/// Three periods of 0.1 s of a position that is rounded to steps of 0.01 and moves on by `travel`.
fn rounded_position(travel: f64, scatter: f64) -> Measurement {
    let mut text = String::from("# response: position rad\n# period_s: 0.1\ntime_s,input,output\n");
    for n in 0..600 {
        let phase = f64::from(n) / 200.0;
        let noise = scatter * (f64::from((n * 7919) % 101) - 50.0) / 50.0;
        let position = (std::f64::consts::TAU * phase).cos() + travel * phase + noise;
        let rounded = (position / 0.01).round() * 0.01;
        text += &format!(
            "{:.4},{:.4},{rounded:.2}\n",
            phase * 0.1,
            (std::f64::consts::TAU * phase).sin()
        );
    }
    ok(&text)
}

#[test]
fn rounding_that_repeats_with_the_periods_is_noise_and_rounding_that_scatters_is_not_counted_twice()
{
    // The scatter is uniform over ± 0.2 and ± 2 steps.
    let repeating = rounded_position(0.0, 0.002);
    let scattering = rounded_position(0.0, 0.02);
    let of = |m: &Measurement| m.experiments()[0].rounding_std;
    // All of 0.01/√12, in each of re and im √(2/200) of it.
    let whole = 0.01 / 12.0_f64.sqrt() * (2.0_f64 / 200.0).sqrt();
    assert!((0.4..0.9).contains(&(of(&repeating) / whole)), "{}", of(&repeating) / whole);
    assert!(of(&scattering) < 0.01 * whole, "{}", of(&scattering) / whole);
}

#[test]
fn a_position_that_moves_on_is_used_without_that_uniform_motion() {
    let moving = rounded_position(0.3, 0.02);
    let experiment = &moving.experiments()[0];
    assert!((experiment.mean_velocity - 3.0).abs() < 0.02, "{}", experiment.mean_velocity);
    assert!((y(&moving, 0, 1) - Complex::new(1.0, 0.0)).norm() < 0.01);
    assert!(moving.notes().iter().any(|note| note.contains("drifts by 0.3")));
    // A table with the mean of the input would say that the position returns.
    let mut table = Vec::new();
    write_harmonic_csv(&moving, &mut table).unwrap();
    let read = ok(std::str::from_utf8(&table).unwrap());
    assert!(experiment.input_mean_measured && !read.experiments()[0].input_mean_measured);
}

#[test]
fn an_input_that_is_held_between_samples_is_half_a_sample_late() {
    let text = record(100, 3);
    let at = ok(&format!("# period_s: 0.1\n{text}"));
    let held = ok(&format!("# period_s: 0.1\n# intersample: hold\n{text}"));
    let [at, held] = [&at, &held].map(|m| m.experiments()[0].input[1]);
    let half = std::f64::consts::PI / 100.0;
    // Rounding of a few operations.
    assert!((held / at - Complex::from_polar(half.sin() / half, -half)).norm() < 1e-12);
}

#[test]
fn an_input_that_contradicts_its_period_is_refused_and_one_of_noise_is_said() {
    let wrong = record(100, 5);
    refused(&format!("# period_s: 0.13\n{wrong}"), 3, "input", "period_s: none");
    // A ramp of three amplitudes over five periods changes by 0.6 amplitudes per period. That is
    // more than half the rms of sine and ramp together.
    let mut drifting = String::from("# period_s: 0.1\ntime_s,input,output\n");
    for n in 0..500 {
        let angle = std::f64::consts::TAU * f64::from(n) / 100.0;
        let input = angle.sin() + 3.0 * f64::from(n) / 500.0;
        drifting += &format!("{:.3},{input:.6},{:.6}\n", f64::from(n) * 1e-3, angle.cos());
    }
    refused(&drifting, 3, "input", "changes by 5");
    // In every other period every other sample is 0.2 higher: the change is not correlated from
    // sample to sample.
    let mut noisy = String::from("# period_s: 0.1\ntime_s,input,output\n");
    for n in 0..500 {
        let angle = std::f64::consts::TAU * f64::from(n) / 100.0;
        let noise = if (n / 100) % 2 == 0 && n % 2 == 0 { 0.2 } else { 0.0 };
        let input = angle.sin() + noise;
        noisy += &format!("{:.3},{input:.6},{:.6}\n", f64::from(n) * 1e-3, angle.cos());
    }
    assert!(ok(&noisy).notes().iter().any(|note| note.contains("the input changes by 20 %")));
}

#[test]
fn less_than_a_whole_period_is_refused() {
    let text = format!("# period_s: 0.5\n{}", record(100, 4));
    refused(&text, 3, "time_s", "no whole period");
    let text = format!("# period_s: 0.1\n# settle_periods: 4\n{}", record(100, 4));
    refused(&text, 4, "time_s", "no whole period");
    let text = format!("# period_s: 0.003\n{}", record(100, 4));
    refused(&text, 3, "time_s", "at least 4");
    refused("time_s,input,output\n0,1,1\n", 2, "time_s", "few");
    let still: String = (0..50).map(|n| format!("{n},1,1\n")).collect();
    refused(&format!("time_s,input,output\n{still}"), 2, "input", "give period_s");
}

#[test]
fn time_that_does_not_run_evenly_is_refused_with_its_line() {
    let text = record(100, 3);
    let lines: Vec<&str> = text.lines().collect();
    let without = |n: usize| {
        let kept: Vec<&str> =
            lines.iter().enumerate().filter(|(i, _)| *i != n).map(|(_, line)| *line).collect();
        kept.join("\n")
    };
    refused(&without(150), 151, "time_s", "not constant");
    let mut swapped = lines.clone();
    swapped.swap(200, 201);
    refused(&swapped.join("\n"), 202, "time_s", "does not increase");
    let mut twice = lines.clone();
    twice.insert(10, lines[10]);
    refused(&twice.join("\n"), 12, "time_s", "does not increase");
}

#[test]
fn a_segment_that_goes_on_after_another_is_refused() {
    let text = "time_s,input,output,segment\n0,1,1,0\n1,1,1,1\n2,1,1,0\n";
    refused(text, 4, "segment", "together");
    refused("time_s,input,output,segment\n0,1,1,\n", 2, "segment", "missing");
    refused("time_s,input,output\n0,1,x\n", 2, "output", "`x`");
    refused("time_s,input,output\n0,,1\n", 2, "input", "missing");
}

#[test]
fn rows_without_a_segment_are_left_out_where_the_file_says_so() {
    let mut text = String::from("# blank_segments: unused\ntime_s,input,output,segment\n");
    for sample in 0..300 {
        let angle = std::f64::consts::TAU * f64::from(sample) / 50.0;
        // The first 100 samples rise to the magnitude; the last 50 belong to nothing either.
        let gain = (f64::from(sample) / 100.0).min(1.0);
        let segment = if (100..250).contains(&sample) { "7" } else { "" };
        let (u, y) = (gain * angle.cos(), gain * angle.sin());
        text += &format!("{},{u:.9},{y:.9},{segment}\n", f64::from(sample) * 0.01);
    }
    let measurement = ok(&text);
    let [experiment] = measurement.experiments() else { panic!("one experiment") };
    assert!((experiment.magnitude - 1.0).abs() < 1e-6);
    assert!(measurement.notes().iter().any(|note| note.contains("150 samples without a segment")));
    refused(&text.replace("unused", "perhaps"), 1, "blank_segments", "neither unused nor refused");
}

#[test]
fn a_key_in_upper_case_is_metadata_all_the_same() {
    let m = ok(&format!("# Response: position mm\n# PERIOD_S: 0,1\n{}", record(100, 4)));
    assert_eq!(m.metadata().response_kind, ResponseKind::Position);
    assert_eq!(m.metadata().response.unit, "mm");
    assert!(!m.notes().iter().any(|note| note.contains("unknown")), "{:?}", m.notes());
    let plain = ok(&format!("# response: position mm\n# period_s: 0.1\n{}", record(100, 4)));
    assert_eq!(m.experiments(), plain.experiments());
}
