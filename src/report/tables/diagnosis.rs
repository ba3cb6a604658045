//! Tables of what a diagnosis found.

use servoscope_core::answers::{
    Candidate, Discrepancy, Gain, NoiseSource, ResidualGroup, ResidualTest,
};

use crate::report::columns::Side::{Left, Point, Right};

use super::{Cell, Table};

/// How to read the table of effects that were tried.
pub(in crate::report) const TRIED_SAYS: &str = "Each effect was fitted together with the whole base model. Δχ²: how much it alone lowers χ². \
     Criterion: −2 ln of the probability of the data under the model, up to a constant; the \
     smallest is best.";

/// Residuals of models on data that neither a fit nor the choice of the causes has seen.
pub(in crate::report) fn gains(gains: &[(String, &Gain)]) -> Table {
    let rows = gains.iter().map(|(name, gain)| {
        let [low, high] = gain.interval95.map(|end| Cell::value(end, 3));
        let each = |value: Option<f64>| Cell::of(value, |value| Cell::value(value, 3));
        [
            Cell::Name(name.clone()),
            Cell::PerCent(gain.heldout_nrmse_before, 3),
            Cell::PerCent(gain.heldout_nrmse_after, 3),
            Cell::value(gain.ratio, 3),
            low,
            high,
            each(gain.chi2_per_dof_before),
            each(gain.chi2_per_dof_after),
        ]
    });
    let columns = [
        ("", Left, "Model"),
        ("before", Point, "before, %"),
        ("after", Point, "after, %"),
        ("ratio", Point, "ratio"),
        ("95 % from", Point, "95 % from"),
        ("to", Point, "to"),
        ("χ²/dof before", Point, "χ²/dof before"),
        ("χ²/dof after", Point, "χ²/dof after"),
    ];
    Table::new(columns, rows)
}

/// Every effect that was tried. Where a fit was given up before it came to as
/// little as the base model's, it has gained nothing.
pub(in crate::report) fn tried(candidates: &[Candidate]) -> Table {
    let rows = candidates.iter().map(|candidate| {
        let Candidate { effect, delta_chi2, criterion, heldout_error, rejected, .. } = candidate;
        let [gained, criterion] = match *delta_chi2 > 0.0 {
            true => [delta_chi2, criterion].map(|value| Cell::Number(format!("{value:.1}"))),
            false => [Cell::NoNumber("none"), Cell::Empty],
        };
        let error = Cell::of(*heldout_error, |error| Cell::PerCent(error, 3));
        let what = rejected.clone().map_or(Cell::Named, Cell::Sentence);
        [Cell::Effect(effect.clone()), gained, criterion, error, what]
    });
    let columns = [
        ("effect", Left, "Effect"),
        ("Δχ²", Point, "Δχ²"),
        ("criterion", Right, "criterion"),
        ("held out", Point, "held-out residual, %"),
        ("", Left, "Result"),
    ];
    let table = Table::new(columns, rows);
    let measured = candidates.iter().any(|candidate| candidate.heldout_error.is_some());
    if measured { table } else { table.arranged(&[0, 1, 2, 4]) }
}

/// The tests of whether the residual is noise.
pub(in crate::report) fn tests(tests: &[ResidualTest]) -> Table {
    let rows = tests.iter().map(|test| {
        [
            Cell::words(&test.name),
            Cell::of(test.p_value, Cell::Probability),
            Cell::Passed(test.p_value.map(|_| test.passed)),
            Cell::Sentence(test.explanation.clone()),
        ]
    });
    let columns = [
        ("test", Left, "Test"),
        ("p", Right, "p"),
        ("", Left, ""),
        ("meaning", Left, "What it says"),
    ];
    Table::new(columns, rows)
}

/// Residuals by magnitude, harmonic, frequency and run, a table each, with the
/// name of what it goes by.
pub(in crate::report) fn residuals(
    found: &Discrepancy,
    noise: NoiseSource,
) -> [(&'static str, Table); 4] {
    let unit = if noise == NoiseSource::Estimated { "of the rms residual" } else { "sigmas" };
    let by = |axis: &'static str, on_page, groups: &[ResidualGroup]| {
        let rows = groups.iter().map(|group| {
            [
                Cell::Range(group.from, group.to),
                Cell::Number(group.count.to_string()),
                Cell::value(group.rms_sigmas, 3),
                Cell::value(group.rms_response, 3),
                Cell::PerCent(group.relative, 2),
            ]
        });
        let columns = [
            ("", Left, on_page),
            ("values", Right, ""),
            (unit, Point, unit),
            ("response", Right, "response"),
            ("of measured", Right, "% of measured"),
        ];
        let mut table = Table::new(columns, rows);
        table.columns[1].on_page = None;
        (axis, table)
    };
    [
        by("magnitude", "Magnitude", &found.by_magnitude),
        by("harmonic", "Harmonic", &found.by_harmonic),
        by("frequency, Hz", "Frequency, Hz", &found.by_frequency),
        by("run", "Run", &found.by_run),
    ]
}
