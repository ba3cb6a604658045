//! One draw of the benchmark, and the key that reproduces it.

use std::fmt;
use std::str::FromStr;

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use serde::Serialize;
use sha2::{Digest, Sha256};

use super::effect_draws::ids;

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
    /// One effect or nothing, in a table as frequency response analysers write them.
    Analyser,
    /// One effect or nothing, recorded: a multisine, a sweep, a held command, or a trajectory in a
    /// position loop.
    #[serde(rename = "analyser-record")]
    AnalyserRecord,
    /// One dominant effect, and several small ones beside it.
    Machine,
    /// Two dominant effects, and several small ones beside them.
    #[serde(rename = "machine-2")]
    MachinePair,
    /// As [`Kind::Machine`], but recorded: a multisine, or a trajectory in a position loop.
    #[serde(rename = "machine-record")]
    MachineRecord,
    /// As [`Kind::MachinePair`], but recorded.
    #[serde(rename = "machine-2-record")]
    MachinePairRecord,
    /// One effect or nothing, in a measurement that has a fault itself.
    Mismeasured,
    /// As [`Kind::Mismeasured`], but recorded.
    #[serde(rename = "mismeasured-record")]
    MismeasuredRecord,
}

impl Kind {
    /// Every kind.
    pub const ALL: [Self; 12] = [
        Self::Single,
        Self::Clean,
        Self::Pair,
        Self::Outsider,
        Self::Analyser,
        Self::AnalyserRecord,
        Self::Machine,
        Self::MachinePair,
        Self::MachineRecord,
        Self::MachinePairRecord,
        Self::Mismeasured,
        Self::MismeasuredRecord,
    ];

    /// The name used in keys and on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Single => "single",
            Self::Clean => "clean",
            Self::Pair => "pair",
            Self::Outsider => "outsider",
            Self::Analyser => "analyser",
            Self::AnalyserRecord => "analyser-record",
            Self::Machine => "machine",
            Self::MachinePair => "machine-2",
            Self::MachineRecord => "machine-record",
            Self::MachinePairRecord => "machine-2-record",
            Self::Mismeasured => "mismeasured",
            Self::MismeasuredRecord => "mismeasured-record",
        }
    }

    /// Number of dominant effects beside small ones; 0 if the kind has no small ones.
    pub fn dominant(self) -> usize {
        match self {
            Self::Single
            | Self::Clean
            | Self::Pair
            | Self::Outsider
            | Self::Analyser
            | Self::AnalyserRecord
            | Self::Mismeasured
            | Self::MismeasuredRecord => 0,
            Self::Machine | Self::MachineRecord => 1,
            Self::MachinePair | Self::MachinePairRecord => 2,
        }
    }

    /// Whether the machine is recorded, instead of measured as a table.
    pub fn is_recorded(self) -> bool {
        matches!(
            self,
            Self::AnalyserRecord
                | Self::MachineRecord
                | Self::MachinePairRecord
                | Self::MismeasuredRecord
        )
    }

    /// Whether the measurement has a fault itself.
    pub fn is_mismeasured(self) -> bool {
        matches!(self, Self::Mismeasured | Self::MismeasuredRecord)
    }

    /// The kind with which a key begins, and the rest of the key.
    fn of_key(text: &str) -> Option<(Self, &str)> {
        let rest = |kind: Self| Some((kind, text.strip_prefix(kind.name())?.strip_prefix('-')?));
        // The name of one kind may begin with that of another, so the longest counts.
        Self::ALL.into_iter().filter_map(rest).max_by_key(|(kind, _)| kind.name().len())
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
    /// Noise, dB. For [`Kind::Analyser`] the middle of the range from which the floor is drawn. The
    /// effects of a machine that is recorded are drawn for a table with this noise; that of its
    /// record follows from what the dominant effects shall leave.
    pub level_db: u32,
    /// Id of the effect; always for [`Kind::Single`] and, the dominant one, for [`Kind::Machine`];
    /// for analysers and measurements with a fault, recorded or not, if they hide one.
    pub effect: Option<&'static str>,
    /// Order of the actuator, 0 to 2.
    pub order: u8,
    /// Number of the draw among those that are otherwise equal. It says which fault a measurement
    /// that has one has.
    pub index: u32,
}

