//! Single draws and their answers as text.

use std::fmt::Write as _;

use super::push;
use crate::naming::case::Kind;
use crate::naming::judge::{Answer, Outcome};
use crate::naming::rivals::Nearest;
use crate::naming::run::Unmade;

/// Lists every draw whose answer is not right, with the command that repeats it.
pub fn misses_text(outcomes: &[Outcome], unmade: &[Unmade], command: &str) -> String {
    let mut text = String::new();
    for kind in Kind::ALL {
        let missed = |outcome: &&Outcome| outcome.kind == kind && !outcome.is_right();
        let missed: Vec<&Outcome> = outcomes.iter().filter(missed).collect();
        if !missed.is_empty() {
            push(&mut text, &format!("\nMissed of the {} draws: {}", kind.name(), missed.len()));
        }
        for outcome in missed {
            push(&mut text, &case_text(outcome));
            push(&mut text, &format!("    {command} --case {}", outcome.key));
        }
    }
    if !unmade.is_empty() {
        push(&mut text, &format!("\nNot made: {}", unmade.len()));
    }
    for Unmade { key, reason } in unmade {
        push(&mut text, &format!("  {key}: {reason}"));
    }
    text
}

/// Describes a draw, its hidden effects and its answer in a few lines.
pub fn case_text(outcome: &Outcome) -> String {
    let verdict = match &outcome.answer {
        Ok(answer) => format!("{:?}", answer.verdict).to_lowercase(),
        Err(error) => format!("failed: {error}"),
    };
    let mut text = format!(
        "  {}: {}, order {}, excess {:.0}, {verdict}",
        outcome.key, outcome.instrument, outcome.order, outcome.excess
    );
    if let Some(dominance) = &outcome.dominance {
        let (share, left) = (100.0 * dominance.share(), dominance.chi2_per_dof);
        let _ = write!(text, "\n    dominant: {share:.1} % of it, χ² per dof {left:.1} left");
    }
    if let Some(mismeasurement) = &outcome.mismeasurement {
        let _ = write!(text, "\n    fault {}: {}", mismeasurement.sort.name(), mismeasurement.text);
        let shown = if mismeasurement.shows { "" } else { " (below the noise)" };
        text.push_str(shown);
        if let Some(left) = mismeasurement.left_by_own_model {
            let _ =
                write!(text, ", of which the machine's own model leaves {left:.1} without noise");
        }
    }
    for hidden in &outcome.hidden {
        let values = hidden.parameters.iter().map(|(name, value)| format!("{name} {value:.4}"));
        let values = values.collect::<Vec<_>>().join(", ");
        let small = if hidden.small { "small " } else { "" };
        let _ = write!(text, "\n    hidden {small}{}: {values}", hidden.effect);
        if outcome.hidden.len() > 1 {
            let circumstance =
                if outcome.dominance.is_some() { "alone" } else { "beside the other" };
            let _ = write!(text, " (excess {:.0} {circumstance})", hidden.excess);
        }
    }
    if let Some(Nearest { effect, excess }) = &outcome.nearest {
        let _ = write!(text, "\n    nearest {effect}: excess {excess:.1} without noise");
    }
    for cause in outcome.causes() {
        let value = |(name, value): (&String, &Option<f64>)| match value {
            Some(value) => format!("{name} {value:.4}"),
            None => format!("{name} –"),
        };
        let values = cause.parameters.iter().map(value).collect::<Vec<_>>().join(", ");
        let _ = write!(text, "\n    named {} at {:.3}: {values}", cause.effect, cause.confidence);
        if !cause.equivalents.is_empty() {
            let _ = write!(text, " (or {})", cause.equivalents.join(", "));
        }
    }
    if outcome.causes().is_empty() {
        text.push_str("\n    named nothing");
    }
    let faults = outcome.answer.as_ref().map_or(&[][..], |answer| &answer.faults);
    for fault in faults {
        let _ = write!(text, "\n    named the fault {}", fault.name());
    }
    if let Some(sound) = &outcome.sound {
        let _ = write!(text, "\n    without the fault: {}", sound_text(sound));
    }
    text
}

