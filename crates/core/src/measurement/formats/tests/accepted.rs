//! Accepted harmonic tables, in every form of the contract.

use std::f64::consts::{SQRT_2, TAU};

use super::*;
use crate::measurement::Complex;

#[test]
fn a_plain_table_gives_one_experiment_a_magnitude_and_frequency() {
    let m = ok("magnitude,omega_rad_s,harmonic,re,im,run\n\
        1,2,0,0.1,0,5\n1,2,1,0.4,-0.2,5\n2,2,1,0.8,-0.3,6\n1,4,1,0.3,-0.3,7\n");
    let [first, second, third] = m.experiments() else { panic!("three experiments") };
    assert_eq!((first.magnitude, first.omega_rad_s, first.run), (1.0, 2.0, Some(5.0)));
    assert_eq!(first.input, [Complex::ZERO, Complex::new(1.0, 0.0)]);
    assert!(!first.input_mean_measured && first.repeats.is_empty() && !first.from_record);
    assert_eq!(y(&m, 0, 1), Complex::new(0.4, -0.2));
    assert_eq!((second.magnitude, third.omega_rad_s), (2.0, 4.0));
    assert!(m.notes().is_empty());
}

#[test]
fn the_digest_is_that_of_the_bytes() {
    // From `sha256sum`.
    assert_eq!(
        ok("magnitude,omega_rad_s,re,im\n1,1,1,0\n").sha256(),
        "1936c75daa40f683bd70daab44ec771490069d3bbd3034b2bf50b761a0df339e"
    );
}

#[test]
fn column_order_is_free_and_unknown_columns_are_noted() {
    let m = ok("im,comment,re,frequency_hz,magnitude\n-2,hello,1,0.5,3\n");
    assert_eq!(y(&m, 0, 1), Complex::new(1.0, -2.0));
    assert_eq!(m.experiments()[0].omega_rad_s, 0.5 * TAU);
    assert!(m.notes()[0].contains("comment"));
}

#[test]
fn byte_order_mark_crlf_spaces_quotes_and_blank_lines_do_not_matter() {
    let plain = ok("# axis: X\nmagnitude,omega_rad_s,re,im\n1,2,3,4\n");
    let dressed = ok("\u{FEFF}# axis:  X \r\n\r\n \"magnitude\" , omega_rad_s,\"re\",im\r\n\
        # free text\r\n 1 ,\"2\", 3.0,+4e0\r\n\r\n,,,\r\n");
    assert_eq!(plain.experiments(), dressed.experiments());
    assert_eq!(plain.metadata(), dressed.metadata());
}

#[test]
fn polar_and_gain_forms_are_the_same_response() {
    let header = "magnitude,omega_rad_s,phase_deg";
    let polar = ok(&format!("{header},amplitude\n2,1,-90,4\n"));
    let gain = ok(&format!("{header},gain\n2,1,-90,2\n"));
    let decibel = ok(&format!("{header},gain_db\n2,1,270,{}\n", 20.0 * 2f64.log10()));
    assert_eq!(y(&polar, 0, 1), Complex::new(0.0, -4.0));
    assert_eq!(y(&gain, 0, 1), Complex::new(0.0, -4.0));
    // Rounding of a logarithm and a power.
    assert!((y(&decibel, 0, 1) - Complex::new(0.0, -4.0)).norm() < 1e-14);
}

#[test]
fn amplitudes_in_rms_become_peaks_and_means_stay() {
    let m = ok("# amplitude: rms\nmagnitude,omega_rad_s,harmonic,re,im,std\n\
        1,1,0,0.5,0,0.1\n1,1,1,1,0,0.1\n");
    let experiment = &m.experiments()[0];
    assert_eq!(experiment.magnitude, SQRT_2);
    assert_eq!((y(&m, 0, 0).re, y(&m, 0, 1).re), (0.5, SQRT_2));
    assert_eq!(experiment.response[0].std, Some(0.1));
    assert_eq!(experiment.response[1].std, Some(0.1 * SQRT_2));
    assert!(experiment.std_given());
}

#[test]
fn a_gain_is_the_same_in_every_amplitude_convention() {
    for amplitude in ["peak", "rms", "peak-to-peak"] {
        let m = ok(&format!(
            "# amplitude: {amplitude}\n\
            magnitude,omega_rad_s,gain,phase_deg\n2,1,3,0\n"
        ));
        let ratio = y(&m, 0, 1).re / m.experiments()[0].magnitude;
        assert!((ratio - 3.0).abs() < 1e-15, "{amplitude}");
    }
}

#[test]
fn a_sine_reference_turns_harmonic_k_by_k_minus_one_quarters() {
    let m = ok("# reference: sin\nmagnitude,omega_rad_s,harmonic,re,im,u_re,u_im\n\
        1,1,0,0.5,0,0.1,0\n1,1,1,1,2,1,0\n1,1,2,1,2,0.1,0.2\n1,1,3,1,2,,\n");
    assert_eq!(y(&m, 0, 0), Complex::new(0.5, 0.0));
    assert_eq!(y(&m, 0, 1), Complex::new(1.0, 2.0));
    assert_eq!(y(&m, 0, 2), Complex::new(-2.0, 1.0));
    assert_eq!(y(&m, 0, 3), Complex::new(-1.0, -2.0));
    let input = &m.experiments()[0].input;
    assert_eq!(
        input[..],
        [Complex::new(0.1, 0.0), Complex::new(1.0, 0.0), Complex::new(-0.2, 0.1)]
    );
    let pure = ok("# reference: sin\nmagnitude,omega_rad_s,re,im\n2,1,1,0\n");
    assert_eq!(pure.experiments()[0].pure_cosine(), Some(Complex::new(2.0, 0.0)));
}

