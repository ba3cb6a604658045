//! The benchmark's report as text.

mod faults;
mod outcomes;

use super::effect_draws::ids;
use super::rate::Rate;
use super::summary::{Confusion, NONE, Summary, Wanted};
pub use outcomes::{case_text, misses_text};

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
    use servoscope_core::answers::Verdict;

    use super::super::fixtures::outcome;
    use super::*;

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
