//! The part of the report on faults of measurements.

use super::{asked, interval, push};
use crate::naming::rate::Rate;
use crate::naming::summary::{FaultRates, Summary};

/// The faults by sort, if any were drawn, and the rates over all.
pub(super) fn faults(text: &mut String, summary: &Summary) {
    let faults = &summary.faults;
    if faults.lines.is_empty() {
        return;
    }
    push(text, "\nFaults of the measurement");
    if !faults.sorts.is_empty() {
        let heads = ["named", "another", "clean:", "clean: a", "effect", "… without"];
        push(text, &row("", heads.map(str::to_owned)));
        let heads = ["", "named", "adequate", "cause", "first", "the fault"];
        push(text, &row("fault", heads.map(str::to_owned)));
    }
    for rates in &faults.sorts {
        let FaultRates { sort, named, another, adequate, accused, .. } = rates;
        let counts = [named, another, adequate, accused, &rates.first, &rates.first_in_sound_twin];
        push(text, &row(sort.name(), counts.map(short)));
    }
    for line in &faults.lines {
        let (share, asked) = (interval(&line.rate), asked(&line.wanted, &line.rate));
        push(text, format!("  {:<55} {share:<38} {asked}", line.what).trim_end());
    }
}

fn row(head: &str, cells: [String; 6]) -> String {
    let cells: String = cells.iter().map(|cell| format!("{cell:>11}")).collect();
    format!("  {head:<22}{cells}")
}

fn short(rate: &Rate) -> String {
    match rate.of {
        0 => "–".to_owned(),
        of => format!("{}/{of}", rate.hits),
    }
}

#[cfg(test)]
mod tests {
    use servoscope_core::answers::{FaultKind, MeasurementFault, Verdict};

    use super::*;
    use crate::naming::Outcome;
    use crate::naming::fixtures::{mistake, outcome};
    use crate::naming::mismeasured::Mismeasured;
    use crate::naming::mismeasurement::{Mismeasurement, Sort};

    fn text(outcomes: &[Outcome]) -> String {
        let mut text = String::new();
        faults(&mut text, &Summary::of(outcomes));
        text
    }

    #[test]
    fn faults_have_a_table_and_rates_with_their_targets() {
        let skew = mistake(Sort::ChannelSkew, Mismeasurement::ChannelSkew { seconds: 1e-3 });
        let mismeasurement =
            Some(Mismeasured::of(&skew, &[MeasurementFault::of(FaultKind::ChannelSkew)]));
        let causes = [("spring", 0.9, &[][..])];
        let key = "mismeasured-60-spring-o0-12";
        let drawn = outcome(key, &["spring"], &causes, Verdict::Explained);
        let sound = Some(drawn.answer.clone());
        let text = text(&[Outcome { mismeasurement, sound, ..drawn }]);
        let line = |parts: &[&str]| {
            let has = |line: &&str| parts.iter().all(|part| line.contains(part));
            assert!(text.lines().any(|line| has(&line)), "{parts:?} in\n{text}");
        };
        line(&["channel_skew", "1/1", "0/1", "–", "1/1"]);
        line(&["fault named", "1/1", "100.0 %"]);
        line(&["effect first or an equivalent, if so without the fault", "≥ 95 %", "met"]);
    }

    #[test]
    fn of_sound_draws_alone_there_is_no_table() {
        let text = text(&[outcome("clean-60-o0-0", &[], &[], Verdict::Adequate)]);
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines.len(), 3, "{text}");
        assert!(lines[2].contains("sound draws of other kinds: a fault named"), "{text}");
        assert!(lines[2].ends_with("≤ 1 %   met"), "{text}");
    }
}
