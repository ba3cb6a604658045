//! The sorts of fault that are drawn.

use serde::Serialize;
use servoscope_core::answers::FaultKind;

use crate::naming::case::{Case, Kind};

/// A sort of fault that is drawn: its kind and, of bad rows, how many there are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Sort {
    /// One row in a hundred is bad, at least one.
    OneBadRowInAHundred,
    /// Five rows in a hundred are bad, at least one.
    FiveBadRowsInAHundred,
    /// The stated standard deviation is wrong by a factor.
    StdFactor,
    /// One magnitude has another gain.
    LevelGain,
    /// One magnitude has another phase.
    LevelPhase,
    /// One experiment has another gain.
    RunGain,
    /// One experiment has another phase.
    RunPhase,
    /// The imaginary parts have the wrong sign.
    Conjugated,
    /// Harmonics refer to a sine.
    SineReference,
    /// The response has the wrong sign.
    ReversedSign,
    /// A position is called a velocity.
    PositionCalledVelocity,
    /// Rms values are called peak values.
    RmsCalledPeak,
    /// The response is ahead by a constant time.
    ChannelSkew,
    /// Peak-to-peak values are called peak values.
    PeakToPeakCalledPeak,
    /// Samples of a record are wrong.
    BadSamples,
    /// The channel of the input clips.
    ClippedInput,
    /// The channel of the response clips.
    ClippedResponse,
}

impl Sort {
    /// Every sort.
    pub const ALL: [Self; 17] = [
        Self::OneBadRowInAHundred,
        Self::FiveBadRowsInAHundred,
        Self::StdFactor,
        Self::LevelGain,
        Self::LevelPhase,
        Self::RunGain,
        Self::RunPhase,
        Self::Conjugated,
        Self::SineReference,
        Self::ReversedSign,
        Self::PositionCalledVelocity,
        Self::RmsCalledPeak,
        Self::ChannelSkew,
        Self::PeakToPeakCalledPeak,
        Self::BadSamples,
        Self::ClippedInput,
        Self::ClippedResponse,
    ];

    /// Number of those that are drawn in tables, which come first. Peak-to-peak values, the next,
    /// alternate with rms values in their place.
    const OF_TABLES: usize = 13;

    /// Those that are drawn in records. Their lines are computed from the samples, so that a convention
    /// of harmonics is none of them. A position that is called a velocity would move on where the axis
    /// is not symmetric, which lines cannot show.
    const OF_RECORDS: [Self; 7] = [
        Self::ReversedSign,
        Self::ChannelSkew,
        Self::RunGain,
        Self::RunPhase,
        Self::BadSamples,
        Self::ClippedInput,
        Self::ClippedResponse,
    ];

