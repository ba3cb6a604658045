//! Which effects are taken for which.

use std::collections::BTreeMap;

use serde::Serialize;

use crate::naming::judge::Outcome;

/// Row of clean draws, and column of draws in which nothing is named, in a confusion table.
pub const NONE: &str = "none";

/// Confusion table at one noise level: hidden effects (rows; in a machine the dominant one) against
/// first named causes (columns).
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Confusion {
    /// Noise, dB.
    pub level_db: u32,
    /// (hidden, first named) → number of draws.
    #[serde(serialize_with = "as_rows")]
    pub counts: BTreeMap<(String, String), u32>,
}

fn as_rows<S: serde::Serializer>(
    counts: &BTreeMap<(String, String), u32>,
    serializer: S,
) -> Result<S::Ok, S::Error> {
    serializer.collect_seq(counts.iter().map(|((hidden, named), count)| (hidden, named, count)))
}

/// The confusion table of one noise level.
pub(super) fn confusion(outcomes: &[Outcome], level_db: u32) -> Confusion {
    let mut counts = BTreeMap::new();
    let of_one = |o: &&Outcome| {
        o.level_db == level_db && o.dominant().count() < 2 && !o.kind.is_mismeasured()
    };
    for outcome in outcomes.iter().filter(of_one) {
        let hidden = outcome.dominant().next().map_or(NONE, |hidden| hidden.effect);
        let named = outcome.causes().first().map_or(NONE, |first| &first.effect);
        *counts.entry((hidden.to_owned(), named.to_owned())).or_insert(0) += 1;
    }
    Confusion { level_db, counts }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::naming::summary::Summary;
    use crate::naming::summary::fixtures::outcomes;

    #[test]
    fn confusions_have_a_row_and_a_column_for_nothing() {
        let summary = Summary::of(&outcomes());
        let [_, loud, quiet] = &summary.confusions[..] else { panic!("three levels") };
        assert_eq!((loud.level_db, quiet.level_db), (60, 40));
        let count = |of: &Confusion, hidden: &str, named: &str| {
            of.counts.get(&(hidden.to_owned(), named.to_owned())).copied().unwrap_or_default()
        };
        assert_eq!(count(loud, "spring", "cogging"), 1);
        assert_eq!(count(loud, "none", "stribeck"), 1);
        assert_eq!(count(quiet, "spring", "none"), 1);
        assert_eq!(loud.counts.values().sum::<u32>(), 5, "pairs have no single row");
    }
}
