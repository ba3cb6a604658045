//! Records that begin before the response has settled.

use super::*;

/// `periods` periods of 0.1 s of a response that settles with the time constant `settling_s`.
fn settling(periods: usize, settling_s: f64) -> String {
    let mut text = String::from("# period_s: 0.1\ntime_s,input,output\n");
    for n in 0..100 * periods {
        let (time, angle) = (n as f64 * 1e-3, std::f64::consts::TAU * n as f64 / 100.0);
        let noise = 0.01 * (((n * 7919) % 101) as f64 - 50.0) / 50.0;
        let output = angle.cos() + (-time / settling_s).exp() + noise;
        text += &format!("{time:.3},{:.6},{output:.6}\n", angle.sin());
    }
    text
}

fn notes(text: &str) -> String {
    ok(text).notes().join("; ")
}

#[test]
fn periods_that_have_not_settled_are_left_out_unless_their_number_is_stated() {
    let text = settling(6, 0.03);
    assert!(notes(&text).contains("the first period is left out"), "{}", notes(&text));
    assert_eq!(ok(&text).experiments()[0].repeats.len(), 5);
    let stated = format!("# settle_periods: 0\n{text}");
    assert!(notes(&stated).contains("has not settled; give more settle_periods"));
    assert_eq!(ok(&stated).experiments()[0].repeats.len(), 6);
    assert!(!notes(&format!("# settle_periods: 1\n{text}")).contains("settled"));
    // Two periods each divide what remains by e: after ten, it is below the noise.
    let slow = ok(&settling(20, 0.2));
    assert!((8..=14).contains(&slow.experiments()[0].repeats.len()), "{:?}", slow.notes());
    assert!(y(&slow, 0, 0).norm() < 0.02, "{}", y(&slow, 0, 0));
}

#[test]
fn periods_that_change_smoothly_are_said() {
    for periods in [2, 3] {
        let said = notes(&settling(periods, 0.2));
        assert!(said.contains("the response changes smoothly by"), "{said}");
        let said = notes(&settling(periods, 1e-9));
        assert!(!said.contains("settled"), "{said}");
    }
    // Of five periods each deviates from the mean about as much as the next.
    let said = notes(&settling(5, 0.2));
    assert!(said.contains("the response changes smoothly by"), "{said}");
}
