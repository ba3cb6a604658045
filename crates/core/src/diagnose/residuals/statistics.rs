//! Test statistics that are small where the residuals are noise.
//!
//! Each is one number that grows with one kind of departure. None has a textbook null distribution,
//! because the fit correlates residuals and scales are estimated; `whiteness` simulates it.

use std::collections::BTreeMap;

use nalgebra::{DMatrix, DVector};

use super::layout::Cell;
use super::regions::Regions;
use super::residual::Residuals;
use super::subspace::Subspace;

/// Degrees of freedom below which residuals are tested for their size only.
const FEWEST_DOF: f64 = 8.0;

/// Computes the value of a statistic from residuals.
pub(crate) type Evaluate<'a> = Box<dyn Fn(&DVector<f64>) -> f64 + Sync + 'a>;

/// One statistic and what it means.
pub(crate) struct Statistic<'a> {
    /// Its name.
    pub name: &'static str,
    /// How its value is computed, or why it cannot be.
    pub evaluate: Result<Evaluate<'a>, &'static str>,
    /// What it means where it is small.
    pub small: &'static str,
    /// What it means where it is large.
    pub large: &'static str,
}

/// Every statistic of these residuals.
pub(crate) fn all<'a>(residuals: &'a Residuals, regions: &'a Regions) -> Vec<Statistic<'a>> {
    let mut statistics = vec![
        size(residuals),
        frequency(residuals),
        trend(residuals),
        magnitude(residuals),
        harmonic(residuals),
        run(residuals),
        outlier(residuals),
        region(regions),
    ];
    if residuals.dof() < FEWEST_DOF {
        let structure = |statistic: &&mut Statistic<'_>| statistic.name != "size";
        for statistic in statistics.iter_mut().filter(structure) {
            statistic.evaluate = Err("too few data remain beside the parameters to show any \
                                      structure");
        }
    }
    statistics
}

/// Size: Σr².
fn size(residuals: &Residuals) -> Statistic<'_> {
    Statistic {
        name: "size",
        evaluate: match residuals.scale_known {
            // As many parameters as data leave rounding errors only.
            _ if residuals.dof() < 0.5 => Err("the model has as many parameters as there are data"),
            true => Ok(Box::new(|r| r.norm_squared())),
            false => Err("the size of the noise is unknown; give std, repeats or noise_std"),
        },
        small: "the residuals are no larger than the noise",
        large: "the residuals are larger than the noise",
    }
}

/// Serial correlation: Σ rᵢ·rⱼ over neighbours in frequency of the same magnitude, harmonic and
/// part (re or im), von Neumann's ratio (1941, doi:10.1214/aoms/1177731677) for many short series.
fn frequency(residuals: &Residuals) -> Statistic<'_> {
    let mut series: BTreeMap<(usize, usize, usize), Vec<&Cell>> = BTreeMap::new();
    let layout = &residuals.layout;
    for cell in layout.cells.iter().filter(|cell| !layout.many_lines || cell.order > 0) {
        let key = match layout.many_lines {
            true => (cell.experiment, 0, 0),
            false => (usize::MAX, cell.magnitude, cell.order),
        };
        series.entry(key).or_default().push(cell);
    }
    let mut pairs = Vec::new();
    for cells in series.values_mut() {
        cells.sort_by(|a, b| a.frequency_hz.total_cmp(&b.frequency_hz));
        for pair in cells.windows(2) {
            pairs.push((pair[0].rows.0, pair[1].rows.0));
            pairs.extend(pair[0].rows.1.zip(pair[1].rows.1));
        }
    }
    Statistic {
        name: "frequency",
        evaluate: match pairs.len() {
            0..8 => Err("there are too few neighbours in frequency"),
            _ => Ok(Box::new(move |r| pairs.iter().map(|(a, b)| r[*a] * r[*b]).sum())),
        },
        small: "residuals at neighbouring frequencies are independent",
        large: "residuals at neighbouring frequencies are alike",
    }
}

/// Score test of parameters that vary with ln frequency.
fn trend(residuals: &Residuals) -> Statistic<'_> {
    let quantity = |cell: &Cell| cell.frequency_hz.max(f64::MIN_POSITIVE).ln();
    let lowest = residuals.layout.cells.iter().map(|cell| cell.frequency_hz);
    let lowest = lowest.filter(|f| *f > 0.0).fold(f64::INFINITY, f64::min).ln();
    let level = move |cell: &Cell| quantity(cell).max(lowest);
    Statistic {
        name: "trend",
        evaluate: varying(residuals, &level, "there is one frequency only"),
        small: "the same parameters fit low and high frequencies",
        large: "low and high frequencies fit different parameters",
    }
}

/// Score test of parameters that vary with ln magnitude.
fn magnitude(residuals: &Residuals) -> Statistic<'_> {
    let level = log_magnitude(residuals);
    Statistic {
        name: "magnitude",
        evaluate: varying(residuals, &level, "there is one magnitude only"),
        small: "the same parameters fit every magnitude",
        large: "small and large magnitudes fit different parameters",
    }
}

/// Score test of parameters that vary linearly with the order of acquisition.
fn run(residuals: &Residuals) -> Statistic<'_> {
    let level = |cell: &Cell| cell.run.unwrap_or(0.0);
    let unknown = residuals.layout.cells.iter().any(|cell| cell.run.is_none());
    let space = residuals.varying(&[&level]);
    Statistic {
        name: "run",
        evaluate: match space.dimension() {
            _ if unknown => Err("the order of acquisition is not given (column `run`)"),
            0 => Err("there is one run only"),
            _ => Ok(Box::new(move |r| space.energy(r))),
        },
        small: "the same parameters fit from the first run to the last",
        large: match follows_design(residuals) {
            true => {
                "early and late runs fit different parameters; not conclusive, as the runs were \
                 taken in order of magnitude or frequency, which has the same effect: shuffle the \
                 runs"
            }
            false => "early and late runs fit different parameters",
        },
    }
}