/// The verdict and the names of an answer.
fn sound_text(answer: &Result<Answer, String>) -> String {
    match answer {
        Err(error) => format!("failed: {error}"),
        Ok(answer) => {
            let verdict = format!("{:?}", answer.verdict).to_lowercase();
            let causes = answer.causes.iter().map(|cause| cause.effect.as_str());
            let faults = answer.faults.iter().map(|fault| fault.name());
            [verdict.as_str()]
                .into_iter()
                .chain(causes)
                .chain(faults)
                .collect::<Vec<_>>()
                .join(", ")
        }
    }
}

#[cfg(test)]
mod tests {
    use servoscope_core::answers::{FaultKind, MeasurementFault, Verdict};

    use super::*;
    use crate::naming::fixtures::{machine, mistake, outcome};
    use crate::naming::mismeasured::Mismeasured;
    use crate::naming::mismeasurement::{Mismeasurement, Sort};

    #[test]
    fn every_miss_is_listed_with_the_command_that_repeats_it() {
        let wrong = [("cogging", 0.85, &["spring"][..])];
        let nearest = Some(Nearest { effect: "hardening_spring".into(), excess: 2.34 });
        let missed = outcome("single-60-spring-o0-0", &["spring"], &wrong, Verdict::Improved);
        let outcomes = [
            Outcome { nearest, ..missed },
            outcome(
                "single-60-spring-o0-1",
                &["spring"],
                &[("spring", 1.0, &[])],
                Verdict::Explained,
            ),
        ];
        let unmade = [Unmade { key: "pair-60-o0-0".into(), reason: "no such excess".into() }];
        let text = misses_text(&outcomes, &unmade, "servoscope benchmark --seed 3");
        for part in [
            "Missed of the single draws: 1",
            "60 dB (std), order 0, excess 1000, improved",
            "hidden spring: amplitude 1.0000",
            "nearest hardening_spring: excess 2.3 without noise",
            "named cogging at 0.850",
            "(or spring)",
            "servoscope benchmark --seed 3 --case single-60-spring-o0-0",
            "pair-60-o0-0: no such excess",
        ] {
            assert!(text.contains(part), "{part} in\n{text}");
        }
        assert!(!text.contains("spring-o0-1"), "{text}");
    }

    #[test]
    fn a_machine_is_described_by_what_dominates_it_and_what_is_small() {
        let hidden = ["spring", "stribeck", "cubic_drag"];
        let text = case_text(&machine("machine-60-spring-o0-0", 1, &hidden, &[]));
        for part in [
            "dominant: 95.0 % of it, χ² per dof 2.5 left",
            "hidden spring: amplitude 1.0000",
            "hidden small stribeck: amplitude 1.0000",
            "(excess 1000 alone)",
        ] {
            assert!(text.contains(part), "{part} in\n{text}");
        }
    }

    #[test]
    fn a_fault_is_described_with_the_answer_and_that_without_it() {
        let fault = mistake(Sort::Conjugated, Mismeasurement::Conjugated);
        let named = [MeasurementFault::of(FaultKind::ReversedSign)];
        let mismeasurement = Some(Mismeasured { shows: false, ..Mismeasured::of(&fault, &named) });
        let mut drawn = outcome("mismeasured-60-o0-7", &[], &[], Verdict::Unexplained);
        let sound =
            outcome("clean-60-o0-7", &[], &[("spring", 0.9, &[])], Verdict::Improved).answer;
        if let Ok(answer) = &mut drawn.answer {
            answer.faults.push(FaultKind::ReversedSign);
        }
        let text = case_text(&Outcome { mismeasurement, sound: Some(sound), ..drawn });
        for part in [
            "fault conjugated: imaginary parts with the wrong sign (below the noise)",
            "named the fault reversed_sign",
            "without the fault: improved, spring",
        ] {
            assert!(text.contains(part), "{part} in\n{text}");
        }
    }
}
