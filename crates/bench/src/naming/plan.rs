//! Kinds and numbers of the draws of a run.

use servoscope_core::answers::FaultKind;

use super::case::{Case, Kind};
use super::effect_draws::ids;
use super::mismeasurement::Sort;

/// The level of analysers, dB: their floors lie within 10 dB of it.
const ANALYSER_LEVEL_DB: u32 = 70;

/// Kinds and numbers of the draws of a run.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    /// Kinds of draw.
    pub kinds: Vec<Kind>,
    /// Noise levels, dB.
    pub levels_db: Vec<u32>,
    /// Orders of the actuator, used in turn.
    pub orders: Vec<u8>,
    /// Effects of the single draws.
    pub effects: Vec<&'static str>,
    /// Number of single draws of each effect at each level.
    pub singles: u32,
    /// Number of clean draws at all levels together, and of analysers and of their records that hide
    /// nothing.
    pub clean: u32,
    /// Number of pairs at each level above 40 dB; there is no target for pairs at 40 dB.
    pub pairs: u32,
    /// Number of outsiders, all at the level with the least noise.
    pub outsiders: u32,
    /// Number of analysers that hide an effect, of each effect; as many that are recorded.
    pub analysers: u32,
    /// Number of machines with one dominant effect, of each effect at each level above 40 dB; those
    /// that are recorded only at the level with the least noise.
    pub machines: u32,
    /// The same of machines with two dominant effects.
    pub machine_pairs: u32,
    /// Number of measurements with a fault of each sort at each level above 40 dB, and as many that
    /// hide an effect, too; records with a fault only at the level with the least noise.
    pub mismeasured: u32,
    /// Kinds of these faults; all if there is none.
    pub faults: Vec<FaultKind>,
}

/// All kinds but [`Kind::Analyser`], its records, the machines with small effects and the measurements with a
/// fault, which would make the run several times as long.
impl Default for Plan {
    fn default() -> Self {
        Self {
            kinds: vec![Kind::Single, Kind::Clean, Kind::Pair, Kind::Outsider],
            levels_db: vec![60, 50, 40],
            orders: vec![0, 1, 2],
            effects: ids(),
            singles: 10,
            clean: 300,
            pairs: 60,
            outsiders: 45,
            analysers: 10,
            machines: 2,
            machine_pairs: 30,
            mismeasured: 2,
            faults: Vec::new(),
        }
    }
}

impl Plan {
    /// All draws of the plan.
    pub fn cases(&self) -> Vec<Case> {
        self.kinds.iter().flat_map(|kind| self.cases_of(*kind)).collect()
    }