/// Whether the order of acquisition follows magnitude or frequency: a linear function of both
/// explains more than half of its variance.
fn follows_design(residuals: &Residuals) -> bool {
    let cells = &residuals.layout.cells;
    let magnitude = log_magnitude(residuals);
    let column = |level: &dyn Fn(&Cell) -> f64| {
        let column = DVector::from_iterator(cells.len(), cells.iter().map(level));
        let mean = column.mean();
        column.add_scalar(-mean)
    };
    let run = column(&|cell| cell.run.unwrap_or(0.0));
    let design =
        [column(&magnitude), column(&|cell| cell.frequency_hz.max(f64::MIN_POSITIVE).ln())];
    let explained = Subspace::of(&DMatrix::from_columns(&design)).energy(&run);
    explained > 0.5 * run.norm_squared()
}

/// Largest normal score of the size of one harmonic's residuals, or of their mean at one magnitude.
fn harmonic(residuals: &Residuals) -> Statistic<'_> {
    let layout = &residuals.layout;
    let mut shares: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    let mut means: BTreeMap<(usize, usize, bool), Vec<usize>> = BTreeMap::new();
    for cell in &layout.cells {
        shares.entry(cell.harmonic).or_default().extend(cell.each_row());
        for (part, row) in cell.each_row().enumerate() {
            means.entry((cell.harmonic, cell.magnitude, part == 1)).or_default().push(row);
        }
    }
    let dof = |rows: &[usize]| rows.iter().map(|row| residuals.freedom[*row]).sum::<f64>();
    let shares: Vec<(f64, Vec<usize>)> =
        shares.into_values().map(|rows| (dof(&rows), rows)).filter(|(dof, _)| *dof > 0.5).collect();
    let means: Vec<Vec<usize>> = means.into_values().filter(|rows| rows.len() > 2).collect();
    Statistic {
        name: "harmonic",
        evaluate: match layout.harmonics.len() {
            0 | 1 => Err("there is one harmonic only, or the input has many lines"),
            _ => Ok(Box::new(move |r| {
                let share = shares.iter().map(|(dof, rows)| {
                    let sum: f64 = rows.iter().map(|row| r[*row] * r[*row]).sum();
                    Regions::score_of(*dof, sum - dof)
                });
                let mean = means.iter().map(|rows| {
                    let sum: f64 = rows.iter().map(|row| r[*row]).sum();
                    Regions::score_of(1.0, sum * sum / rows.len() as f64 - 1.0)
                });
                share.chain(mean).fold(f64::NEG_INFINITY, f64::max)
            })),
        },
        small: "no harmonic stands out, in size or in its mean",
        large: "some harmonic stands out, in size or in its mean",
    }
}

/// Outlier: largest squared residual over its variance 1 − hᵢᵢ.
fn outlier(residuals: &Residuals) -> Statistic<'_> {
    let freedom = &residuals.freedom;
    let square = move |(r, freedom): (&f64, &f64)| r * r / freedom.max(0.1);
    Statistic {
        name: "outlier",
        evaluate: Ok(Box::new(move |r| r.iter().zip(freedom).map(square).fold(0.0, f64::max))),
        small: "no single residual stands out",
        large: "single residuals stand out",
    }
}

/// Scan statistic: largest normal score of any region.
fn region(regions: &Regions) -> Statistic<'_> {
    Statistic {
        name: "region",
        evaluate: Ok(Box::new(|r| regions.largest_score(|row| r[row] * r[row]))),
        small: "no region of magnitude, frequency and harmonic stands out",
        large: "some region of magnitude, frequency and harmonic stands out",
    }
}

/// ln of a cell's magnitude; magnitudes below 1e-3 of the largest count as that.
pub(crate) fn log_magnitude(residuals: &Residuals) -> impl Fn(&Cell) -> f64 + use<> {
    let cells = residuals.layout.cells.iter();
    let least = 1e-3 * cells.map(|cell| cell.input_magnitude).fold(0.0, f64::max);
    move |cell: &Cell| cell.input_magnitude.max(least).max(f64::MIN_POSITIVE).ln()
}

/// Score test of parameters that vary with a level and its square: the squared length of the
/// residuals in the directions of such changes. `Err(constant)` where the level does not vary.
fn varying<'a>(
    residuals: &'a Residuals,
    level: &dyn Fn(&Cell) -> f64,
    constant: &'static str,
) -> Result<Evaluate<'a>, &'static str> {
    let count = residuals.layout.cells.len().max(1) as f64;
    let mean = residuals.layout.cells.iter().map(level).sum::<f64>() / count;
    let about_mean = |cell: &Cell| level(cell) - mean;
    let largest = residuals.layout.cells.iter().map(|c| about_mean(c).abs()).fold(0.0, f64::max);
    // Levels are logarithms; a smaller variation is rounding.
    if largest < 1e-6 {
        return Err(constant);
    }
    let square = |cell: &Cell| about_mean(cell).powi(2);
    let space = residuals.varying(&[&about_mean, &square]);
    match space.dimension() {
        0 => Err(constant),
        _ => Ok(Box::new(move |r| space.energy(r))),
    }
}
