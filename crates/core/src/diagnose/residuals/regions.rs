//! Spatial scan statistic over contiguous regions of magnitude × frequency × harmonic.
//!
//! All regions are scanned, as in Kulldorff's statistic (1997, doi:10.1080/03610929708831995), with
//! the variance of a normal law in place of a count. Sums over rectangles come from summed-area
//! tables (Crow 1984, doi:10.1145/964965.808600), so that a scan of some ten thousand regions costs
//! less than a simulation of one experiment.

use super::layout::{Cell, LAST_HARMONIC, Layout};

/// A region: ranges of magnitude classes and frequency bands (both ends included), and a set of
/// harmonics.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Region {
    /// First and last class of magnitude.
    pub magnitudes: (usize, usize),
    /// First and last band.
    pub bands: (usize, usize),
    /// Harmonics; if empty, every harmonic.
    pub harmonics: Vec<usize>,
}

impl Region {
    /// Whether a cell lies in it.
    pub fn holds(&self, cell: &Cell) -> bool {
        (self.magnitudes.0..=self.magnitudes.1).contains(&cell.magnitude)
            && (self.bands.0..=self.bands.1).contains(&cell.band)
            && (self.harmonics.is_empty() || self.harmonics.contains(&cell.harmonic))
    }
}

/// Summed-area tables of a quantity.
struct Sums {
    /// (magnitudes + 1) × (bands + 1) cumulated values, for each set of harmonics.
    tables: Vec<Vec<f64>>,
}

/// Every region of a layout.
pub(crate) struct Regions {
    /// Numbers of magnitude classes and bands.
    shape: (usize, usize),
    /// Sets of harmonics; the empty set stands for every harmonic.
    classes: Vec<Vec<usize>>,
    /// The sets that contain each harmonic.
    members: Vec<Vec<usize>>,
    /// Row, magnitude class, band and harmonic of each residual.
    places: Vec<(usize, usize, usize, usize)>,
    /// Normal approximation for each region, in the order of [`Regions::each`].
    normal: Vec<Normal>,
}

/// Wilson and Hilferty's normal approximation of a χ² S with n degrees of freedom (1931,
/// doi:10.1073/pnas.17.12.684): z = (S/n)^⅓·√(9n/2) − √(9n/2)·(1 − 2/(9n)), which is
/// slope·S^⅓ − offset.
#[derive(Debug, Clone, Copy)]
struct Normal {
    slope: f64,
    offset: f64,
    dof: f64,
}

/// Regions with fewer degrees of freedom are skipped: their residuals are fitted almost exactly.
const FEWEST_DOF: f64 = 0.5;

/// Degrees of freedom added to those of a region when regions are ranked, so that a few residuals
/// need a larger excess to be a pattern. Tuned.
const RANKING_EXTRA_DOF: f64 = 6.0;

impl Regions {
    /// All regions of a layout; `freedom` is 1 − leverage of each row.
    pub fn new(layout: &Layout, freedom: &[f64]) -> Self {
        let shape = (layout.magnitudes.len(), layout.bands.len());
        let classes = harmonic_classes(&layout.harmonics);
        let members = (0..=LAST_HARMONIC)
            .map(|h| {
                let holds = |set: &Vec<usize>| set.is_empty() || set.contains(&h);
                (0..classes.len()).filter(|c| holds(&classes[*c])).collect()
            })
            .collect();
        let place = |cell: &Cell| (cell.magnitude, cell.band, cell.harmonic);
        let places = layout
            .cells
            .iter()
            .flat_map(|cell| {
                let (m, b, h) = place(cell);
                cell.each_row().map(move |row| (row, m, b, h))
            })
            .collect();
        let mut regions = Self { shape, classes, members, places, normal: Vec::new() };
        let freedom = regions.sums(|row| freedom[row]);
        let mut normal = Vec::new();
        regions.each(&freedom, |_, dof| {
            let slope = (4.5 * dof.max(FEWEST_DOF)).sqrt();
            normal.push(Normal {
                slope: slope / dof.max(FEWEST_DOF).cbrt(),
                offset: slope - 1.0 / slope,
                dof,
            });
        });
        regions.normal = normal;
        regions
    }