    /// The sorts of a kind of draw, in turn; none if its measurements are sound.
    pub(in crate::naming) fn all_of(kind: Kind) -> &'static [Self] {
        match kind {
            Kind::Mismeasured => &Self::ALL[..Self::OF_TABLES],
            Kind::MismeasuredRecord => &Self::OF_RECORDS,
            _ => &[],
        }
    }

    /// That of a draw, from its index; `None` if its measurement is sound.
    pub(in crate::naming) fn of(case: &Case) -> Option<Self> {
        let sorts = Self::all_of(case.kind);
        let index = case.index as usize;
        let sort = *sorts.get(index % sorts.len().max(1))?;
        let is_second = index / sorts.len() % 2 == 1;
        Some(match sort {
            Self::RmsCalledPeak if is_second => Self::PeakToPeakCalledPeak,
            sort => sort,
        })
    }

    /// Whether it changes the samples of a record, not its lines.
    pub(in crate::naming) fn is_of_samples(self) -> bool {
        matches!(self, Self::BadSamples | Self::ClippedInput | Self::ClippedResponse)
    }

    /// The kind of fault that an answer should name.
    pub fn kind(self) -> FaultKind {
        match self {
            Self::OneBadRowInAHundred | Self::FiveBadRowsInAHundred => FaultKind::BadRows,
            Self::StdFactor => FaultKind::StdFactor,
            Self::LevelGain => FaultKind::LevelGain,
            Self::LevelPhase => FaultKind::LevelPhase,
            Self::RunGain => FaultKind::RunGain,
            Self::RunPhase => FaultKind::RunPhase,
            Self::Conjugated => FaultKind::Conjugated,
            Self::SineReference => FaultKind::SineReference,
            Self::ReversedSign => FaultKind::ReversedSign,
            Self::PositionCalledVelocity => FaultKind::ResponseKind,
            Self::RmsCalledPeak | Self::PeakToPeakCalledPeak => FaultKind::AmplitudeConvention,
            Self::ChannelSkew => FaultKind::ChannelSkew,
            Self::BadSamples => FaultKind::BadSamples,
            Self::ClippedInput => FaultKind::ClippedInput,
            Self::ClippedResponse => FaultKind::ClippedResponse,
        }
    }

    /// The name of its row in a table.
    pub fn name(self) -> &'static str {
        match self {
            Self::OneBadRowInAHundred => "bad_rows, 1 in 100",
            Self::FiveBadRowsInAHundred => "bad_rows, 5 in 100",
            Self::RmsCalledPeak => "amplitude_convention, rms",
            Self::PeakToPeakCalledPeak => "amplitude_convention, peak-to-peak",
            sort => sort.kind().name(),
        }
    }
}

/// The kind of fault of this name, as far as it is drawn.
///
/// # Errors
/// A message that lists the kinds.
pub fn drawn_fault(text: &str) -> Result<FaultKind, String> {
    let is_drawn = |kind: &FaultKind| Sort::ALL.iter().any(|sort| sort.kind() == *kind);
    let drawn = || FaultKind::ALL.into_iter().filter(is_drawn);
    let names = || drawn().map(FaultKind::name).collect::<Vec<_>>().join(", ");
    let found = drawn().find(|kind| kind.name() == text);
    found.ok_or_else(|| format!("`{text}` is no fault that is drawn; there are {}", names()))
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;
    use crate::naming::Plan;

    #[test]
    fn every_kind_of_fault_is_drawn_equally_often_clean_and_with_an_effect_at_both_levels() {
        let plan = Plan { kinds: vec![Kind::Mismeasured], mismeasured: 4, ..Plan::default() };
        let mut counts: BTreeMap<(u32, bool, Sort), u32> = BTreeMap::new();
        for case in plan.cases() {
            let sort = Sort::of(&case).unwrap();
            *counts.entry((case.level_db, case.effect.is_some(), sort)).or_default() += 1;
        }
        assert_eq!(counts.len(), 2 * 2 * (Sort::OF_TABLES + 1));
        let amplitudes = [Sort::RmsCalledPeak, Sort::PeakToPeakCalledPeak];
        for ((.., sort), count) in counts {
            let share = if amplitudes.contains(&sort) { 2 } else { 1 };
            assert_eq!(count * share, 4, "{sort:?}");
        }
    }

    #[test]
    fn every_kind_of_fault_is_among_the_sorts_and_each_sort_has_a_row_of_its_own() {
        // How the input runs between samples is drawn by `recording`.
        let courses = [FaultKind::HeldInput, FaultKind::StraightInput];
        for kind in FaultKind::ALL.into_iter().filter(|kind| !courses.contains(kind)) {
            assert!(Sort::ALL.iter().any(|sort| sort.kind() == kind), "{kind:?}");
        }
        let mut names = Sort::ALL.map(Sort::name).to_vec();
        names.sort_unstable();
        names.dedup();
        assert_eq!(names.len(), Sort::ALL.len());
    }

    #[test]
    fn other_draws_have_no_fault() {
        assert_eq!(Sort::of(&"clean-60-o0-2".parse().unwrap()), None);
        let faulty = "mismeasured-60-o0-15".parse().unwrap();
        assert_eq!(Sort::of(&faulty), Some(Sort::StdFactor));
    }
}