    fn cases_of(&self, kind: Kind) -> Vec<Case> {
        let case = |level_db: u32, effect: Option<&'static str>, index: u32| {
            let order = self.orders[index as usize % self.orders.len()];
            Case { kind, level_db, effect, order, index }
        };
        // What a level means for a record is its draw alone.
        let levels = || self.levels_db.iter().copied();
        let levels: Vec<u32> = match kind.is_recorded() {
            true => levels().max().into_iter().collect(),
            false => levels().collect(),
        };
        let levels = levels.into_iter();
        match kind {
            Kind::Single => levels
                .flat_map(|level| self.effects.iter().map(move |effect| (level, *effect)))
                .flat_map(|(level, effect)| (0..self.singles).map(move |i| (level, effect, i)))
                .map(|(level, effect, index)| case(level, Some(effect), index))
                .collect(),
            Kind::Clean => {
                let count = self.levels_db.len() as u32;
                (0..self.clean)
                    .map(|i| case(self.levels_db[(i % count) as usize], None, i / count))
                    .collect()
            }
            Kind::Pair | Kind::MachinePair | Kind::MachinePairRecord => {
                let count = if kind == Kind::Pair { self.pairs } else { self.machine_pairs };
                levels
                    .filter(|level| *level > 40)
                    .flat_map(|level| (0..count).map(move |i| (level, i)))
                    .map(|(level, index)| case(level, None, index))
                    .collect()
            }
            Kind::Machine | Kind::MachineRecord => {
                // Few of each effect: the orders change from one effect to the next, too.
                let order = |place: usize, index: u32| {
                    self.orders[(place + index as usize) % self.orders.len()]
                };
                let effects = || self.effects.iter().copied().enumerate();
                levels
                    .filter(|level| *level > 40)
                    .flat_map(|level| effects().map(move |effect| (level, effect)))
                    .flat_map(|(level, effect)| (0..self.machines).map(move |i| (level, effect, i)))
                    .map(|(level, (place, effect), index)| Case {
                        order: order(place, index),
                        ..case(level, Some(effect), index)
                    })
                    .collect()
            }
            Kind::Outsider => levels
                .max()
                .into_iter()
                .flat_map(|level| (0..self.outsiders).map(move |i| (level, i)))
                .map(|(level, index)| case(level, None, index))
                .collect(),
            Kind::Analyser | Kind::AnalyserRecord => {
                let level_db = match kind {
                    Kind::Analyser => ANALYSER_LEVEL_DB,
                    _ => levels.max().unwrap_or(ANALYSER_LEVEL_DB),
                };
                let hidden = self.effects.iter().map(|effect| (Some(*effect), self.analysers));
                hidden
                    .chain([(None, self.clean)])
                    .flat_map(|(effect, count)| (0..count).map(move |i| (effect, i)))
                    .map(|(effect, index)| case(level_db, effect, index))
                    .collect()
            }
            Kind::Mismeasured | Kind::MismeasuredRecord => {
                // The index says which sort of fault it is.
                let sorts = Sort::all_of(kind).len();
                let count = sorts as u32 * self.mismeasured;
                let levels: Vec<u32> = levels.filter(|level| *level > 40).collect();
                let is_wanted =
                    |sort: Sort| self.faults.is_empty() || self.faults.contains(&sort.kind());
                let draws = levels.iter().flat_map(|level| (0..count).map(move |i| (*level, i)));
                let draws = draws.filter(|(level, index)| {
                    Sort::of(&case(*level, None, *index)).is_some_and(is_wanted)
                });
                let order = |place: usize| self.orders[place % self.orders.len()];
                // Where there are few sorts, each gets every order.
                let place = |index: u32| match kind {
                    Kind::Mismeasured => index as usize,
                    _ => index as usize % sorts + index as usize / sorts,
                };
                let clean = draws.clone().map(|(level, index)| Case {
                    order: order(place(index)),
                    ..case(level, None, index)
                });
                let effects = self.effects.iter().copied().enumerate().cycle();
                let hidden = draws.zip(effects).enumerate();
                let hidden = hidden.map(|(number, ((level, index), (effect_place, effect)))| {
                    // In tables the orders change from one effect to the next and from one turn to the
                    // next.
                    let order = order(match kind {
                        Kind::Mismeasured => effect_place + number / self.effects.len(),
                        _ => place(index),
                    });
                    Case { order, ..case(level, Some(effect), index) }
                });
                clean.chain(hidden).collect()
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use super::*;

    #[test]
    fn the_plan_has_the_draws_it_promises_and_each_key_is_one_of_them() {
        let plan = Plan::default();
        let cases = plan.cases();
        let count = |kind: Kind| cases.iter().filter(|case| case.kind == kind).count();
        assert_eq!(Kind::ALL.map(count), [3 * 17 * 10, 300, 2 * 60, 45, 0, 0, 0, 0, 0, 0, 0, 0]);
        let keys: HashSet<String> = cases.iter().map(Case::to_string).collect();
        assert_eq!(keys.len(), cases.len());
        for case in &cases {
            assert_eq!(case.to_string().parse(), Ok(*case));
        }
        let clean = |level: u32| {
            cases.iter().filter(|case| (case.kind, case.level_db) == (Kind::Clean, level)).count()
        };
        assert_eq!([60, 50, 40].map(clean), [100; 3]);
    }

    #[test]
    fn analysers_are_drawn_only_if_they_are_asked_for_with_each_effect_and_clean() {
        assert!(!Plan::default().kinds.contains(&Kind::Analyser));
        let kinds = vec![Kind::Analyser];
        let cases = Plan { kinds, clean: 6, analysers: 2, ..Plan::default() }.cases();
        assert_eq!(cases.len(), 2 * 17 + 6);
        assert_eq!(cases.iter().filter(|case| case.effect.is_none()).count(), 6);
        assert_eq!(cases[0].to_string(), format!("analyser-70-{}-o0-0", ids()[0]));
        let orders: Vec<u8> = cases[34..].iter().map(|case| case.order).collect();
        assert_eq!(orders, [0, 1, 2, 0, 1, 2]);
        let kinds = vec![Kind::AnalyserRecord];
        let recorded = Plan { kinds, clean: 6, analysers: 2, ..Plan::default() }.cases();
        assert_eq!((recorded.len(), recorded[0].level_db), (cases.len(), 60));
        for case in cases.into_iter().chain(recorded) {
            assert_eq!(case.to_string().parse(), Ok(case));
        }
    }

    #[test]
    fn faults_are_drawn_only_if_they_are_asked_for_with_the_effects_in_turn_and_clean() {
        assert!(!Plan::default().kinds.contains(&Kind::Mismeasured));
        let kinds = vec![Kind::Mismeasured];
        let cases = Plan { kinds, mismeasured: 3, ..Plan::default() }.cases();
        let count = 2 * 3 * Sort::all_of(Kind::Mismeasured).len();
        assert_eq!(cases.len(), 2 * count);
        assert!(cases.iter().all(|case| case.level_db > 40));
        let (clean, hidden) = cases.split_at(count);
        assert!(clean.iter().all(|case| case.effect.is_none()));
        for (number, case) in hidden.iter().enumerate() {
            assert_eq!(case.effect, Some(ids()[number % ids().len()]));
        }
        for order in 0..3 {
            // A third of 78.
            for cases in [clean, hidden] {
                let found = cases.iter().filter(|case| case.order == order).count();
                assert!((24..=28).contains(&found), "{order}: {found}");
            }
        }
        let keys: HashSet<String> = cases.iter().map(Case::to_string).collect();
        assert_eq!(keys.len(), cases.len());
        for case in cases {
            assert_eq!(case.to_string().parse(), Ok(case));
        }
    }

    #[test]
    fn faults_can_be_chosen_by_their_kind_and_clean_draws_keep_their_keys() {
        let kinds = vec![Kind::Mismeasured];
        let plan = Plan { kinds, mismeasured: 4, ..Plan::default() };
        let all: HashSet<String> = plan.cases().iter().map(Case::to_string).collect();
        let wanted = [FaultKind::StdFactor, FaultKind::BadRows];
        let cases = Plan { faults: wanted.into(), ..plan }.cases();
        // Two levels, clean and with an effect, two sorts of bad rows and one of a wrong std.
        assert_eq!(cases.len(), 2 * 2 * 3 * 4);
        assert!(cases.iter().all(|case| wanted.contains(&Sort::of(case).unwrap().kind())));
        let clean = cases.iter().filter(|case| case.effect.is_none());
        assert!(clean.map(Case::to_string).all(|key| all.contains(&key)));
    }

    #[test]
    fn each_fault_of_a_record_is_drawn_with_every_order_clean_and_with_an_effect() {
        let kinds = vec![Kind::MismeasuredRecord];
        let cases = Plan { kinds, mismeasured: 3, ..Plan::default() }.cases();
        assert!(cases.iter().all(|case| case.level_db == 60) && cases.len() == 2 * 7 * 3);
        let drawn = cases.iter().map(|case| (Sort::of(case), case.order, case.effect.is_some()));
        let different: HashSet<_> = drawn.collect();
        assert_eq!(different.len(), cases.len());
    }

    #[test]
    fn machines_are_drawn_only_if_they_are_asked_for_at_the_levels_above_40_db() {
        let plan = Plan { machines: 1, machine_pairs: 6, ..Plan::default() };
        let machines = [Kind::Machine, Kind::MachinePair];
        assert!(machines.iter().all(|kind| !plan.kinds.contains(kind)));
        let recorded =
            Plan { kinds: vec![Kind::MachineRecord, Kind::MachinePairRecord], ..plan.clone() };
        assert_eq!(recorded.cases().len(), 17 + 6);
        assert!(recorded.cases().iter().all(|case| case.level_db == 60));
        let cases = Plan { kinds: machines.into(), ..plan }.cases();
        assert_eq!(cases.len(), 2 * 17 + 2 * 6);
        assert!(cases.iter().all(|case| case.level_db > 40));
        for kind in machines {
            for order in 0..3 {
                let of = |case: &&Case| case.kind == kind && case.order == order;
                assert!(cases.iter().filter(of).count() >= 4, "{kind:?} {order}");
            }
        }
        for case in cases {
            assert_eq!(case.to_string().parse(), Ok(case));
        }
    }
}
