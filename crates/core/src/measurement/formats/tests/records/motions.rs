//! Records without a period.

use super::*;

/// A chirp that begins at rest.
fn chirp() -> String {
    let row = |n: i32| {
        let t = f64::from(n) * 1e-3;
        format!("{t:.3},{:.6},{:.6}\n", (t * (5.0 + 40.0 * t)).sin(), 0.1 * t)
    };
    String::from("time_s,input,output\n") + &(0..800).map(row).collect::<String>()
}

#[test]
fn a_record_without_a_period_is_one_motion() {
    let m = ok(&chirp());
    assert!(m.experiments().is_empty());
    let [motion] = m.transients() else { panic!("one motion") };
    assert_eq!((motion.input.len(), motion.output[799]), (800, 0.0799));
    assert!((motion.duration_s() - 0.799).abs() < 1e-12);
    assert_eq!(motion.beginning, crate::measurement::Beginning::default());
    assert!(m.notes().iter().any(|note| note.contains("no period is found")), "{:?}", m.notes());
}

#[test]
fn a_record_that_says_so_has_no_period_and_its_header_says_how_it_begins() {
    let header = "# period_s: none\n# initial_velocity: 0.2\n# initial_position: -1\n\
                  # settle_s: 0.05\n# intersample: hold\n";
    let m = ok(&format!("{header}{}", record(100, 4)));
    let [motion] = m.transients() else { panic!("one motion") };
    let beginning = motion.beginning;
    assert_eq!((beginning.velocity, beginning.position), (Some(0.2), Some(-1.0)));
    assert_eq!(beginning.settle_s, Some(0.05));
    assert_eq!(motion.intersample, crate::measurement::Intersample::Hold);
    assert_eq!(motion.input.len(), 400);
    let text = format!("# period_s: none\n# settle_s: 9\n{}", record(100, 4));
    let error = read(&[Source { name: "f.csv", bytes: text.as_bytes() }]).unwrap_err();
    assert!(error.reason.contains("settle_s of 9 s leaves nothing"), "{error}");
}

#[test]
fn motions_and_experiments_are_not_one_measurement() {
    let (periodic, motion) = (format!("# period_s: 0.1\n{}", record(100, 4)), chirp());
    let sources = [("a.csv", &periodic), ("b.csv", &motion)]
        .map(|(name, text)| Source { name, bytes: text.as_bytes() });
    let error = read(&sources).unwrap_err();
    assert!(error.reason.contains("1 of 2 experiments have a period"), "{error}");
    let both = [("b.csv", &motion), ("c.csv", &motion)];
    let both = both.map(|(name, text)| Source { name, bytes: text.as_bytes() });
    assert_eq!(read(&both).unwrap().transients().len(), 2);
}
