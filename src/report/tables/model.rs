//! Tables of one model: its parameters, and how it was computed.

use indexmap::IndexMap;

use servoscope_core::answers::{Fit, OrderChoice, ParameterEstimate, Stage};

use crate::report::columns::Side::{Left, Point, Right};
use crate::report::number::{Rounding, significant};

use super::{Cell, Table};

/// Estimates of parameters; `of` is what stands before a name in its full id.
pub(in crate::report) fn parameters(
    parameters: &IndexMap<String, ParameterEstimate>,
    of: &str,
) -> Table {
    let rows = parameters.iter().map(|(name, estimate)| {
        let number = |value: f64| Cell::Number(in_digits(estimate, value));
        let [low, high] = match estimate.interval95 {
            Some(ends) => ends.map(number),
            None => [Cell::Empty, Cell::Empty],
        };
        [
            Cell::Parameter { name: name.clone(), id: format!("{of}{name}") },
            estimate.value.map_or(Cell::NoNumber("unknown"), number),
            Cell::of(estimate.std, number),
            low,
            high,
            Cell::words(&estimate.unit),
            Cell::words(flags(estimate)),
        ]
    });
    let columns = [
        ("", Left, "Parameter"),
        ("value", Point, "value"),
        ("std", Point, "std"),
        ("95 % from", Point, "95 % from"),
        ("to", Point, "to"),
        ("unit", Left, "unit"),
        ("", Left, ""),
    ];
    Table::new(columns, rows)
}

/// Orders of the actuator that were tried.
pub(in crate::report) fn orders(choice: &OrderChoice, fit: &Fit) -> Table {
    let rows = choice.candidates.iter().map(|candidate| {
        [
            Cell::words(candidate.actuator_order.to_string()),
            Cell::Value(candidate.chi2, 4),
            Cell::Number(candidate.parameters.to_string()),
            Cell::Value(candidate.criterion, 4),
        ]
    });
    let columns = [
        ("order", Right, "Order"),
        (cost_name(fit), Right, cost_name(fit)),
        ("parameters", Right, "parameters"),
        ("criterion", Right, "criterion"),
    ];
    Table::new(columns, rows)
}

/// Stages of a computation with their names.
pub(in crate::report) fn stages(stages: &[(String, &Stage)], fit: &Fit) -> Table {
    let rows = stages.iter().map(|(name, stage)| {
        [
            Cell::words(name),
            Cell::Value(stage.cost, 4),
            Cell::Number(stage.evaluations.to_string()),
            Cell::Number(format!("{:.2}", stage.seconds)),
            Cell::words(&stage.stop_reason),
        ]
    });
    let columns = [
        ("", Left, "Stage"),
        (cost_name(fit), Right, cost_name(fit)),
        ("evaluations", Right, "evaluations"),
        ("seconds", Right, "seconds"),
        ("ended", Left, "ended"),
    ];
    Table::new(columns, rows)
}

/// Residuals of models on the data that they were fitted to.
pub(in crate::report) fn misfit<'a>(models: impl Iterator<Item = (&'a str, &'a Fit)>) -> Table {
    let rows = models.map(|(name, fit)| {
        [
            Cell::words(name),
            Cell::PerCent(fit.nrmse, 3),
            Cell::of(fit.chi2, |value| Cell::Value(value, 4)),
            Cell::Number(fit.dof.to_string()),
            Cell::of(fit.chi2_per_dof, |value| Cell::Value(value, 3)),
        ]
    });
    let columns = [
        ("", Left, "Model"),
        ("residual (NRMSE)", Right, "residual (NRMSE), %"),
        ("χ²", Point, "χ²"),
        ("degrees of freedom", Right, "degrees of freedom"),
        ("χ²/dof", Point, "χ²/dof"),
    ];
    Table::new(columns, rows)
}

/// A number with the digits that the estimate's deviation leaves it.
pub(in crate::report) fn in_digits(estimate: &ParameterEstimate, number: f64) -> String {
    let known = estimate.value.zip(estimate.std);
    match known.and_then(|(value, std)| Rounding::of(value, std)) {
        Some(rounding) => rounding.write(number),
        None => significant(number, 6),
    }
}

/// What to mind of an estimate.
pub(in crate::report) fn flags(estimate: &ParameterEstimate) -> &'static str {
    match (estimate.identifiable, estimate.at_bound) {
        (true, false) => "",
        (true, true) => "at the limit of the search range",
        (false, false) => "not determined by these data",
        (false, true) => "not determined by these data, at the limit of the search range",
    }
}

/// What the cost is: χ² where the noise is known.
pub(in crate::report) fn cost_name(fit: &Fit) -> &'static str {
    if fit.chi2.is_some() { "χ²" } else { "cost" }
}
