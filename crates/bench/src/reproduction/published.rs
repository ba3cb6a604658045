//! Values published in the paper: Tables II and III and the times of Figure 14, misprints included.

use servoscope_core::answers::Method;
use servoscope_core::measurement::Complex;

use super::system::System;

/// The columns of the tables, and the corresponding method of this program.
pub const COLUMNS: [(&str, Method); 5] = [
    ("existing [2]", Method::TwoMagnitude),
    ("hybrid [26]", Method::GaAnn),
    ("adaptive hybrid [36]", Method::AgaAnn),
    ("PSO-ANN", Method::PsoAnn),
    ("ABC-ANN", Method::AbcAnn),
];

/// A row of a table: its name, and the target and the columns as printed.
#[derive(Debug, Clone, Copy)]
pub(super) struct Row {
    pub name: &'static str,
    pub target: &'static str,
    pub columns: [&'static str; 5],
    /// What is wrong in the row, if anything.
    pub misprint: Option<&'static str>,
}

const fn row(
    name: &'static str,
    target: &'static str,
    columns: [&'static str; 5],
    misprint: Option<&'static str>,
) -> Row {
    Row { name, target, columns, misprint }
}

const TABLE_II: [Row; 5] = [
    row("pole", "-10", ["-10.1", "-10.2", "-10.0000", "-10.0006", "-10.0004"], None),
    row("constant", "10", ["10.1", "9.8", "10.0000", "10.0004", "10.0002"], None),
    row(
        "DC gain",
        "1",
        ["0.9", "1.0", "1.0000", "1.0008", "0.9999"],
        Some(
            "the DC gain is constant/−pole: by the rows above it would be 1.0 (existing), 1.0000 \
             (PSO-ANN) and 1.0000 (ABC-ANN)",
        ),
    ),
    row("Fc⁺", "0.5", ["0.4", "0.5", "0.5", "0.4995", "0.5"], None),
    row("Fc⁻", "0.4", ["0.3", "0.3", "0.4", "0.4", "0.4"], None),
];

const TABLE_III: [Row; 6] = [
    row(
        "root 1",
        "-2.5+31.52i",
        [
            "-2.5714+30.525i",
            "-2.5381+31.518i",
            "-2.5009+31.5200i",
            "-2.5004+31.5143i",
            "-2.5003+31.5213i",
        ],
        Some("the roots of equation 13 are −2.5 ± 31.5238i, not ± 31.52i"),
    ),
    row(
        "root 2",
        "-2.5-31.52i",
        [
            "-2.5714-30.525i",
            "-2.5381-31.518i",
            "-2.5011-31.5190i",
            "-2.501-31.5034i",
            "2.501-31.5032i",
        ],
        Some(
            "of a real system root 2 is the conjugate of root 1, which it is in the first two \
             columns alone; in that of ABC-ANN its sign is lost too",
        ),
    ),
    row("root 3", "-10", ["-10.1138", "-10.0211", "-10.0015", "-10.0002", "-10.0002"], None),
    row("DC gain", "1", ["0.9903", "0.9989", "1.0000", "1.0000", "1.0000"], None),
    row("Fc⁺", "0.5", ["0.4951", "0.4968", "0.4992", "0.5000", "0.5000"], None),
    row("Fc⁻", "0.4", ["0.3941", "0.3957", "0.4000", "0.4000", "0.4000"], None),
];

/// The rows of the table of a system, except N_T.
pub(super) fn table(system: System) -> &'static [Row] {
    match system {
        System::G1 => &TABLE_II,
        System::G2 => &TABLE_III,
    }
}

/// Times of Figure 14 as given in the text, s: hybrid, adaptive hybrid, PSO-ANN and ABC-ANN, in the
/// order of [`COLUMNS`] without the first.
pub fn seconds(system: System) -> [f64; 4] {
    match system {
        System::G1 => [70.587423, 70.136149, 68.649127, 62.851630],
        System::G2 => [72.158796, 71.959824, 69.568315, 64.175593],
    }
}

/// A printed number: its value, and the number of decimals of its real and imaginary part.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Printed {
    pub value: Complex,
    decimals: [usize; 2],
}

impl Printed {
    /// Reads numbers such as `-10.1` and `-2.5+31.52i`.
    ///
    /// # Panics
    /// On any other text. Only the tables above are read.
    pub fn read(text: &str) -> Self {
        let number = |text: &str| text.parse::<f64>().expect("a printed number");
        let decimals = |text: &str| text.split_once('.').map_or(0, |(_, after)| after.len());
        let Some(complex) = text.strip_suffix('i') else {
            return Self { value: Complex::new(number(text), 0.0), decimals: [decimals(text), 0] };
        };
        let sign = complex.rfind(['+', '-']).expect("two parts");
        let (re, im) = complex.split_at(sign);
        Self { value: Complex::new(number(re), number(im)), decimals: [decimals(re), decimals(im)] }
    }

    /// A value rounded to the digits that were printed.
    pub fn round(&self, value: Complex) -> Complex {
        let round = |x: f64, decimals: usize| {
            let scale = 10.0_f64.powi(decimals as i32);
            (x * scale).round() / scale
        };
        Complex::new(round(value.re, self.decimals[0]), round(value.im, self.decimals[1]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_printed_number_is_read_with_its_digits() {
        for system in System::ALL {
            for row in table(system) {
                let printed = row.columns.iter().chain([&row.target]).map(|text| {
                    let printed = Printed::read(text);
                    (printed, printed.round(printed.value))
                });
                printed.for_each(|(printed, rounded)| assert_eq!(printed.value, rounded));
            }
        }
        let root = Printed::read("-2.501-31.5034i");
        assert_eq!((root.value.re, root.value.im, root.decimals), (-2.501, -31.5034, [3, 4]));
        assert_eq!(root.round(Complex::new(-2.50049, -31.52376)), Complex::new(-2.5, -31.5238));
    }
}
