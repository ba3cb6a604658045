//! Columns of text.

/// Which side of a column its cells stand on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Side {
    Left,
    Right,
    /// On the right, decimal points below each other.
    Point,
}

/// Lines of a table, columns two spaces apart.
pub(super) fn table(sides: &[Side], rows: &[impl AsRef<[String]>]) -> Vec<String> {
    let mut widths = vec![0; sides.len()];
    for row in rows {
        for (width, cell) in widths.iter_mut().zip(row.as_ref()) {
            *width = (*width).max(width_of(cell));
        }
    }
    let line = |row: &[String]| {
        let cells = row.iter().zip(sides).zip(&widths).map(|((cell, side), &width)| match side {
            Side::Left => format!("{cell:<width$}"),
            Side::Right | Side::Point => format!("{cell:>width$}"),
        });
        cells.collect::<Vec<_>>().join("  ").trim_end().to_owned()
    };
    rows.iter().map(|row| line(row.as_ref())).collect()
}

/// Makes the decimal points of numbers stand below each other: pads what is
/// right of the point, for a column whose cells stand on the right.
pub(super) fn align_points<'a>(cells: impl IntoIterator<Item = &'a mut String>) {
    let cells: Vec<&mut String> = cells.into_iter().collect();
    let behind = |cell: &str| cell.find('.').map_or(0, |point| width_of(&cell[point..]));
    let widest = cells.iter().map(|cell| behind(cell)).max().unwrap_or(0);
    for cell in cells {
        let missing = widest - behind(cell);
        cell.push_str(&" ".repeat(missing));
    }
}

fn width_of(text: &str) -> usize {
    text.chars().count()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_as_wide_as_their_widest_cell() {
        let rows = [["a", "1"], ["χ²", "100"]].map(|row| row.map(str::to_owned));
        assert_eq!(table(&[Side::Left, Side::Right], &rows), ["a     1", "χ²  100"]);
    }

    #[test]
    fn decimal_points_stand_below_each_other() {
        let mut cells = ["-10.25", "7", "0.125"].map(str::to_owned);
        align_points(&mut cells);
        let rows = cells.map(|cell| [cell]);
        assert_eq!(table(&[Side::Right], &rows), ["-10.25", "  7", "  0.125"]);
    }
}
