//! One draw of the benchmark, and the key that reproduces it.

use std::fmt;
use std::str::FromStr;

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use serde::Serialize;
use sha2::{Digest, Sha256};

use crate::machines::effect_draws::IDS;

/// What is hidden in a draw.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Kind {
    /// One effect.
    Single,
    /// Nothing.
    Clean,
    /// Two effects, each detectable if only the other is in the model.
    Pair,
    /// An effect that the library does not contain and that none of its effects imitates.
    Outsider,
}

impl Kind {
    /// Every kind.
    pub const ALL: [Self; 4] = [Self::Single, Self::Clean, Self::Pair, Self::Outsider];

    /// The name used in keys and on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Single => "single",
            Self::Clean => "clean",
            Self::Pair => "pair",
            Self::Outsider => "outsider",
        }
    }
}

impl FromStr for Kind {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let known = Self::ALL.map(Self::name).join(", ");
        let kind = Self::ALL.into_iter().find(|kind| kind.name() == text);
        kind.ok_or_else(|| format!("`{text}` is no kind of draw; there are {known}"))
    }
}

/// One draw. The base seed and its key determine all its random numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Case {
    /// What is hidden.
    pub kind: Kind,
    /// Noise, dB.
    pub level_db: u32,
    /// Id of the effect; for [`Kind::Single`] only.
    pub effect: Option<&'static str>,
    /// Order of the actuator, 0 to 2.
    pub order: u8,
    /// Number of the draw among those that are otherwise equal.
    pub index: u32,
}

impl Case {
    /// Whether its measurement has repeats instead of standard deviations; true for every fifth.
    pub fn has_repeats(&self) -> bool {
        self.index % 5 == 4
    }

    /// The random number stream of the draw.
    pub fn rng(&self, base_seed: u64) -> ChaCha8Rng {
        let text = format!("servoscope naming {base_seed} {self}");
        ChaCha8Rng::from_seed(Sha256::digest(text).into())
    }
}

/// Formats the key: kind, level, effect if any, order and index, such as `single-60-spring-o1-4`.
impl fmt::Display for Case {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}-{}-", self.kind.name(), self.level_db)?;
        if let Some(effect) = self.effect {
            write!(f, "{effect}-")?;
        }
        write!(f, "o{}-{}", self.order, self.index)
    }
}

impl FromStr for Case {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let malformed = || {
            format!(
                "`{text}` is no key of a draw, such as `single-60-spring-o1-4` or `pair-50-o0-2`"
            )
        };
        let parts: Vec<&str> = text.split('-').collect();
        let (kind, level, effect, order, index) = match parts[..] {
            [kind, level, effect, order, index] => (kind, level, Some(effect), order, index),
            [kind, level, order, index] => (kind, level, None, order, index),
            _ => return Err(malformed()),
        };
        let kind: Kind = kind.parse()?;
        let effect = effect.map(known_effect).transpose()?;
        let order = order.strip_prefix('o').and_then(|order| order.parse().ok());
        let case = Self {
            kind,
            level_db: level.parse().map_err(|_| malformed())?,
            effect,
            order: order.filter(|order| *order <= 2).ok_or_else(malformed)?,
            index: index.parse().map_err(|_| malformed())?,
        };
        let is_whole = (kind == Kind::Single) == effect.is_some();
        is_whole.then_some(case).ok_or_else(malformed)
    }
}

/// Looks up the id of an effect that can be hidden.
///
/// # Errors
/// A message that lists the known ids.
pub fn known_effect(text: &str) -> Result<&'static str, String> {
    let known = IDS.into_iter().find(|id| *id == text);
    known.ok_or_else(|| format!("`{text}` is no effect; there are {}", IDS.join(", ")))
}

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
    /// Number of clean draws at all levels together.
    pub clean: u32,
    /// Number of pairs at each level above 40 dB; there is no target for pairs at 40 dB.
    pub pairs: u32,
    /// Number of outsiders, all at the level with the least noise.
    pub outsiders: u32,
}

impl Default for Plan {
    fn default() -> Self {
        Self {
            kinds: Kind::ALL.to_vec(),
            levels_db: vec![60, 50, 40],
            orders: vec![0, 1, 2],
            effects: IDS.to_vec(),
            singles: 10,
            clean: 300,
            pairs: 60,
            outsiders: 45,
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
        let levels = self.levels_db.iter().copied();
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
            Kind::Pair => levels
                .filter(|level| *level > 40)
                .flat_map(|level| (0..self.pairs).map(move |i| (level, i)))
                .map(|(level, index)| case(level, None, index))
                .collect(),
            Kind::Outsider => levels
                .max()
                .into_iter()
                .flat_map(|level| (0..self.outsiders).map(move |i| (level, i)))
                .map(|(level, index)| case(level, None, index))
                .collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use rand::RngExt;

    use super::*;

    #[test]
    fn the_plan_has_the_draws_it_promises_and_each_key_is_one_of_them() {
        let plan = Plan::default();
        let cases = plan.cases();
        let count = |kind: Kind| cases.iter().filter(|case| case.kind == kind).count();
        assert_eq!(Kind::ALL.map(count), [3 * 17 * 10, 300, 2 * 60, 45]);
        let keys: HashSet<String> = cases.iter().map(Case::to_string).collect();
        assert_eq!(keys.len(), cases.len());
        for case in &cases {
            assert_eq!(case.to_string().parse(), Ok(*case));
        }
        let repeats = cases.iter().filter(|case| case.has_repeats()).count();
        assert_eq!(repeats, cases.len() / 5);
        let clean = |level: u32| {
            cases.iter().filter(|case| (case.kind, case.level_db) == (Kind::Clean, level)).count()
        };
        assert_eq!([60, 50, 40].map(clean), [100; 3]);
    }

    #[test]
    fn malformed_keys_are_refused() {
        for text in
            ["single-60-o1-4", "clean-60-spring-o1-4", "single-60-sprng-o1-4", "pair-60-o3-1", "x"]
        {
            assert!(text.parse::<Case>().is_err(), "{text}");
        }
    }

    #[test]
    fn each_key_and_each_base_seed_has_a_stream_of_its_own() {
        let first =
            |key: &str, seed: u64| -> u64 { key.parse::<Case>().unwrap().rng(seed).random() };
        let streams = [("clean-60-o0-0", 1), ("clean-60-o0-1", 1), ("clean-60-o0-0", 2)];
        let numbers: HashSet<u64> = streams.iter().map(|(key, seed)| first(key, *seed)).collect();
        assert_eq!(numbers.len(), 3);
        assert_eq!(first("clean-60-o0-0", 1), first("clean-60-o0-0", 1));
    }
}
