//! The benchmark's report as text.

mod faults;

use std::fmt::Write as _;

use super::case::Kind;
use super::effect_draws::ids;
use super::judge::{Answer, Outcome};
use super::rate::Rate;
use super::rivals::Nearest;
use super::run::Unmade;
use super::summary::{Confusion, NONE, Summary, Wanted};

/// The tables of a summary as text.
pub fn summary_text(summary: &Summary) -> String {
    let mut text = String::from("Rates, with their 95 % intervals (Clopper–Pearson)\n");
    for line in &summary.lines {
        let level = line.level_db.map_or("all".to_owned(), |db| format!("{db} dB"));
        let (kind, share) = (line.kind.name(), interval(&line.rate));
        let asked = asked(&line.wanted, &line.rate);
        let row = format!("  {kind:<16} {level:<6} {:<45} {share:<38} {asked}", line.what);
        push(&mut text, row.trim_end());
    }
    effects(&mut text, summary);
    for confusion in &summary.confusions {
        confused(&mut text, confusion);
    }
    push(
        &mut text,
        "\nCauses of all draws by confidence: share that is right, and whether the mean",
    );
    push(&mut text, "confidence lies within its 95 % interval");
    for bin in &summary.calibration {
        let mean = bin.mean.map_or("–".to_owned(), |mean| format!("{mean:.3}"));
        let (from, to) = (bin.from, bin.to);
        let (share, asked) = (interval(&bin.right), asked(&bin.wanted, &bin.right));
        let within = match bin.calibrated {
            Some(true) => "within",
            Some(false) => "OUTSIDE",
            None => "",
        };
        let row = format!("  {from:<4} … {to:<4}  mean {mean:<6} {share:<38} {within:<7}  {asked}");
        push(&mut text, row.trim_end());
    }
    faults::faults(&mut text, summary);
    let (data, job) = (summary.data_seconds, summary.job_seconds);
    push(&mut text, "\nSeconds                median     p95");
    push(&mut text, &format!("  making a draw      {:>8.2} {:>8.2}", data.median, data.p95));
    push(&mut text, &format!("  diagnosing it      {:>8.2} {:>8.2}", job.median, job.p95));
    text
}

fn effects(text: &mut String, summary: &Summary) {
    if summary.effects.is_empty() {
        return;
    }
    push(text, "\nNamed first, by effect, kind, noise and excess χ²");
    let heads = ["all", "120 …", "1 200 …", "12 000 …"].map(|head| format!("{head:>9}")).concat();
    push(text, &format!("  {:<21} {:<16} {:<5} {heads}", "hidden", "kind", "dB"));
    for row in &summary.effects {
        let short = |rate: &Rate| match rate.of {
            0 => format!("{:>9}", "–"),
            of => format!("{:>9}", format!("{}/{of}", rate.hits)),
        };
        let decades = row.by_decade.iter().map(short).collect::<String>();
        let (effect, kind, level) = (row.effect, row.kind.name(), row.level_db);
        push(text, &format!("  {effect:<21} {kind:<16} {level:<5} {}{decades}", short(&row.all)));
    }
}