impl Case {
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
        let (kind, rest) = Kind::of_key(text).ok_or_else(malformed)?;
        let parts: Vec<&str> = rest.split('-').collect();
        let (level, effect, order, index) = match parts[..] {
            [level, effect, order, index] => (level, Some(effect), order, index),
            [level, order, index] => (level, None, order, index),
            _ => return Err(malformed()),
        };
        let effect = effect.map(known_effect).transpose()?;
        let order = order.strip_prefix('o').and_then(|order| order.parse().ok());
        let case = Self {
            kind,
            level_db: level.parse().map_err(|_| malformed())?,
            effect,
            order: order.filter(|order| *order <= 2).ok_or_else(malformed)?,
            index: index.parse().map_err(|_| malformed())?,
        };
        let is_whole = match kind {
            Kind::Single | Kind::Machine | Kind::MachineRecord => effect.is_some(),
            Kind::Analyser | Kind::AnalyserRecord | Kind::Mismeasured | Kind::MismeasuredRecord => {
                true
            }
            Kind::Clean
            | Kind::Pair
            | Kind::Outsider
            | Kind::MachinePair
            | Kind::MachinePairRecord => effect.is_none(),
        };
        is_whole.then_some(case).ok_or_else(malformed)
    }
}

/// Looks up the id of an effect that can be hidden.
///
/// # Errors
/// A message that lists the known ids.
pub fn known_effect(text: &str) -> Result<&'static str, String> {
    let known = ids().into_iter().find(|id| *id == text);
    known.ok_or_else(|| format!("`{text}` is no effect; there are {}", ids().join(", ")))
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use rand::RngExt;

    use super::*;

    #[test]
    fn malformed_keys_are_refused() {
        for text in [
            "single-60-o1-4",
            "clean-60-spring-o1-4",
            "single-60-sprng-o1-4",
            "analyser-70-sprng-o1-4",
            "mismeasured-60-sprng-o1-4",
            "pair-60-o3-1",
            "machine-60-o1-4",
            "machine-2-60-spring-o1-4",
            "machinery-60-spring-o1-4",
            "x",
        ] {
            assert!(text.parse::<Case>().is_err(), "{text}");
        }
    }

    #[test]
    fn the_key_of_an_analyser_or_a_measurement_with_a_fault_has_an_effect_or_none() {
        for (kind, key, effect) in [
            (Kind::Analyser, "analyser-70-spring-o1-4", Some("spring")),
            (Kind::Analyser, "analyser-70-o1-4", None),
            (Kind::AnalyserRecord, "analyser-record-70-spring-o1-4", Some("spring")),
            (Kind::AnalyserRecord, "analyser-record-70-o1-4", None),
            (Kind::Mismeasured, "mismeasured-70-spring-o1-4", Some("spring")),
            (Kind::Mismeasured, "mismeasured-70-o1-4", None),
            (Kind::MismeasuredRecord, "mismeasured-record-70-spring-o1-4", Some("spring")),
            (Kind::MismeasuredRecord, "mismeasured-record-70-o1-4", None),
        ] {
            let case = Case { kind, level_db: 70, effect, order: 1, index: 4 };
            assert_eq!((key.parse(), case.to_string()), (Ok(case), key.to_owned()));
        }
    }

    #[test]
    fn the_key_of_a_machine_tells_one_dominant_effect_from_two_and_a_table_from_a_record() {
        for (key, kind, effect) in [
            ("machine-60-spring-o1-4", Kind::Machine, Some("spring")),
            ("machine-2-60-o1-4", Kind::MachinePair, None),
            ("machine-record-60-spring-o1-4", Kind::MachineRecord, Some("spring")),
            ("machine-2-record-60-o1-4", Kind::MachinePairRecord, None),
        ] {
            let case = Case { kind, level_db: 60, effect, order: 1, index: 4 };
            assert_eq!((key.parse(), case.to_string()), (Ok(case), key.to_owned()));
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
