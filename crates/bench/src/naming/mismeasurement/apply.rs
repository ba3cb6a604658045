//! What a fault does to the numbers of a measurement.

use std::f64::consts::{FRAC_1_SQRT_2, FRAC_PI_2};

use servoscope_core::measurement::{Complex, Experiment, InvalidMeasurement, Measurement};

use super::Mismeasurement;
use super::bad_row::DETECTABLE_SIGMAS;
use crate::machines::noise::NoiseLaw;

/// A line of an input that is larger than this share of its largest line is excited.
const EXCITED: f64 = 1e-3;

impl Mismeasurement {
    /// The measurement with this fault.
    ///
    /// # Errors
    /// [`InvalidMeasurement`] if a value leaves the range that arithmetic can handle.
    pub fn apply(&self, sound: &Measurement) -> Result<Measurement, InvalidMeasurement> {
        let mut experiments = sound.experiments().to_vec();
        for (place, experiment) in experiments.iter_mut().enumerate() {
            self.spoil(place, experiment);
        }
        let (metadata, notes) = (sound.metadata().clone(), sound.notes().to_vec());
        Measurement::new(metadata, experiments, notes, sound.sha256().to_owned())
    }

    /// Whether it moves a row, or the response to its line of the input, by more than five true standard
    /// deviations of re or im. A wrong statement of the noise moves nothing but shows in every row.
    pub(in crate::naming) fn shows(
        &self,
        sound: &Measurement,
        faulty: &Measurement,
        law: &NoiseLaw,
    ) -> bool {
        match self {
            Self::StdFactor { .. } => return true,
            Self::BadRows(rows) => return rows.iter().any(|row| row.is_detectable()),
            _ => {}
        }
        let moved = |(before, after): (&Experiment, &Experiment)| {
            let largest = before.input.iter().map(|line| line.norm()).fold(0.0, f64::max);
            before.response.iter().any(|row| {
                let line = |of: &Experiment| of.input.get(row.order).copied();
                let excited = line(before).filter(|line| line.norm() > EXCITED * largest);
                // A line of the input that is off by a share of itself moves the response to it by as much.
                let by_input = match (excited, line(after)) {
                    (Some(was), Some(is)) => row.value.norm() * (is / was - Complex::ONE).norm(),
                    _ => 0.0,
                };
                let by_itself =
                    after.harmonic(row.order).map_or(0.0, |h| (h.value - row.value).norm());
                by_input + by_itself > DETECTABLE_SIGMAS * law.std_of(row.value.norm())
            })
        };
        sound.experiments().iter().zip(faulty.experiments()).any(moved)
    }

    fn spoil(&self, place: usize, experiment: &mut Experiment) {
        match self {
            Self::BadRows(rows) => {
                let here = rows.iter().filter(|row| row.experiment == place);
                here.for_each(|row| row.spoil(experiment));
            }
            Self::StdFactor { factor } => {
                for harmonic in &mut experiment.response {
                    harmonic.std = harmonic.std.map(|std| std * factor);
                }
            }
            Self::Conjugated => {
                for harmonic in &mut experiment.response {
                    harmonic.value = harmonic.value.conj();
                }
                for deviation in experiment.repeats.iter_mut().flat_map(|one| &mut one.response) {
                    *deviation = deviation.conj();
                }
            }
            _ => self.multiply(place, experiment),
        }
        let has_mean = experiment.response.first().is_some_and(|first| first.order == 0);
        if *self == Self::PositionCalledVelocity && has_mean {
            experiment.response.remove(0);
            for repeat in &mut experiment.repeats {
                repeat.response.remove(0);
            }
        }
    }

    /// Multiplies every harmonic with its factor, with its noise and what is stated of that.
    fn multiply(&self, place: usize, experiment: &mut Experiment) {
        let orders = experiment.response.iter().map(|harmonic| harmonic.order);
        let factors: Vec<Complex> =
            orders.map(|order| self.factor(place, experiment, order)).collect();
        for (harmonic, factor) in experiment.response.iter_mut().zip(&factors) {
            harmonic.value *= factor;
            harmonic.std = harmonic.std.map(|std| std * factor.norm());
        }
        for repeat in &mut experiment.repeats {
            repeat.response.iter_mut().zip(&factors).for_each(|(value, factor)| *value *= factor);
        }
    }

