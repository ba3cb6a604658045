//! Where the simulation is wrong: residuals in standard deviations.

mod lines;
mod map;

use servoscope_core::answers::{Comparison, Pattern};

use super::canvas::{Anchor, Canvas, Font, MARGIN, WIDTH};
use super::series::{counted, has_many_lines, left_out, sigmas};
use super::text::{self, number};
use super::{NothingToDraw, Subject, comparison};

/// Patterns marked: more would hide what they mark.
const MOST_PATTERNS: usize = 6;

/// Residuals above this many standard deviations are hardly noise.
const LARGE: f64 = 3.0;

const BADGE: Font = Font { size: 11.0, class: "badge-text" };
const SENTENCE: Font = Font { size: 12.5, class: "" };

pub(super) fn draw(subject: &Subject<'_>) -> Result<Canvas, NothingToDraw> {
    let comparison = comparison(subject)?;
    let patterns = subject.discrepancy.map_or(&[][..], |discrepancy| &discrepancy.patterns);
    let patterns = &patterns[..patterns.len().min(MOST_PATTERNS)];
    let harmonics = || comparison.experiments.iter().flat_map(|e| &e.harmonics);
    if harmonics().all(|harmonic| sigmas(harmonic).is_none()) {
        let reason = "nothing is known of the noise, and the residual is zero";
        return Err(NothingToDraw(reason.into()));
    }
    let says = match (patterns, subject.discrepancy) {
        ([], Some(discrepancy)) => discrepancy.sentence.clone(),
        ([], None) => says(comparison),
        // What each is stands below.
        (patterns, _) => shares(patterns),
    };
    let series = comparison.experiments.len().min(lines::MOST_PANELS);
    let title = subject.titled("Residual in standard deviations");
    let mut canvas = Canvas::new("residuals", &title, &says, series);
    if has_many_lines(comparison) {
        lines::draw(&mut canvas, comparison, patterns);
    } else {
        map::draw(&mut canvas, comparison, patterns);
    }
    sentences(&mut canvas, patterns);
    if comparison.std_estimated {
        canvas.note("The noise is not known: a standard deviation is that of the residual itself.");
    }
    if let Some(sentence) = left_out(comparison) {
        canvas.note(&sentence);
    }
    Ok(canvas)
}

fn says(comparison: &Comparison) -> String {
    let harmonics = comparison.experiments.iter().flat_map(|e| &e.harmonics);
    let sizes: Vec<f64> = harmonics.filter_map(sigmas).collect();
    let large = sizes.iter().filter(|size| **size > LARGE).count();
    let largest = sizes.iter().copied().fold(0.0, f64::max);
    let rms = (sizes.iter().map(|size| size * size).sum::<f64>() / sizes.len() as f64).sqrt();
    format!(
        "{} of {} beyond {LARGE} standard deviations; the largest is {}, the root mean square {} \
         (noise alone: 1).",
        large,
        counted(sizes.len(), "residual", "residuals"),
        number(largest, 2),
        number(rms, 2)
    )
}

/// How much of the excess χ² lies in each pattern.
fn shares(patterns: &[Pattern]) -> String {
    let share = |(i, pattern): (usize, &Pattern)| {
        let of = if i == 0 { " of the excess χ² lies in pattern" } else { " in" };
        format!("{:.0} %{of} {}", 100.0 * pattern.share, i + 1)
    };
    let shares: Vec<String> = patterns.iter().enumerate().map(share).collect();
    format!("{}.", shares.join(", "))
}

/// A numbered mark of a pattern.
fn badge(canvas: &mut Canvas, index: usize, [x, y]: [f64; 2]) {
    canvas.rectangle("badge", [x - 8.0, y - 8.0, x + 8.0, y + 8.0], "");
    canvas.text(x, y + 4.0, BADGE, Anchor::Middle, &(index + 1).to_string());
}

/// What each pattern means.
fn sentences(canvas: &mut Canvas, patterns: &[Pattern]) {
    for (index, pattern) in patterns.iter().enumerate() {
        badge(canvas, index, [MARGIN + 8.0, canvas.y + 10.0]);
        canvas.describe(&format!("Pattern {}: {}", index + 1, pattern.sentence));
        let room = WIDTH - 2.0 * MARGIN - 26.0;
        for line in text::wrap(&pattern.sentence, SENTENCE.size, room, 3) {
            canvas.text(MARGIN + 26.0, canvas.y + 14.0, SENTENCE, Anchor::Start, &line);
            canvas.y += 17.0;
        }
        canvas.y += 6.0;
    }
}

/// Whether a value lies in an optional range, both ends included.
fn within(range: Option<[f64; 2]>, value: f64) -> bool {
    // Ends are written by others, perhaps rounded.
    let slack = 1e-6 * value.abs();
    range.is_none_or(|[from, to]| value >= from - slack && value <= to + slack)
}
