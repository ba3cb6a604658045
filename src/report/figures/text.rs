//! Text as it takes space: a figure has no font to ask.

use crate::report::number;

/// Advance of a character over the font size, as in wide sans-serif fonts: a
/// text may turn out narrower, hardly wider.
fn advance(character: char) -> f64 {
    match character {
        'i' | 'j' | 'l' | '\'' | '|' | '.' | ',' | ':' | ';' | '!' | ' ' | '·' => 0.32,
        'f' | 't' | 'r' | '(' | ')' | '[' | ']' | '/' | '-' | '⁺' | '⁻' | '¹' => 0.42,
        'm' | 'w' | 'M' | 'W' | '%' | '@' | '—' | '…' => 0.95,
        'A'..='Z' | 'Δ' | '±' | '−' | '→' => 0.72,
        _ => 0.6,
    }
}

/// Width of a text, pixels.
pub(super) fn width(text: &str, size: f64) -> f64 {
    text.chars().map(advance).sum::<f64>() * size
}

/// Lines of words that fit into a width; the last of `most` ends in an ellipsis
/// where there would be more.
pub(super) fn wrap(text: &str, size: f64, room: f64, most: usize) -> Vec<String> {
    let mut lines: Vec<String> = vec![String::new()];
    for word in text.split_whitespace() {
        let line = lines.last_mut().expect("at least one line");
        let longer = if line.is_empty() { word.to_owned() } else { format!("{line} {word}") };
        if width(&longer, size) <= room {
            *line = longer;
        } else if line.is_empty() {
            *line = shorten(word, size, room);
        } else {
            lines.push(shorten(word, size, room));
        }
    }
    if lines.len() > most {
        lines.truncate(most);
        let last = lines.last_mut().expect("at least one line");
        *last = shorten(&format!("{last} …………"), size, room).replace("…………", "…");
    }
    lines
}

/// A text cut to a width.
pub(super) fn shorten(text: &str, size: f64, room: f64) -> String {
    if width(text, size) <= room {
        return text.to_owned();
    }
    let mut left = room - width("…", size);
    let fits = text.chars().take_while(|character| {
        left -= advance(*character) * size;
        left >= 0.0
    });
    let cut: String = fits.collect();
    format!("{}…", cut.trim_end().trim_end_matches('…'))
}

/// A number with at most so many significant digits and a true minus sign.
pub(super) fn number(value: f64, digits: usize) -> String {
    let text = number::significant(value, digits).replace('-', "−");
    match text.split_once('e') {
        Some((mantissa, power)) => format!("{mantissa}·10{}", superscript(power)),
        None => text,
    }
}

/// The digits of an exponent as superscripts.
pub(in crate::report) fn superscript(text: &str) -> String {
    const DIGITS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    let raise = |character: char| match character {
        '-' | '−' => '⁻',
        digit => digit.to_digit(10).map_or(digit, |digit| DIGITS[digit as usize]),
    };
    text.chars().map(raise).collect()
}

/// A number with its unit, where there is one.
pub(super) fn quantity(value: f64, digits: usize, unit: &str) -> String {
    let space = if unit.is_empty() { "" } else { " " };
    format!("{}{space}{unit}", number(value, digits))
}

/// Moves positions apart to `spacing`, each as little as the order allows, and
/// into the range from `low` to `high` where that has room.
pub(super) fn dodge(positions: &mut [f64], spacing: f64, low: f64, high: f64) {
    let mut order: Vec<usize> = (0..positions.len()).collect();
    order.sort_by(|a, b| positions[*a].total_cmp(&positions[*b]));
    let mut previous = f64::NEG_INFINITY;
    for &i in &order {
        positions[i] = positions[i].max(previous + spacing).max(low);
        previous = positions[i];
    }
    let mut next = f64::INFINITY;
    for &i in order.iter().rev() {
        positions[i] = positions[i].min(next - spacing).min(high);
        next = positions[i];
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_text_is_wrapped_and_what_does_not_fit_is_cut() {
        let lines = wrap("one two three four", 10.0, width("one two", 10.0), 9);
        assert_eq!(lines, ["one two", "three", "four"]);
        let cut = wrap("one two three four", 10.0, width("one two", 10.0), 2);
        assert_eq!(cut.len(), 2);
        assert!(cut[1].ends_with('…'), "{cut:?}");
        let long = wrap(&"x".repeat(100), 10.0, 60.0, 1);
        assert!(width(&long[0], 10.0) <= 60.0 && long[0].ends_with('…'));
    }

    #[test]
    fn labels_that_would_meet_are_moved_apart_within_their_range() {
        let mut positions = [50.0, 52.0, 99.0, 51.0];
        dodge(&mut positions, 12.0, 0.0, 100.0);
        assert_eq!(positions, [50.0, 74.0, 99.0, 62.0]);
        let mut low = [95.0, 99.0];
        dodge(&mut low, 12.0, 0.0, 100.0);
        assert_eq!(low, [88.0, 100.0]);
    }

    #[test]
    fn numbers_have_true_minus_signs_and_powers() {
        assert_eq!(number(-0.25, 3), "−0.25");
        assert_eq!(number(1.5e-7, 3), "1.5·10⁻⁷");
        assert_eq!(quantity(2.0, 3, "A"), "2 A");
        assert_eq!(quantity(2.0, 3, ""), "2");
    }
}