    /// Largest normal score of any region; `squares` gives the squared residual of each row.
    pub fn largest_score(&self, squares: impl Fn(usize) -> f64) -> f64 {
        let sums = self.sums(squares);
        let mut best = f64::NEG_INFINITY;
        let mut at = 0;
        self.each(&sums, |_, sum| {
            let Normal { slope, offset, dof } = self.normal[at];
            at += 1;
            // Compare cubes: roots are far more expensive.
            let wanted = (best + offset) / slope;
            if dof >= FEWEST_DOF && (best.is_infinite() || sum > wanted * wanted * wanted) {
                best = slope * sum.max(0.0).cbrt() - offset;
            }
        });
        best
    }

    /// Normal score of a sum of squares that exceeds its degrees of freedom `dof` by `excess`.
    pub fn score_of(dof: f64, excess: f64) -> f64 {
        let slope = (4.5 * dof).sqrt();
        slope * (1.0 + excess / dof).cbrt() - slope + 1.0 / slope
    }

    /// The region of largest (S − n)/√(2n + 2·[`RANKING_EXTRA_DOF`]), with that score; S is the sum
    /// of `squares`, n that of `freedom`. Both are 0 in rows that a pattern already explains.
    pub fn most_conspicuous(
        &self,
        freedom: impl Fn(usize) -> f64,
        squares: impl Fn(usize) -> f64,
    ) -> Option<(Region, f64)> {
        let (freedom, squares) = (self.sums(freedom), self.sums(squares));
        let mut excesses = Vec::with_capacity(self.normal.len());
        self.each(&freedom, |_, dof| excesses.push(dof));
        let mut best: Option<(Corners, f64)> = None;
        let mut at = 0;
        self.each(&squares, |corners, sum| {
            let dof = excesses[at];
            at += 1;
            let score = (sum - dof) / (2.0 * (dof.max(0.0) + RANKING_EXTRA_DOF)).sqrt();
            if dof >= FEWEST_DOF && best.is_none_or(|(_, most)| score > most * (1.0 + 1e-9)) {
                best = Some((corners, score));
            }
        });
        best.map(|((class, m0, m1, b0, b1), score)| {
            let harmonics = self.classes[class].clone();
            (Region { magnitudes: (m0, m1), bands: (b0, b1), harmonics }, score)
        })
    }

    fn sums(&self, value: impl Fn(usize) -> f64) -> Sums {
        let (rows, columns) = (self.shape.0 + 1, self.shape.1 + 1);
        let mut tables = vec![vec![0.0; rows * columns]; self.classes.len()];
        for (row, m, b, h) in &self.places {
            for class in &self.members[*h] {
                tables[*class][(m + 1) * columns + b + 1] += value(*row);
            }
        }
        for table in &mut tables {
            for m in 1..rows {
                for b in 1..columns {
                    table[m * columns + b] += table[(m - 1) * columns + b]
                        + table[m * columns + b - 1]
                        - table[(m - 1) * columns + b - 1];
                }
            }
        }
        Sums { tables }
    }

    /// Calls `see` with every region and its sum, the widest set of harmonics and range first.
    fn each(&self, sums: &Sums, mut see: impl FnMut(Corners, f64)) {
        let columns = self.shape.1 + 1;
        for (class, table) in sums.tables.iter().enumerate() {
            for m0 in 0..self.shape.0 {
                for m1 in (m0..self.shape.0).rev() {
                    let (low, high) = (m0 * columns, (m1 + 1) * columns);
                    for b0 in 0..self.shape.1 {
                        for b1 in (b0..self.shape.1).rev() {
                            let sum = table[high + b1 + 1] - table[high + b0] - table[low + b1 + 1]
                                + table[low + b0];
                            see((class, m0, m1, b0, b1), sum);
                        }
                    }
                }
            }
        }
    }
}

/// Index of the set of harmonics, first and last magnitude class, first and last band.
type Corners = (usize, usize, usize, usize, usize);

