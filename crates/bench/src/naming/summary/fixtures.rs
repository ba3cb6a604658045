//! Outcomes that the tests count.

use servoscope_core::answers::Verdict;

use crate::naming::fixtures::{machine, outcome};
use crate::naming::judge::Outcome;

/// Outcomes of several kinds of draws, right and wrong.
pub(super) fn outcomes() -> Vec<Outcome> {
    let explained = Verdict::Explained;
    vec![
        outcome("single-60-spring-o0-0", &["spring"], &[("spring", 0.995, &[])], explained),
        outcome("single-60-spring-o0-1", &["spring"], &[("cogging", 0.85, &[])], explained),
        outcome("single-40-spring-o0-0", &["spring"], &[], Verdict::Unexplained),
        outcome("clean-60-o0-0", &[], &[], Verdict::Adequate),
        outcome("clean-60-o1-1", &[], &[("stribeck", 0.85, &[])], Verdict::Improved),
        outcome(
            "pair-60-o0-0",
            &["spring", "stribeck"],
            &[("spring", 1.0, &[]), ("stribeck", 0.85, &[])],
            explained,
        ),
        outcome("outsider-60-o0-0", &["cubic_drag"], &[("spring", 0.95, &[])], explained),
        outcome("analyser-70-o0-0", &[], &[], Verdict::Unexplained),
        outcome("analyser-70-o1-1", &[], &[], Verdict::Adequate),
        outcome(
            "analyser-70-spring-o0-0",
            &["spring"],
            &[("hardening_spring", 0.4, &["spring"])],
            explained,
        ),
        outcome("analyser-70-spring-o1-1", &["spring"], &[("cogging", 0.4, &[])], explained),
        outcome("analyser-70-spring-o2-2", &["spring"], &[], Verdict::Unexplained),
    ]
}

/// Machines with small effects.
pub(super) fn machines() -> Vec<Outcome> {
    let hidden = ["spring", "stribeck", "cubic_drag", "cogging"];
    let of_one = |key: &str, causes| machine(key, 1, &hidden, causes);
    vec![
        of_one("machine-60-spring-o0-0", &[("spring", 0.9, &[]), ("stribeck", 0.6, &[])]),
        of_one("machine-50-spring-o0-0", &[("backlash", 0.85, &[]), ("spring", 0.4, &[])]),
        machine("machine-2-60-o0-0", 2, &hidden, &[("stribeck", 0.9, &[]), ("spring", 0.3, &[])]),
    ]
}
