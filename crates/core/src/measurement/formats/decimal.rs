//! Reads numbers with a decimal point or a decimal comma, and finds out which one a file has.

use super::fault::Fault;
use super::lack;

/// A decimal mark.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Mark {
    Point,
    Comma,
}

/// Where a mark was seen first: the line, and the number.
#[derive(Debug, Clone)]
struct Seen {
    line: u64,
    number: String,
}

/// Reads the numbers of one file, and keeps the evidence of its decimal mark.
///
/// `0,5` and `12,25` can only have a decimal comma. `1,234` may as well be one thousand two hundred
/// and thirty-four. A file in which nothing else is seen is refused.
#[derive(Debug, Default)]
pub(super) struct Decimals {
    stated: Option<Mark>,
    point: Option<Seen>,
    comma: Option<Seen>,
    /// Whether some comma can only be a decimal comma.
    decided: bool,
}

impl Decimals {
    /// A reader of numbers with the mark that the upload states, if it does.
    pub(super) fn new(stated: Option<Mark>) -> Self {
        Self { stated, ..Self::default() }
    }

    /// The number in a cell; `None` if it is blank.
    ///
    /// # Errors
    /// What is wrong with the cell.
    pub(super) fn number(&mut self, line: u64, cell: &str) -> Result<Option<f64>, String> {
        if cell.is_empty() {
            return Ok(None);
        }
        let seen = || Seen { line, number: shown(cell) };
        let wrong = || format!("`{}` is not a number", shown(cell));
        if !cell.contains(',') {
            let number = cell.parse().map_err(|_| wrong())?;
            if cell.contains('.') {
                if self.stated == Some(Mark::Comma) {
                    return Err(format!("{} with a decimal comma", wrong()));
                }
                self.point.get_or_insert_with(seen);
            }
            return Ok(Some(number));
        }
        if self.stated == Some(Mark::Point) {
            return Err(format!("{} with a decimal point", wrong()));
        }
        if cell.contains('.') || cell.matches(',').count() > 1 {
            return Err(format!("{}: export it without marks between thousands", wrong()));
        }
        let number = cell.replace(',', ".").parse().map_err(|_| wrong())?;
        self.decided |= is_decimal(cell);
        self.comma.get_or_insert_with(seen);
        Ok(Some(number))
    }

    /// The mark of the numbers that were read; `None` if all were integers.
    ///
    /// # Errors
    /// If the numbers have both marks, or a comma that may stand between thousands.
    pub(super) fn mark(&self) -> Result<Option<Mark>, Fault> {
        match (&self.point, &self.comma) {
            (Some(point), Some(comma)) => Err(Fault::new(format!(
                "`{}` in line {} has a comma and `{}` in line {} a point: write all numbers with \
                 the same decimal mark, and without marks between thousands",
                comma.number, comma.line, point.number, point.line
            ))
            .at_line(Some(comma.line.max(point.line)))),
            (None, Some(comma)) if !self.decided && self.stated.is_none() => {
                let lack = lack::ask("decimal", "comma");
                Err(Fault::new(format!(
                    "the comma of `{}` may be a decimal comma or stand between thousands: {lack}, \
                     or export the numbers without marks between thousands",
                    comma.number,
                ))
                .lacking(lack)
                .at_line(Some(comma.line)))
            }
            (None, Some(_)) => Ok(Some(Mark::Comma)),
            (Some(_), None) => Ok(Some(Mark::Point)),
            (None, None) => Ok(None),
        }
    }
}

/// Whether a cell is a number with either mark.
pub(super) fn is_number(cell: &str) -> bool {
    cell.parse::<f64>().is_ok() || cell.replacen(',', ".", 1).parse::<f64>().is_ok()
}

/// Whether the comma of a number can only be a decimal comma: thousands have one to three digits
/// before the comma, the first not 0, and three after it.
pub(super) fn is_decimal(number: &str) -> bool {
    let Some((before, after)) = number.split_once(',') else { return false };
    let before = before.trim_start_matches(['+', '-']);
    let thousands = (1..=3).contains(&before.len())
        && !before.starts_with('0')
        && after.len() == 3
        && after.bytes().all(|byte| byte.is_ascii_digit());
    !thousands
}

fn shown(cell: &str) -> String {
    cell.chars().take(40).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers of the cells, one a line, and the mark.
    fn read(stated: Option<Mark>, cells: &[&str]) -> Result<(Vec<f64>, Option<Mark>), String> {
        let mut decimals = Decimals::new(stated);
        let numbers = (1..).zip(cells).map(|(line, cell)| decimals.number(line, cell));
        let numbers: Vec<f64> =
            numbers.collect::<Result<Vec<_>, _>>()?.into_iter().flatten().collect();
        Ok((numbers, decimals.mark().map_err(|fault| fault.in_file("f").to_string())?))
    }

    #[test]
    fn a_comma_that_can_only_be_a_decimal_comma_decides_for_the_whole_file() {
        for deciding in ["0,125", "1,5", "-0,125", ",5", "1234,125", "1,234e3", "12,25"] {
            let (numbers, mark) = read(None, &["1,234", deciding, "", "7"]).unwrap();
            assert_eq!((numbers[0], mark), (1.234, Some(Mark::Comma)), "{deciding}");
        }
        assert_eq!(read(None, &["1.234", "7"]), Ok((vec![1.234, 7.0], Some(Mark::Point))));
        assert_eq!(read(None, &["1", "1e3"]), Ok((vec![1.0, 1000.0], None)));
    }

    #[test]
    fn a_comma_that_may_stand_between_thousands_is_refused_and_asked_for() {
        let refusal = read(None, &["7", "1,234", "-12,345"]).unwrap_err();
        assert!(refusal.contains("line 2") && refusal.contains("`1,234`"), "{refusal}");
        assert!(refusal.contains("--decimal comma"), "{refusal}");
        let (numbers, _) = read(Some(Mark::Comma), &["1,234"]).unwrap();
        assert_eq!(numbers, [1.234]);
    }

    #[test]
    fn two_marks_in_one_file_are_refused_with_both_lines() {
        let refusal = read(None, &["0,5", "0.5"]).unwrap_err();
        assert!(refusal.contains("line 1") && refusal.contains("line 2"), "{refusal}");
        assert!(read(None, &["1.234,5"]).unwrap_err().contains("thousands"));
        assert!(read(None, &["1,234,567"]).unwrap_err().contains("thousands"));
        assert!(read(Some(Mark::Comma), &["0.5"]).unwrap_err().contains("decimal comma"));
        assert!(read(Some(Mark::Point), &["0,5"]).unwrap_err().contains("decimal point"));
        assert!(read(None, &["O,5"]).unwrap_err().contains("not a number"));
    }
}
