//! Stated periods that are wrong, right, and cannot be checked.

use super::*;

/// A record, 5 ms apart, of an input with three harmonics of `true_s` and a response to it.
fn stated(period_s: &str, true_s: f64, duration_s: f64, drift: f64) -> String {
    let mut text = format!("# period_s: {period_s}\ntime_s,input,output\n");
    for n in 0..(duration_s / 0.005).round() as usize {
        let angle = std::f64::consts::TAU * n as f64 * 0.005 / true_s;
        let noise = 1e-3 * (((n * 7919) % 101) as f64 / 50.0 - 1.0);
        let input = 1.5 * angle.cos()
            + 0.8 * (3.0 * angle + 1.0).cos()
            + 0.5 * (7.0 * angle + 2.0).cos()
            + drift * n as f64 * 0.005 / duration_s
            + noise;
        let output = (angle - 0.5).cos() + noise;
        text += &format!("{:.3},{input:.6},{output:.6}\n", n as f64 * 0.005);
    }
    text
}

#[test]
fn a_stated_period_that_is_slightly_wrong_is_refused_with_the_right_one() {
    for wrong in ["0.98", "0.99", "0.995", "1.005", "1.01", "1.02"] {
        for duration_s in [5.0, 20.0] {
            refused(&stated(wrong, 1.0, duration_s, 0.0), 3, "input", "but with 1");
        }
    }
}

#[test]
fn a_stated_period_that_is_rounded_is_mended_and_that_is_said() {
    let m = ok(&stated("0.333", 1.0 / 3.0, 20.0, 0.0));
    let period_s = std::f64::consts::TAU / m.experiments()[0].omega_rad_s;
    // The standard error of the phase is about 1e-4 of a period, over 40 periods.
    assert!((3.0 * period_s - 1.0).abs() < 1e-5, "{period_s}");
    let said = "the input repeats with 0.33333";
    assert!(m.notes().iter().any(|note| note.contains(said)), "{:?}", m.notes());
}

#[test]
fn a_short_record_refuses_a_wrong_period_and_says_where_a_right_one_is_unchecked() {
    for (wrong, duration_s) in [("1.3", 1.8), ("0.95", 1.4), ("1.3", 1.4), ("1.2", 1.25)] {
        refused(&stated(wrong, 1.0, duration_s, 0.0), 3, "input", "does not repeat");
    }
    for (duration_s, said) in [(1.02, "could not be"), (1.2, "checked on 20 %"), (1.0, "could not")]
    {
        let m = ok(&stated("1.0", 1.0, duration_s, 0.0));
        assert!(m.notes().iter().any(|note| note.contains(said)), "{:?}", m.notes());
    }
    let m = ok(&stated("1.0", 1.0, 1.8, 0.0));
    assert!(!m.notes().iter().any(|note| note.contains("checked")), "{:?}", m.notes());
}

#[test]
fn a_right_period_and_its_multiples_are_used_though_the_mean_drifts() {
    for (period_s, drift) in [("1.0", 0.0), ("1.0", 1.0), ("2.0", 0.0), ("3.0", 0.5)] {
        let m = ok(&stated(period_s, 1.0, 20.0, drift));
        let used = std::f64::consts::TAU / m.experiments()[0].omega_rad_s;
        assert!((used / period_s.parse::<f64>().unwrap() - 1.0).abs() < 1e-12, "{used}");
    }
}