    /// Measured over true value of a harmonic.
    fn factor(&self, place: usize, experiment: &Experiment, order: usize) -> Complex {
        let k = order as f64;
        let turned = |radians: f64| Complex::from_polar(1.0, radians);
        match *self {
            Self::LevelGain { magnitude, factor } if experiment.magnitude == magnitude => {
                factor.into()
            }
            Self::LevelPhase { magnitude, degrees } if experiment.magnitude == magnitude => {
                turned(k * degrees.to_radians())
            }
            Self::RunGain { experiment, factor } if experiment == place => factor.into(),
            Self::RunPhase { experiment, degrees } if experiment == place => {
                turned(k * degrees.to_radians())
            }
            Self::SineReference if order > 0 => turned((1.0 - k) * FRAC_PI_2),
            Self::ReversedSign => Complex::new(-1.0, 0.0),
            Self::PositionCalledVelocity if order > 0 => {
                Complex::new(0.0, -1.0 / (k * experiment.omega_rad_s))
            }
            Self::RmsCalledPeak if order > 0 => FRAC_1_SQRT_2.into(),
            Self::PeakToPeakCalledPeak if order > 0 => 2.0.into(),
            Self::ChannelSkew { seconds } => turned(k * experiment.omega_rad_s * seconds),
            _ => Complex::new(1.0, 0.0),
        }
    }
}

#[cfg(test)]
mod tests {
    use servoscope_core::answers::Channel;
    use servoscope_core::measurement::Harmonic;

    use super::super::fixtures::{LAW, table};
    use super::*;

    /// Checks that every harmonic and every repeat's deviation has become what `expected` makes of
    /// it, and that what is stated of its noise follows.
    fn check(fault: &Mismeasurement, expected: impl Fn(usize, &Experiment, usize) -> Complex) {
        for repeats in [0, 3] {
            let sound = table(repeats);
            let faulty = fault.apply(&sound).unwrap();
            let pairs = sound.experiments().iter().zip(faulty.experiments());
            for (place, (before, after)) in pairs.enumerate() {
                assert_eq!(after.repeats.len(), repeats);
                for (row, found) in after.response.iter().enumerate() {
                    let factor = expected(place, before, found.order);
                    let from = before.response.iter().position(|h| h.order == found.order).unwrap();
                    let Harmonic { value, std, .. } = before.response[from];
                    near(found.value, value * factor);
                    assert_eq!(found.std.is_some(), repeats == 0);
                    if let Some((found, std)) = found.std.zip(std) {
                        assert!((found / (std * factor.norm()) - 1.0).abs() < 1e-12);
                    }
                    for (one, was) in after.repeats.iter().zip(&before.repeats) {
                        near(one.response[row], was.response[from] * factor);
                    }
                }
            }
        }
    }

    fn near(found: Complex, expected: Complex) {
        assert!((found - expected).norm() <= 1e-12 * expected.norm(), "{found} for {expected}");
    }

    const ONE: Complex = Complex::new(1.0, 0.0);
    const J: Complex = Complex::new(0.0, 1.0);

    #[test]
    fn a_gain_or_phase_concerns_its_level_or_experiment_alone_and_harmonic_k_turns_k_times() {
        let turn = |k: usize| Complex::from_polar(1.0, k as f64 * 5.0_f64.to_radians());
        check(&Mismeasurement::LevelGain { magnitude: 2.0, factor: 0.95 }, |_, e, _| {
            if e.magnitude == 2.0 { 0.95.into() } else { ONE }
        });
        check(&Mismeasurement::LevelPhase { magnitude: 4.0, degrees: 5.0 }, |_, e, k| {
            if e.magnitude == 4.0 { turn(k) } else { ONE }
        });
        check(&Mismeasurement::RunGain { experiment: 7, factor: 1.2 }, |place, _, _| {
            if place == 7 { 1.2.into() } else { ONE }
        });
        check(&Mismeasurement::RunPhase { experiment: 0, degrees: 5.0 }, |place, _, k| {
            if place == 0 { turn(k) } else { ONE }
        });
    }

