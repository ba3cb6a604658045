//! The response of a model as the channel that measures it reads it.

use std::cell::RefCell;

use rustfft::FftPlanner;

use super::Prepared;
use crate::effects::{ActiveEffect, Wide};
use crate::measurement::{ChannelRange, Complex};
use crate::plant::Plant;
use crate::simulate::{self, Counts, NoResponse, Response};

thread_local! {
    static PLANNER: RefCell<FftPlanner<f64>> = RefCell::new(FftPlanner::new());
}

impl Prepared {
    /// The velocity harmonics of a model up to the highest that is compared, as they are read.
    ///
    /// # Errors
    /// See [`NoResponse`].
    pub fn respond(
        &self,
        counts: Counts<'_>,
        plant: &Plant,
        effects: &[ActiveEffect],
    ) -> Result<Vec<Complex>, NoResponse> {
        let (excitation, simulated) = (&self.excitation, self.highest_simulated());
        let mut velocity = simulate::respond_if(counts, plant, effects, excitation, simulated)?;
        if let Some(range) = self.range {
            range.cut_off(&mut velocity, &mut []);
            velocity.truncate(self.highest + 1);
        }
        Ok(velocity)
    }

    /// The same, with the derivatives by the first `variables` lanes of the plant and by the effects'
    /// parameters.
    ///
    /// # Errors
    /// See [`NoResponse`].
    pub fn respond_with_sensitivities(
        &self,
        counts: Counts<'_>,
        (plant, variables): (&Plant<Wide>, usize),
        effects: &[ActiveEffect],
    ) -> Result<Response, NoResponse> {
        let (excitation, simulated) = (&self.excitation, self.highest_simulated());
        let mut response = simulate::respond_with_sensitivities(
            counts, plant, variables, effects, excitation, simulated,
        )?;
        if let Some(range) = self.range {
            range.cut_off(&mut response.velocity, &mut response.sensitivities);
            let rows = response.sensitivities.iter_mut().chain([&mut response.velocity]);
            rows.for_each(|row| row.truncate(self.highest + 1));
        }
        Ok(response)
    }

    /// Highest harmonic that is simulated. Where a channel cuts off samples, all harmonics decide of which
    /// samples it does.
    fn highest_simulated(&self) -> usize {
        let below_nyquist = self.range.map_or(0, |range| range.samples.saturating_sub(1) / 2);
        self.highest.max(below_nyquist)
    }
}

impl ChannelRange {
    /// The same in other units.
    pub(in crate::identify) fn scaled(self, factor: f64) -> Self {
        Self { lowest: self.lowest * factor, highest: self.highest * factor, ..self }
    }

    /// Turns harmonics of a response into those of its samples after what lies beyond the range is cut
    /// off; and their derivatives, which vanish there. In place.
    fn cut_off(self, lines: &mut [Complex], rows: &mut [Vec<Complex>]) {
        let Self { lowest, highest, samples: length } = self;
        let (forward, back) = PLANNER.with_borrow_mut(|planner| {
            (planner.plan_fft_forward(length), planner.plan_fft_inverse(length))
        });
        let sampled = |lines: &[Complex]| {
            let mut values = vec![Complex::ZERO; length];
            for (k, line) in lines.iter().enumerate().take(length / 2 + 1) {
                values[k] += 0.5 * line;
                values[(length - k) % length] += 0.5 * line.conj();
            }
            back.process(&mut values);
            values
        };
        let replace = |lines: &mut [Complex], mut values: Vec<Complex>| {
            forward.process(&mut values);
            for (k, line) in lines.iter_mut().enumerate().take(length / 2 + 1) {
                let mirrored = k == 0 || 2 * k == length;
                *line = values[k] * (if mirrored { 1.0 } else { 2.0 } / length as f64);
            }
        };
        let mut values = sampled(lines);
        let is_cut: Vec<bool> =
            values.iter().map(|value| !(lowest..=highest).contains(&value.re)).collect();
        if !is_cut.contains(&true) {
            return;
        }
        values.iter_mut().for_each(|value| value.re = value.re.clamp(lowest, highest));
        replace(lines, values);
        for row in rows {
            let mut values = sampled(row);
            let cut = values.iter_mut().zip(&is_cut).filter(|(_, is_cut)| **is_cut);
            cut.for_each(|(value, _)| *value = Complex::ZERO);
            replace(row, values);
        }
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;
    use crate::identify::fixtures::{ACTUATORS, axis, joined, multisine};
    use crate::identify::problem::Problem;

    // Folds leave lines out.
    #[test]
    fn a_channel_cuts_off_the_same_of_a_model_whatever_lines_are_compared() {
        let plant = axis(ACTUATORS[0]);
        let mut experiments = multisine(&plant).experiments().to_vec();
        experiments[0].range = Some(ChannelRange { lowest: -1.0, highest: 1.0, samples: 64 });
        let all = Problem::new(&joined(experiments)).unwrap();
        let few = all.only(&all.subset(|_, target| target.order < 10));
        let plant = all.in_scale(&plant);
        let lines = |problem: &Problem| {
            problem.experiments[0].respond(Counts::FromRest, &plant, &[]).unwrap()
        };
        let (all, few) = (lines(&all), lines(&few));
        assert_eq!((all.len(), few.len()), (31, 10));
        assert_eq!(all[..10], few);
    }

    // The fundamental of a cosine that is cut off at c: (2/π)(asin c + c·√(1 − c²)), and its derivative
    // by the amplitude at 1, (2/π)(asin c − c·√(1 − c²)).
    #[test]
    fn a_cosine_that_is_cut_off_has_the_fundamental_of_a_saturation() {
        let range = ChannelRange { lowest: -0.6, highest: 0.6, samples: 40_000 };
        let cosine = vec![Complex::ZERO, Complex::ONE];
        let (mut lines, mut rows) = (cosine.clone(), [cosine]);
        range.cut_off(&mut lines, &mut rows);
        let (angle, chord) = (0.6_f64.asin(), 0.6 * 0.8);
        // One sample more or less: 1e-4.
        assert!((lines[1] - 2.0 / PI * (angle + chord)).norm() < 1e-4, "{lines:?}");
        assert!((rows[0][1] - 2.0 / PI * (angle - chord)).norm() < 1e-4, "{rows:?}");
    }

    #[test]
    fn what_lies_in_the_range_is_read_as_it_is() {
        let range = ChannelRange { lowest: -2.0, highest: f64::INFINITY, samples: 16 };
        let before = vec![Complex::new(0.5, 0.0), Complex::new(0.3, -0.9)];
        let mut lines = before.clone();
        range.cut_off(&mut lines, &mut []);
        assert_eq!(lines, before);
    }
}
