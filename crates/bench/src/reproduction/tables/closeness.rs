//! How often the answers are as close to the target as the published columns.

use servoscope_core::answers::Method;
use servoscope_core::measurement::Complex;

use crate::reproduction::figure_of_merit::ANSWER;
use crate::reproduction::markdown::markdown;
use crate::reproduction::published::{COLUMNS, Printed, table};
use crate::reproduction::runs::{Reproduction, Run};
use crate::reproduction::system::System;

/// For each published column, the number of runs whose answer, rounded to the digits of that
/// column, is at least as close to the computed target as the column in every row.
pub fn as_close_as_published(system: System, runs: &[&Run]) -> [usize; 5] {
    let targets = system.targets();
    std::array::from_fn(|column| {
        let close = |run: &&&Run| {
            ANSWER(run).is_some_and(|outcome| {
                table(system).iter().zip(&targets).zip(&outcome.rows).all(
                    |((row, target), ours)| {
                        let printed = Printed::read(row.columns[column]);
                        let distance = |value: Complex| (value - target).norm();
                        // The same decimal number may differ in the last bit if read from text or
                        // rounded.
                        distance(printed.round(*ours)) <= distance(printed.value) + 1e-12
                    },
                )
            })
        };
        runs.iter().filter(close).count()
    })
}

/// The counts of [`as_close_as_published`] as a table.
pub(in crate::reproduction) fn closeness_table(reproduction: &Reproduction) -> String {
    let mut header = vec!["abc-ann at least as close as".to_owned()];
    header.extend(COLUMNS.map(|(name, _)| name.to_owned()));
    let lines = reproduction.plan.systems.iter().map(|system| {
        let runs = reproduction.of(*system, None, Method::AbcAnn);
        let counts = as_close_as_published(*system, &runs);
        let cells = counts.map(|count| format!("{count} of {}", runs.len()));
        std::iter::once(system.name().to_owned()).chain(cells).collect()
    });
    markdown(&header, &lines.collect::<Vec<Vec<String>>>())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reproduction::tables::fixtures::run;

    #[test]
    fn the_target_itself_is_as_close_as_every_column_and_a_worse_pole_is_not() {
        for system in System::ALL {
            let exact = run(system, system.targets());
            assert_eq!(as_close_as_published(system, &[&exact]), [1; 5]);
        }
        // −10.0006 is closer than the printed −10.1 and −10.2, but not closer than −10.0004.
        let mut rows = System::G1.targets();
        rows[0].re = -10.0006;
        let off = run(System::G1, rows);
        assert_eq!(as_close_as_published(System::G1, &[&off]), [1, 1, 0, 1, 0]);
    }
}