    // The noise of the fundamental, 2.2 to 8.9 in size, is 0.01.
    #[test]
    fn a_wrong_input_shows_where_the_response_to_it_moves_by_five_deviations() {
        let sound = table(0);
        let shows = |change: f64| {
            let mut experiments = sound.experiments().to_vec();
            experiments[11].input[1] *= 1.0 + change;
            let metadata = sound.metadata().clone();
            let faulty = Measurement::new(metadata, experiments, Vec::new(), String::new());
            let (channel, limit) = (Channel::Input, 4.0);
            let fault = Mismeasurement::Clipped { channel, limit, share: 0.01 };
            fault.shows(&sound, &faulty.unwrap(), &LAW)
        };
        assert!(shows(0.006) && !shows(0.005));
    }

    #[test]
    fn a_sine_reference_is_undone_by_a_quarter_turn_for_every_harmonic_above_the_first() {
        check(&Mismeasurement::SineReference, |_, _, k| match k {
            0 => ONE,
            _ => ONE / J.powu(k as u32 - 1),
        });
    }

    #[test]
    fn a_position_is_the_velocity_over_jk_omega_without_a_mean() {
        let fault = Mismeasurement::PositionCalledVelocity;
        check(&fault, |_, e, k| ONE / (J * k as f64 * e.omega_rad_s));
        for repeats in [0, 3] {
            for experiment in fault.apply(&table(repeats)).unwrap().experiments() {
                assert_eq!(experiment.response[0].order, 1);
                assert!(experiment.repeats.iter().all(|one| one.response.len() == 3));
            }
        }
    }

    #[test]
    fn other_conventions_change_all_but_the_mean_and_a_skew_grows_with_frequency() {
        check(
            &Mismeasurement::PeakToPeakCalledPeak,
            |_, _, k| {
                if k == 0 { ONE } else { 2.0.into() }
            },
        );
        check(&Mismeasurement::RmsCalledPeak, |_, _, k| {
            if k == 0 { ONE } else { (1.0 / 2.0_f64.sqrt()).into() }
        });
        check(&Mismeasurement::ChannelSkew { seconds: 0.01 }, |_, e, k| {
            (J * k as f64 * e.omega_rad_s * 0.01).exp()
        });
        check(&Mismeasurement::ReversedSign, |_, _, _| -ONE);
    }

    #[test]
    fn conjugation_turns_the_sign_of_imaginary_parts_of_repeats_too() {
        for repeats in [0, 3] {
            let sound = table(repeats);
            let faulty = Mismeasurement::Conjugated.apply(&sound).unwrap();
            for (before, after) in sound.experiments().iter().zip(faulty.experiments()) {
                for (was, is) in before.response.iter().zip(&after.response) {
                    assert_eq!((is.value, is.std), (was.value.conj(), was.std));
                }
                for (was, is) in before.repeats.iter().zip(&after.repeats) {
                    let conjugated: Vec<_> = was.response.iter().map(Complex::conj).collect();
                    assert_eq!(is.response, conjugated);
                }
            }
        }
    }

    #[test]
    fn a_wrong_statement_of_the_noise_leaves_all_values() {
        let sound = table(0);
        let faulty = Mismeasurement::StdFactor { factor: 0.5 }.apply(&sound).unwrap();
        for (before, after) in sound.experiments().iter().zip(faulty.experiments()) {
            for (was, is) in before.response.iter().zip(&after.response) {
                assert_eq!((is.value, is.std), (was.value, was.std.map(|std| 0.5 * std)));
            }
        }
    }

    #[test]
    fn a_fault_shows_where_it_moves_a_row_beyond_the_noise() {
        let sound = table(0);
        let shows =
            |fault: Mismeasurement| fault.shows(&sound, &fault.apply(&sound).unwrap(), &LAW);
        // The largest value of the first experiment is √5, its noise 0.01.
        assert!(!shows(Mismeasurement::RunGain { experiment: 0, factor: 1.02 }));
        assert!(shows(Mismeasurement::RunGain { experiment: 0, factor: 1.03 }));
        assert!(shows(Mismeasurement::StdFactor { factor: 2.0 }));
        assert!(!shows(Mismeasurement::BadRows(Vec::new())));
    }
}