#[test]
fn repeats_become_a_mean_and_deviations() {
    let m = ok("magnitude,omega_rad_s,repeat,re,im,std,run\n\
        1,1,1,1,0,3,0\n1,1,2,3,2,4,10\n");
    let experiment = &m.experiments()[0];
    assert_eq!(y(&m, 0, 1), Complex::new(2.0, 1.0));
    assert_eq!(experiment.repeats.len(), 2);
    assert_eq!(experiment.repeats[0].response, [Complex::new(-1.0, -1.0)]);
    assert!(experiment.repeats[0].input.is_empty());
    // The deviation of the mean is √(3² + 4²)/2.
    assert_eq!(experiment.response[0].std, Some(2.5));
    assert_eq!(experiment.run, Some(5.0));
    assert!(m.notes()[0].starts_with("experiment 1: "));
}

#[test]
fn one_repeat_has_no_deviation() {
    let m = ok("magnitude,omega_rad_s,repeat,re,im\n1,1,7,1,0\n");
    assert!(!m.experiments()[0].has_repeats());
}

#[test]
fn a_measured_input_that_repeats_gives_deviations_too() {
    let header = "magnitude,omega_rad_s,repeat,harmonic,re,im,u_re,u_im\n";
    let m = ok(&format!("{header}1,1,0,1,1,0,1,0.5\n1,1,1,1,1,0,3,0.5\n"));
    let experiment = &m.experiments()[0];
    assert_eq!(experiment.input, [Complex::ZERO, Complex::new(2.0, 0.5)]);
    assert_eq!(experiment.repeats[1].input, [Complex::ZERO, Complex::new(1.0, 0.0)]);
    assert!(!experiment.input_mean_measured);
    let same = ok(&format!("{header}1,1,0,1,1,0,0.1,0.3\n1,1,1,1,2,0,0.1,0.3\n"));
    assert_eq!(same.experiments()[0].input[1], Complex::new(0.1, 0.3));
    assert!(same.experiments()[0].repeats[0].input.is_empty());
}

#[test]
fn a_measured_input_needs_no_magnitude_and_rows_may_give_the_input_alone() {
    let m = ok("omega_rad_s,experiment,harmonic,re,im,u_re,u_im\n\
        1,0,0,,,0.3,\n1,0,1,1,0,0,2\n1,1,1,1,0,3,0\n1,1,3,,,1,0\n");
    let [first, second] = m.experiments() else { panic!("two experiments") };
    assert_eq!(first.magnitude, 2.0);
    assert!(first.input_mean_measured && first.response.len() == 1);
    // 3 cos θ + cos 3θ peaks at 4, where both are one.
    assert!((second.magnitude - 4.0).abs() < 1e-9);
    assert_eq!(second.response.len(), 1);
}

#[test]
fn rows_of_one_experiment_index_are_one_experiment() {
    let m = ok("experiment,magnitude,omega_rad_s,harmonic,re,im\n\
        7,1,1,3,3,0\n9,1,1,1,5,0\n7,1,1,1,1,0\n");
    let [first, second] = m.experiments() else { panic!("two experiments") };
    assert_eq!(first.response.iter().map(|h| h.order).collect::<Vec<_>>(), [1, 3]);
    assert_eq!(second.response.len(), 1);
}

#[test]
fn the_imaginary_part_of_a_mean_is_left_out_and_noted() {
    let m = ok("magnitude,omega_rad_s,harmonic,re,im\n1,1,0,0.5,0.1\n1,1,1,1,0\n");
    assert_eq!(y(&m, 0, 0), Complex::new(0.5, 0.0));
    assert!(m.notes()[0].contains("harmonic 0"));
}

#[test]
fn several_files_are_joined_and_may_mix_tables_and_records() {
    let table = "# input: current A\n# machine: mill\nmagnitude,omega_rad_s,re,im\n1,1,1,0\n";
    let other =
        format!("# input: current A\n# machine: lathe\n# period_s: 0.1\n{}", record(100, 3));
    let m = read(&[
        Source { name: "a.csv", bytes: table.as_bytes() },
        Source { name: "b.csv", bytes: other.as_bytes() },
        Source { name: "c.csv", bytes: table.as_bytes() },
    ])
    .unwrap();
    assert_eq!(m.experiments().len(), 3);
    assert_eq!(m.metadata().machine.as_deref(), Some("mill"));
    assert_eq!(m.metadata().response_kind, ResponseKind::Velocity);
    assert!(m.notes().iter().any(|note| note.contains("b.csv") && note.contains("machine")));
    assert!(m.notes().iter().any(|note| note.starts_with("experiment 2: ")));
}

#[test]
fn a_bias_is_the_mean_of_the_input_and_tells_experiments_apart() {
    let m = ok("magnitude,omega_rad_s,harmonic,re,im,bias\n\
        1,2,0,0.9,0,2\n1,2,1,0.4,-0.2,2\n1,2,1,0.3,-0.2,-2\n1,2,1,0.2,-0.2,\n");
    let means: Vec<f64> = m.experiments().iter().map(|e| e.input[0].re).collect();
    assert_eq!(means, [2.0, -2.0, 0.0]);
    let [first, _, third] = m.experiments() else { panic!("three experiments") };
    assert_eq!((first.magnitude, first.input[1].re, first.response.len()), (1.0, 1.0, 2));
    assert!(first.input_mean_measured && !third.input_mean_measured);
}

#[test]
fn a_bias_goes_with_measured_lines_of_the_input() {
    let m = ok("magnitude,omega_rad_s,harmonic,re,im,bias,u_re,u_im\n1,1,1,1,0,3,1,0.5\n");
    let lines = [Complex::new(3.0, 0.0), Complex::new(1.0, 0.5)];
    assert_eq!(m.experiments()[0].input, lines);
}