/// The confusion table. Columns have the numbers of the rows, since seventeen ids side by side are
/// too wide.
fn confused(text: &mut String, confusion: &Confusion) {
    if confusion.counts.is_empty() {
        return;
    }
    let level = confusion.level_db;
    push(text, &format!("\nHidden (rows) and first named (columns) at {level} dB"));
    let numbers: String = (1..=ids().len()).map(|number| format!("{number:>4}")).collect();
    push(text, &format!("  {:<27}{numbers}  none  other", "hidden"));
    let mut rows: Vec<&str> = ids();
    for (hidden, _) in confusion.counts.keys() {
        if !rows.contains(&hidden.as_str()) {
            rows.push(hidden);
        }
    }
    for (place, hidden) in rows.into_iter().enumerate() {
        let of_row = |named: &str| {
            let key = (hidden.to_owned(), named.to_owned());
            confusion.counts.get(&key).copied().unwrap_or_default()
        };
        let all: u32 =
            confusion.counts.iter().filter(|((row, _), _)| row == hidden).map(|(_, n)| n).sum();
        if all == 0 {
            continue;
        }
        let shown = |count: u32| if count == 0 { "·".to_owned() } else { count.to_string() };
        let cells: String = ids().iter().map(|id| format!("{:>4}", shown(of_row(id)))).collect();
        let known: u32 = ids().iter().map(|id| of_row(id)).sum::<u32>() + of_row(NONE);
        let number =
            if place < ids().len() { format!("{:>2}", place + 1) } else { "  ".to_owned() };
        let (none, other) = (shown(of_row(NONE)), shown(all - known));
        push(text, &format!("  {number} {hidden:<24}{cells}  {none:>4}  {other:>5}"));
    }
}

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

/// The target of a rate, and whether it is met.
fn asked(wanted: &Wanted, rate: &Rate) -> String {
    let share = match *wanted {
        Wanted::AtLeast(least) => format!("≥ {:.0} %", 100.0 * least),
        Wanted::AtMost(most) => format!("≤ {:.0} %", 100.0 * most),
        Wanted::Between([least, most]) => format!("{:.0}–{:.0} %", 100.0 * least, 100.0 * most),
        Wanted::Nothing => return String::new(),
    };
    let met = wanted.met_by(rate).map_or("", |met| if met { "met" } else { "MISSED" });
    format!("{share:<7} {met}")
}

fn interval(rate: &Rate) -> String {
    let Some(share) = rate.share() else { return "–".to_owned() };
    let [low, high] = rate.interval95().map(|bound| 100.0 * bound);
    let Rate { hits, of } = rate;
    format!("{hits:>4}/{of:<4} {:>5.1} % [{low:.1}, {high:.1}]", 100.0 * share)
}

fn push(text: &mut String, line: &str) {
    text.push_str(line);
    text.push('\n');
}

#[cfg(test)]
mod tests {
    use servoscope_core::answers::{FaultKind, MeasurementFault, Verdict};

    use super::super::fixtures::{machine, mistake, outcome};
    use super::super::mismeasured::Mismeasured;
    use super::super::mismeasurement::{Mismeasurement, Sort};
    use super::*;

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

    #[test]
    fn the_tables_say_what_is_met() {
        let outcomes = [
            outcome(
                "single-60-spring-o0-0",
                &["spring"],
                &[("spring", 1.0, &[])],
                Verdict::Explained,
            ),
            outcome(
                "single-60-spring-o0-1",
                &["spring"],
                &[("cogging", 0.85, &[])],
                Verdict::Improved,
            ),
            outcome("clean-60-o0-1", &[], &[], Verdict::Adequate),
            outcome("outsider-60-o0-1", &["cubic_drag"], &[], Verdict::Unexplained),
            outcome("analyser-70-o0-1", &[], &[], Verdict::Adequate),
        ];
        let text = summary_text(&Summary::of(&outcomes));
        let line = |parts: &[&str]| {
            let has = |line: &&str| parts.iter().all(|part| line.contains(part));
            assert!(text.lines().any(|line| has(&line)), "{parts:?} in\n{text}");
        };
        line(&["single", "named first", "1/2", "50.0 %", "≥ 95 %", "MISSED"]);
        line(&["clean", "all", "something named", "0/1", "≤ 2 %", "met"]);
        line(&["spring", "60", "1/2"]);
        line(&[
            "analyser",
            "all",
            "clean: a name, unexplained or no answer",
            "0/1",
            "≤ 2 %",
            "met",
        ]);
        line(&["cubic_drag", "1"]);
        line(&["0.99 … 1", "1.000", "1/1", "within"]);
        line(&["0.8  … 0.9", "0.850", "0/1", "75–95 %", "MISSED"]);
    }
}
