//! An answer on one screen of a terminal: the verdict, what it rests on, what to do, and the
//! verdict again, where the eye is when the command has ended.

use anstyle::{AnsiColor, Style};
use servoscope_core::answers::{Answer, Diagnosis, Verdict};
use servoscope_core::effects::fit_words;

use super::brief::{self, Judgement, Mark, Units, judgement};
use super::size;
use super::words::{confidence, effect, parameter_name, probability, sentence};

/// Lines of all, at most.
const MOST_LINES: usize = 40;

/// Columns of the names of the parts, and of the space before them.
const NAMES: usize = 13;

/// Limitations that are told; the rest is counted.
const MOST_LIMITS: usize = 2;

/// Writes an answer in at most 40 lines of `width` columns, 60 at least. Headings are bold and the
/// verdict has a colour, as escape sequences; whoever prints it takes them out where they are of
/// no use.
pub fn summary(answer: &Answer, width: usize) -> String {
    let width = width.max(60);
    let verdict = verdict(&judgement(answer), width);
    let mut lines: Vec<String> =
        parts(answer).into_iter().flat_map(|(name, texts)| part(name, &texts, width)).collect();
    // Two verdicts, an empty line beside each, and the line that says how to see more.
    let room = MOST_LINES - 2 * verdict.lines().count() - 3;
    if lines.len() > room {
        lines.truncate(room - 1);
        lines.push(format!("{:NAMES$}…", ""));
    }
    lines.push(format!("{:NAMES$}Everything: --full. As a page: --report FILE.", ""));
    format!("{verdict}\n\n{}\n\n{verdict}\n", lines.join("\n"))
}

/// The verdict of an answer in one line: its word, and what it means.
pub fn headline(answer: &Answer) -> String {
    judgement(answer).headline()
}

fn verdict(judgement: &Judgement, width: usize) -> String {
    let colour = match judgement.mark {
        Mark::Good => AnsiColor::Green,
        Mark::Part => AnsiColor::Yellow,
        Mark::Bad => AnsiColor::Red,
        Mark::Open => AnsiColor::Cyan,
    };
    let style = Style::new().bold().fg_color(Some(colour.into()));
    let word = judgement.word.to_uppercase();
    let text = wrapped(&format!("{word}: {}", judgement.text), width).join("\n");
    text.replacen(&word, &format!("{style}{word}{style:#}"), 1)
}