/// The sets of harmonics that are scanned: all, those above the fundamental, even ones, odd ones,
/// each one.
fn harmonic_classes(harmonics: &[usize]) -> Vec<Vec<usize>> {
    let mut classes = vec![Vec::new()];
    if harmonics.len() > 1 {
        let of = |keep: &dyn Fn(usize) -> bool| -> Vec<usize> {
            harmonics.iter().copied().filter(|h| keep(*h)).collect()
        };
        let sets = [
            of(&|h| h >= 2),
            of(&|h| h % 2 == 0),
            of(&|h| h % 2 == 0 && h > 0),
            of(&|h| h % 2 == 1 && h > 1),
        ];
        classes.extend(sets.into_iter().filter(|set| set.len() > 1));
        classes.extend(harmonics.iter().map(|h| vec![*h]));
        classes.dedup();
    }
    classes
}

#[cfg(test)]
mod tests {
    use super::*;
    use statrs::distribution::{ChiSquared, ContinuousCDF, Normal as Gauss};

    /// Three magnitudes, five bands, harmonics 0 to 3; one row a cell.
    fn layout() -> Layout {
        let mut cells = Vec::new();
        for (magnitude, band, harmonic) in
            (0..3).flat_map(|m| (0..5).flat_map(move |b| (0..4).map(move |h| (m, b, h))))
        {
            let zero = crate::measurement::Complex::new(0.0, 0.0);
            cells.push(Cell {
                excited: true,
                rows: (cells.len(), None),
                magnitude,
                band,
                harmonic,
                frequency_hz: band as f64,
                input_magnitude: magnitude as f64,
                experiment: 0,
                order: harmonic,
                run: None,
                measured: zero,
                simulated: zero,
                std: 1.0,
            });
        }
        Layout {
            cells,
            magnitudes: vec![[0.0; 2]; 3],
            bands: vec![[0.0; 2]; 5],
            harmonics: (0..4).collect(),
            many_lines: false,
            units: Default::default(),
        }
    }

    #[test]
    fn the_region_in_which_residuals_are_large_is_the_most_conspicuous() {
        let layout = layout();
        let regions = Regions::new(&layout, &[1.0; 60]);
        let wanted = Region { magnitudes: (1, 2), bands: (0, 2), harmonics: vec![2] };
        let squares = |row: usize| if wanted.holds(&layout.cells[row]) { 9.0 } else { 1.0 };
        let (found, score) = regions.most_conspicuous(|_| 1.0, squares).unwrap();
        assert_eq!(found, wanted);
        assert!((score - 48.0 / (2.0 * (6.0 + RANKING_EXTRA_DOF)).sqrt()).abs() < 1e-12);
        assert!(regions.largest_score(squares) >= Regions::score_of(6.0, 48.0) - 1e-12);
        // Once this region is explained, nothing stands out.
        let free = |row: usize| if wanted.holds(&layout.cells[row]) { 0.0 } else { 1.0 };
        let (_, left) = regions.most_conspicuous(free, |row| squares(row) * free(row)).unwrap();
        assert!(left.abs() < 1e-12);
    }

    #[test]
    fn every_rectangle_and_class_of_harmonics_has_its_sum() {
        let layout = layout();
        let regions = Regions::new(&layout, &[1.0; 60]);
        let value = |row: usize| (row as f64).sin();
        let mut count = 0;
        regions.each(&regions.sums(value), |(class, m0, m1, b0, b1), sum| {
            let harmonics = regions.classes[class].clone();
            let region = Region { magnitudes: (m0, m1), bands: (b0, b1), harmonics };
            let cells = layout.cells.iter().filter(|cell| region.holds(cell));
            let wanted: f64 = cells.map(|cell| value(cell.rows.0)).sum();
            assert!((sum - wanted).abs() < 1e-12);
            count += 1;
        });
        // Seven sets (all, ≥ 2, even, and four single harmonics), 6 ranges of magnitude, 15 of
        // bands.
        assert_eq!(count, 7 * 6 * 15);
    }

    // The approximation is good to 0.1 standard deviations at two degrees of freedom, and better
    // with more.
    #[test]
    fn scores_agree_with_the_normal_quantile_of_the_chi_squared_tail() {
        for (dof, sum) in [(2.0, 13.8), (10.0, 25.2), (100.0, 140.2), (100.0, 70.0)] {
            let tail = ChiSquared::new(dof).unwrap().sf(sum);
            let wanted = -Gauss::standard().inverse_cdf(tail);
            let score = Regions::score_of(dof, sum - dof);
            assert!((score - wanted).abs() < 0.1, "{dof} {sum}: {score} {wanted}");
        }
    }
}
