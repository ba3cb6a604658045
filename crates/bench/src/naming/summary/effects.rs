//! How often each hidden effect is named first.

use serde::Serialize;

use crate::naming::case::Kind;
use crate::naming::judge::Outcome;
use crate::naming::rate::Rate;

/// Bounds of the bins of the excess.
const EXCESS_BOUNDS: [f64; 4] = [120.0, 1_200.0, 12_000.0, 120_000.0];

/// How often a hidden effect is named first, by the size of its excess.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct EffectRates {
    /// Kind of draw: single, analyser, or machine, of which the dominant effect counts.
    pub kind: Kind,
    /// The effect.
    pub effect: &'static str,
    /// Noise, dB.
    pub level_db: u32,
    /// Rate over all draws.
    pub all: Rate,
    /// Rates by decade of the excess, from 120 upwards.
    pub by_decade: [Rate; 3],
}

/// The rates of draws of one effect, a row for each kind, effect and noise level.
pub(super) fn effects(outcomes: &[Outcome], levels: &[u32]) -> Vec<EffectRates> {
    let mut rates: Vec<EffectRates> = Vec::new();
    for level_db in levels {
        let of_one = |o: &&Outcome| {
            let of_one = matches!(o.kind, Kind::Single | Kind::Analyser | Kind::AnalyserRecord)
                || o.kind.dominant() == 1;
            of_one && o.level_db == *level_db
        };
        for outcome in outcomes.iter().filter(of_one) {
            let Some(hidden) = outcome.dominant().next() else { continue };
            let row = (outcome.kind, hidden.effect, *level_db);
            let same = |r: &EffectRates| (r.kind, r.effect, r.level_db) == row;
            let place = rates.iter().position(same).unwrap_or_else(|| {
                let (all, by_decade) = Default::default();
                let (kind, effect, level_db) = row;
                rates.push(EffectRates { kind, effect, level_db, all, by_decade });
                rates.len() - 1
            });
            let right = outcome.named_first();
            rates[place].all.add(right);
            // An excess may exceed its target by 10 %, so the last bin has no upper bound.
            let decade =
                EXCESS_BOUNDS[1..3].iter().filter(|bound| outcome.excess >= **bound).count();
            rates[place].by_decade[decade].add(right);
        }
    }
    rates
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::naming::summary::Summary;
    use crate::naming::summary::fixtures::outcomes;

    #[test]
    fn rates_of_an_effect_fall_into_decades_of_excess() {
        let mut drawn = outcomes();
        drawn[0].excess = 50_000.0;
        drawn[1].excess = 120.0;
        let effects = Summary::of(&drawn).effects;
        let [analysers, springs, ..] = &effects[..] else { panic!("two rows") };
        let row = |rates: &EffectRates| (rates.kind, rates.effect, rates.level_db);
        assert_eq!(row(springs), (Kind::Single, "spring", 60));
        assert_eq!(row(analysers), (Kind::Analyser, "spring", 70));
        assert_eq!(analysers.all, Rate { hits: 0, of: 3 });
        let hits = springs.by_decade.map(|rate| (rate.hits, rate.of));
        assert_eq!(hits, [(0, 1), (0, 0), (1, 1)]);
    }
}
