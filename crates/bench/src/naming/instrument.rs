//! How the machine of a draw is measured: where, which harmonics, with which noise, and what is
//! said of it.

mod draw;

use std::fmt;

use serde::Serialize;

use super::recording::Recording;
use crate::machines::draw::{Draw, DrawError, NoiseStatement, stepped_sine};
use crate::machines::noise::{NoiseLaw, RelativeNoise};
use crate::machines::responses::Responses;
use crate::machines::simulator::Settings;

/// The harmonics that a measurement contains.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Harmonics {
    /// The fundamentals alone, as in a Bode table.
    Fundamentals,
    /// From the mean (harmonic 0) up to this one.
    UpTo(usize),
}

/// What a measurement says of its noise.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum NoiseSaid {
    /// The standard deviation of every harmonic.
    Std,
    /// A coherence γ² and a number n of averages of every harmonic. They state its standard
    /// deviation, |Y|·√((1−γ²)/(2nγ²)), which is what the measurement has.
    Coherence,
    /// Nothing but this number of repeats.
    Repeats(usize),
    /// Nothing.
    Nothing,
}

impl NoiseSaid {
    /// The form of it in a measurement.
    pub fn statement(self) -> NoiseStatement {
        match self {
            Self::Std | Self::Coherence => NoiseStatement::Std,
            Self::Repeats(count) => NoiseStatement::Repeats(count),
            Self::Nothing => NoiseStatement::Silent,
        }
    }
}

impl fmt::Display for NoiseSaid {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Std => f.write_str("std"),
            Self::Coherence => f.write_str("coherence"),
            Self::Repeats(count) => write!(f, "{count} repeats"),
            Self::Nothing => f.write_str("nothing said"),
        }
    }
}

/// How the machine of a draw is measured.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Instrument {
    /// Number of magnitudes and of frequencies at each of them; `None` if they are those of the
    /// machine as it was drawn.
    pub points: Option<[usize; 2]>,
    /// The harmonics that it measures.
    pub harmonics: Harmonics,
    /// The noise that it adds.
    pub noise: RelativeNoise,
    /// What it says of that.
    pub said: NoiseSaid,
    /// The record that it makes in place of a table; `noise` is then that of the first harmonic.
    pub recording: Option<Recording>,
}

impl Instrument {
    /// The machine with the points and harmonics of this instrument.
    pub(super) fn at(&self, machine: Draw) -> Draw {
        let harmonics = match self.harmonics {
            Harmonics::Fundamentals => 1,
            Harmonics::UpTo(highest) => highest,
        };
        let ends = machine.design.first().zip(machine.design.last());
        let design = match (self.points, ends) {
            (Some([magnitudes, frequencies]), Some((first, last))) => {
                stepped_sine(first.0, magnitudes, [first.1, last.1], frequencies)
            }
            _ => machine.design,
        };
        Draw { design, harmonics, ..machine }
    }

    /// What it would measure of this machine without noise.
    ///
    /// # Errors
    /// [`DrawError::Simulator`].
    pub(super) fn responses(
        &self,
        machine: &Draw,
        settings: &Settings,
    ) -> Result<Responses, DrawError> {
        let responses = Responses::simulate(machine, settings)?;
        Ok(match self.harmonics {
            Harmonics::Fundamentals => responses.without_means(),
            Harmonics::UpTo(_) => responses,
        })
    }

    /// The law of its noise in these responses.
    ///
    /// # Errors
    /// [`DrawError::Still`].
    pub(super) fn law(&self, responses: &Responses) -> Result<NoiseLaw, DrawError> {
        responses.law(&self.noise)
    }
}

/// The noise, what is said of it and, if they are not those of the machine, the points and the
/// harmonics: `60 dB (std)`, or `64.2 dB and 0.31 % (nothing said), 2 × 34 points, harmonics 0–3`.
impl fmt::Display for Instrument {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let RelativeNoise { floor_db, share } = self.noise;
        if let Some(recording) = self.recording {
            return write!(f, "{floor_db:.1} dB, {recording}");
        }
        let Some([magnitudes, frequencies]) = self.points else {
            return write!(f, "{floor_db:.0} dB ({})", self.said);
        };
        let percent = 100.0 * share;
        write!(f, "{floor_db:.1} dB and {percent:.2} % ({}), ", self.said)?;
        write!(f, "{magnitudes} × {frequencies} points, ")?;
        match self.harmonics {
            Harmonics::Fundamentals => f.write_str("fundamentals"),
            Harmonics::UpTo(highest) => write!(f, "harmonics 0–{highest}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::machines::draw::draw;
    use crate::naming::Case;

    fn instrument(key: &str) -> Instrument {
        let case: Case = key.parse().unwrap();
        Instrument::of(&case, &mut case.rng(1))
    }

    #[test]
    fn an_analyser_measures_in_the_band_of_the_machine_from_its_lowest_magnitude() {
        let machine = draw(2, 5);
        let analyser = Instrument {
            points: Some([2, 23]),
            harmonics: Harmonics::Fundamentals,
            ..instrument("analyser-70-o2-0")
        };
        let found = analyser.at(machine.clone());
        assert_eq!((found.design.len(), found.harmonics), (46, 1));
        assert_eq!(found.design[0], machine.design[0]);
        assert_eq!(found.design[23].0, 2.0 * machine.design[0].0);
        // Rounding of a power.
        assert!((found.design[45].1 / machine.design[47].1 - 1.0).abs() < 1e-12);
        assert_eq!(instrument("clean-60-o2-0").at(machine.clone()), machine);
    }

    #[test]
    fn fundamentals_alone_are_harmonic_1_of_every_experiment_and_repeat() {
        let analyser = Instrument {
            points: Some([1, 10]),
            harmonics: Harmonics::Fundamentals,
            said: NoiseSaid::Repeats(3),
            ..instrument("analyser-70-o0-0")
        };
        let machine = analyser.at(draw(0, 5));
        let responses = analyser.responses(&machine, &Settings::default()).unwrap();
        let case: Case = "analyser-70-o0-0".parse().unwrap();
        let statement = analyser.said.statement();
        let measured = responses.noisy(&analyser.noise, statement, &mut case.rng(1)).unwrap();
        assert_eq!(measured.experiments().len(), 10);
        for experiment in measured.experiments() {
            let orders: Vec<usize> = experiment.response.iter().map(|h| h.order).collect();
            assert_eq!(orders, [1]);
            assert!(experiment.repeats.iter().all(|repeat| repeat.response.len() == 1));
            assert_eq!(experiment.repeats.len(), 3);
        }
    }

    #[test]
    fn the_text_says_what_was_drawn() {
        assert_eq!(instrument("single-50-spring-o0-4").to_string(), "50 dB (6 repeats)");
        let analyser = Instrument {
            points: Some([2, 34]),
            harmonics: Harmonics::UpTo(3),
            noise: RelativeNoise { floor_db: 64.23, share: 0.003_1 },
            said: NoiseSaid::Nothing,
            recording: None,
        };
        let expected = "64.2 dB and 0.31 % (nothing said), 2 × 34 points, harmonics 0–3";
        assert_eq!(analyser.to_string(), expected);
        let recording = Some(Recording::Multisine { levels: 2 });
        let noise = RelativeNoise::decibels(57.04);
        let recorder = Instrument { points: None, noise, recording, ..analyser };
        assert_eq!(recorder.to_string(), "57.0 dB, multisine at 2 levels");
    }
}
