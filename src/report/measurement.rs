//! Faults of the measurement, as a diagnosis found them.

use servoscope_core::answers::{AsMeasured, Diagnosis};

use super::brief;
use super::number::significant;
use super::text::section;

/// The section on faults of the measurement; none where it has none.
pub(super) fn section_of(answer: &Diagnosis) -> Option<String> {
    let mut lines = Vec::new();
    for fault in &answer.measurement {
        lines.push(format!("- {}", fault.sentence));
        lines.push(format!("  to correct it: {}", fault.remedy));
    }
    lines.extend(without(answer));
    lines.extend(brief::rival_faults(answer).map(|text| format!("- {text}")));
    (!lines.is_empty()).then(|| section("Faults of the measurement", lines))
}

/// What the answer is without the faults and what it would be with them, in one sentence each.
pub(super) fn without(answer: &Diagnosis) -> Vec<String> {
    let Some(as_measured) = answer.as_measured.as_ref() else { return Vec::new() };
    let best = answer.extended.as_ref().unwrap_or(&answer.base);
    let causes: Vec<&str> = answer.causes.iter().map(|cause| cause.effect.as_str()).collect();
    vec![
        format!("uncorrected: {}", left(as_measured)),
        format!("corrected: {}", one(&causes, answer.base.fit.nrmse, Some(best.fit.nrmse))),
        "to diagnose the measurement uncorrected, add --keep-all (the option keep_all)".to_owned(),
    ]
}

fn left(as_measured: &AsMeasured) -> String {
    let causes: Vec<&str> = as_measured.causes.iter().map(String::as_str).collect();
    one(&causes, as_measured.nrmse, as_measured.nrmse_with_causes)
}

fn one(causes: &[&str], base: f64, with: Option<f64>) -> String {
    let per_cent = |share: f64| format!("{} %", significant(100.0 * share, 3));
    let base = format!("the residual of the base model is {} of the response", per_cent(base));
    match (causes, with) {
        ([], _) | (_, None) => base,
        (causes, Some(with)) => {
            format!("{base}, with {} {}", causes.join(" and "), per_cent(with))
        }
    }
}

#[cfg(test)]
mod tests {
    use servoscope_core::answers::sample;

    use super::*;

    #[test]
    fn a_fault_is_told_with_what_mends_it_and_the_answer_with_and_without_it() {
        let text = section_of(&sample::mended()).unwrap();
        assert!(text.contains("line 153 (harmonic 1 at magnitude 2 and 3 Hz) is an outlier"));
        assert!(text.contains("to correct it: measure again what is listed"), "{text}");
        assert!(
            text.contains("uncorrected: the residual of the base model is 4.1 % of the response"),
            "{text}"
        );
        assert!(text.contains("\n  corrected: the residual of the base model is"), "{text}");
        assert!(text.contains("--keep-all"), "{text}");
        assert_eq!(section_of(&sample::diagnosis()), None);
    }
}