type Part = (&'static str, Vec<String>);

/// Every part, the most important first: the last are those that go where there is no room.
fn parts(answer: &Answer) -> Vec<Part> {
    let units = Units::of(answer.base());
    let mut parts: Vec<Part> = vec![("Measurement", brief::suspicions(answer))];
    if let Some(diagnosis) = answer.diagnosis() {
        parts.extend(found(diagnosis, units));
    }
    parts.push(("Next", brief::next(answer, units)));
    let model = answer.model();
    let names: Vec<(String, String)> = model
        .parameters
        .iter()
        // Those of causes are told with them.
        .filter(|(id, _)| !id.contains('.'))
        .map(|(id, estimate)| (parameter_name(id), size::with_interval(estimate)))
        .collect();
    parts.push(("Axis", columns(&names)));
    let left = super::words::per_cent(model.fit.nrmse, 3);
    let each = model
        .fit
        .chi2_per_dof
        .map(|each| format!(", χ² {} per degree of freedom", super::number::significant(each, 3)));
    parts.push(("Residual", vec![format!("{left} of the response{}", each.unwrap_or_default())]));
    parts.push(("Caveats", limits(answer)));
    parts.retain(|(_, texts)| !texts.is_empty());
    parts
}

fn found(answer: &Diagnosis, units: Units<'_>) -> Vec<Part> {
    let mut parts: Vec<Part> = Vec::new();
    let model = answer.extended.as_ref().unwrap_or(&answer.base);
    for cause in &answer.causes {
        let mut texts = vec![format!(
            "{} ({}), confidence {} ({})",
            effect(&cause.effect),
            cause.effect,
            probability(cause.confidence),
            confidence(cause.confidence)
        )];
        let values: Vec<(String, String)> = size::values(cause)
            .into_iter()
            .map(|(name, value)| (fit_words(&name, units.input, units.response), value))
            .collect();
        texts.extend(columns(&values));
        texts.extend(size::in_the_machine(cause, model));
        texts.extend((answer.causes.len() == 1).then(|| brief::meaning(cause, units)));
        texts.extend(brief::equivalents(cause));
        parts.push((brief::title(cause), texts));
    }
    if let Some(gain) = &answer.gain {
        let (factor, is_sure) = brief::factor(gain);
        let chance = if is_sure { "" } else { ", which may be chance" };
        parts.push((
            "Improvement",
            vec![format!(
                "{factor} ({}){chance}: {} of the response, on held-out data",
                brief::interval(gain),
                brief::before_and_after(gain)
            )],
        ));
    }
    let name = if answer.verdict == Verdict::Adequate { "Sensitivity" } else { "Where" };
    // That nothing could be tested is the verdict itself.
    if answer.is_tested() {
        parts.push((name, vec![sentence(&answer.discrepancy.sentence)]));
    }
    parts
}

fn limits(answer: &Answer) -> Vec<String> {
    let of_diagnosis = answer.diagnosis().map_or(&[][..], |answer| &answer.limitations);
    let all: Vec<&String> = of_diagnosis.iter().chain(&answer.model().limitations).collect();
    let told = all.iter().take(MOST_LIMITS).map(|text| sentence(text));
    let rest = all.len().saturating_sub(MOST_LIMITS);
    let rest = (rest > 0).then(|| format!("{rest} more with --full."));
    told.chain(rest).collect()
}

/// Names and values below each other.
fn columns(rows: &[(String, String)]) -> Vec<String> {
    let widest = rows.iter().map(|(name, _)| name.chars().count()).max().unwrap_or(0);
    rows.iter().map(|(name, value)| format!("{name:widest$}  {value}")).collect()
}

/// A part: its name, and its texts beside it.
fn part(name: &str, texts: &[String], width: usize) -> Vec<String> {
    let style = Style::new().bold();
    let lines = texts.iter().flat_map(|text| wrapped(text, width - NAMES));
    let line = |(i, line): (usize, String)| match i {
        0 => format!("{style}{name}{style:#}{:space$}{line}", "", space = NAMES - name.len()),
        _ => format!("{:NAMES$}{line}", ""),
    };
    lines.enumerate().map(line).collect()
}

/// A text in lines of at most so many columns, broken at spaces; a word that is longer stands
/// alone. Signs are those that a keyboard has, for whoever copies a number.
pub(super) fn wrapped(text: &str, width: usize) -> Vec<String> {
    let text = text.replace('−', "-").replace(" %", "\u{a0}%");
    let indent: String = text.chars().take_while(|c| *c == ' ').collect();
    let mut lines: Vec<String> = Vec::new();
    let mut line = indent.clone();
    let mut length = indent.chars().count();
    for word in text[indent.len()..].split(' ') {
        let more = word.chars().count();
        let is_empty = line.trim().is_empty();
        if !is_empty && length + 1 + more > width {
            lines.push(line.trim_end().to_owned());
            line = format!("{indent}{word}");
            length = indent.len() + more;
        } else {
            let space = if is_empty && length == indent.len() { "" } else { " " };
            line.push_str(space);
            line.push_str(word);
            length += space.len() + more;
        }
    }
    lines.push(line.trim_end().to_owned());
    lines.into_iter().map(|line| line.replace('\u{a0}', " ")).collect()
}

#[cfg(test)]
mod tests {
    use servoscope_core::answers::{ReadingDoubt, sample};

    use super::*;

    /// A text without its escape sequences.
    fn plain(text: &str) -> String {
        let mut parts = text.split('\u{1b}');
        let first = parts.next().unwrap_or_default().to_owned();
        parts.fold(first, |text, part| text + part.split_once('m').map_or("", |(_, rest)| rest))
    }

    fn answers() -> Vec<Answer> {
        let mut gained = sample::explained();
        gained.gain = Some(sample::gain());
        let mut many = gained.clone();
        many.causes = vec![many.causes[0].clone(); 5];
        many.limitations = vec!["a limitation that is told in many words".repeat(9); 7];
        vec![
            sample::identification().into(),
            sample::diagnosis().into(),
            sample::mended().into(),
            gained.into(),
            many.into(),
        ]
    }

    #[test]
    fn an_answer_takes_forty_lines_and_is_as_wide_as_the_terminal() {
        for answer in answers() {
            for width in [60, 80, 100] {
                let text = plain(&summary(&answer, width));
                let lines: Vec<&str> = text.lines().collect();
                assert!(lines.len() <= 40, "{} lines: {text}", lines.len());
                let widest = lines.iter().map(|line| line.chars().count()).max().unwrap();
                assert!(widest <= width, "{widest} columns: {text}");
            }
        }
    }

    #[test]
    fn the_verdict_comes_first_and_last() {
        for answer in answers() {
            let text = plain(&summary(&answer, 100));
            let (first, _) = text.split_once("\n\n").unwrap();
            assert!(text.ends_with(&format!("\n\n{first}\n")), "{text}");
            assert!(first.starts_with(&judgement(&answer).word.to_uppercase()), "{text}");
        }
    }

    #[test]
    fn a_cause_a_fault_and_the_gain_are_told() {
        let text = plain(&summary(&answers()[3], 100));
        for part in [
            "Cause        static friction (static_friction), confidence 93 % (very likely)",
            "static friction forwards   0.8014 ± 0.0065 A",
            "Improvement  residual ÷ 3.15 (95 % interval 2.71 to 3.64)",
            "cannot tell it from Stribeck friction or presliding",
            "--full",
        ] {
            assert!(text.contains(part), "{part}: {text}");
        }
        let text = plain(&summary(&answers()[2], 100));
        assert!(text.contains("Measurement  Line 153 (harmonic 1"), "{text}");
    }

    #[test]
    fn what_looks_wrong_with_the_measurement_comes_before_the_model() {
        let mut doubted = sample::identification();
        doubted.doubts = vec![ReadingDoubt {
            check: "rising_phase".into(),
            sentence: "the phase rises".into(),
            remedy: "change its sign".into(),
        }];
        let text = plain(&summary(&doubted.into(), 100));
        let place = |part: &str| text.find(part).unwrap_or_else(|| panic!("{part}: {text}"));
        assert!(place("The phase rises. To do: change its sign.") < place("Axis"), "{text}");
    }

    #[test]
    fn a_text_is_broken_at_spaces_and_keeps_its_indent() {
        assert_eq!(wrapped("one two three", 8), ["one two", "three"]);
        assert_eq!(wrapped("  one two three", 9), ["  one two", "  three"]);
        assert_eq!(wrapped("incomprehensible yes", 5), ["incomprehensible", "yes"]);
        assert_eq!(wrapped("a  b", 9), ["a  b"]);
        assert_eq!(wrapped("−1\u{a0}A is 66 %", 8), ["-1 A is", "66 %"]);
    }
}
