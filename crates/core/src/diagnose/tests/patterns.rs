//! Departures added to a response are found and described.

use super::*;

/// The discrepancy of a measurement whose response was changed before noise was added.
fn examined(
    statement: NoiseStatement,
    change: impl Fn(usize, &mut Experiment),
) -> (Discrepancy, Vec<Experiment>) {
    let mut experiments = exact();
    experiments.iter_mut().enumerate().for_each(|(i, experiment)| change(i, experiment));
    (discrepancy_of(&noisy(&experiments, statement, 7)), experiments)
}

/// The geometric mean of the frequencies of experiments `index` and `index + 1`, rad/s.
fn middle(experiments: &[Experiment], index: usize) -> f64 {
    (experiments[index].omega_rad_s * experiments[index + 1].omega_rad_s).sqrt()
}

#[test]
fn noise_is_adequate_and_the_sentence_says_what_would_have_been_noticed() {
    for statement in [NoiseStatement::Std, NoiseStatement::Repeats(4), NoiseStatement::Silent] {
        let (discrepancy, _) = examined(statement, |_, _| ());
        assert!(discrepancy.noise_like, "{:?}", discrepancy.tests);
        assert!(discrepancy.patterns.is_empty());
        let sentence = &discrepancy.sentence;
        assert!(
            sentence.contains(
                "to within its noise; the smallest error that the test notices on average is 0."
            ),
            "{sentence}"
        );
    }
}

#[test]
fn a_wrong_harmonic_in_a_corner_is_found_and_described() {
    let exact = exact();
    let (limit, lowest) = (middle(&exact, 3), exact[0].magnitude);
    for statement in [NoiseStatement::Std, NoiseStatement::Repeats(4), NoiseStatement::Silent] {
        let (discrepancy, _) = examined(statement, |_, experiment| {
            if experiment.magnitude == lowest && experiment.omega_rad_s < limit {
                experiment.response[3].value *= 1.4;
            }
        });
        assert!(!discrepancy.noise_like);
        let pattern = &discrepancy.patterns[0];
        let said = &pattern.sentence;
        assert!(said.starts_with("at the lowest magnitude ("), "{said}");
        assert!(said.contains(" Hz, the third harmonic is ") && said.contains("below "), "{said}");
        assert!(said.contains(" % larger than simulated"), "{said}");
        assert!(discrepancy.sentence.contains(said.as_str()));
        // The fit absorbs a little of the 40 %.
        let size = pattern.relative_size.unwrap();
        assert!((0.36..0.44).contains(&size), "{size}");
        // At one of the four frequencies the harmonic may be nearly 0.
        assert_eq!(pattern.harmonics, [3]);
        assert!((3..=4).contains(&pattern.count), "{}", pattern.count);
        assert!(pattern.share > 0.8, "{}", pattern.share);
    }
}

#[test]
fn a_mean_that_is_wrong_everywhere_is_described_in_units_of_the_response() {
    let (discrepancy, experiments) = examined(NoiseStatement::Std, |_, e| {
        let size = e.response[1].value.norm();
        e.response[0].value += 0.03 * size;
    });
    let pattern = &discrepancy.patterns[0];
    assert_eq!(pattern.harmonics, [0], "{}", pattern.sentence);
    assert!(pattern.sentence.contains("the mean "), "{}", pattern.sentence);
    assert_eq!(discrepancy.by_harmonic.len(), experiments[0].response.len());
}

#[test]
fn a_phase_that_leads_above_a_frequency_is_described_in_degrees() {
    let limit = middle(&exact(), 6);
    let (discrepancy, _) = examined(NoiseStatement::Std, |_, e| {
        if e.omega_rad_s > limit {
            e.response[1].value *= Complex::from_polar(1.0, 0.2);
        }
    });
    let pattern = &discrepancy.patterns[0];
    assert!(pattern.sentence.contains("the fundamental leads by "), "{}", pattern.sentence);
    assert_eq!(pattern.harmonics, [1]);
    // 0.2 rad are 11.5°; the fitted pole absorbs a part.
    assert!((4.0..12.0).contains(&pattern.phase_deg.unwrap()), "{pattern:?}");
}

#[test]
fn a_response_that_grows_while_it_is_measured_is_a_drift() {
    let count = exact().len();
    let (discrepancy, _) = examined(NoiseStatement::Std, |i, e| {
        // A permutation, as 7 and 24 have no common factor: not the order of magnitude or
        // frequency.
        let run = (7 * i % count) as f64;
        e.run = Some(run);
        e.response.iter_mut().for_each(|h| h.value *= 1.0 + 0.05 * run / count as f64);
    });
    let pattern = &discrepancy.patterns[0];
    assert_eq!(pattern.runs, Some([0.0, (count - 1) as f64]), "{}", pattern.sentence);
    assert!(pattern.sentence.starts_with("the response grows during the acquisition"));
    // From the first to the last third the mean grows by two thirds of 5 %.
    let change = pattern.relative_size.unwrap();
    assert!((0.025..0.045).contains(&change), "{change}");
    assert_eq!(discrepancy.by_run.len(), 8);
}

#[test]
fn a_single_wrong_point_is_described_by_where_it_is() {
    let (discrepancy, experiments) = examined(NoiseStatement::Std, |i, e| {
        if i == 12 {
            let size = e.response[1].value.norm();
            e.response[2].value += 0.02 * size;
        }
    });
    let pattern = &discrepancy.patterns[0];
    let hertz = experiments[12].omega_rad_s / std::f64::consts::TAU;
    assert_eq!((pattern.count, pattern.harmonics.as_slice()), (1, &[2][..]));
    let [low, high] = pattern.frequencies_hz.unwrap();
    assert!((low - hertz).abs() < 1e-9 * hertz && (high - hertz).abs() < 1e-9 * hertz);
    assert_eq!(pattern.magnitudes, Some([experiments[12].magnitude; 2]));
}
