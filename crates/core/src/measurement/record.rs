//! Converts a sampled time record into the harmonics of its periods.

use super::repetition::Change;
use super::spectrum::{self, Periods};
use super::waveform::half_peak_to_peak;
use super::{
    Beginning, Complex, Experiment, Harmonic, Intersample, Repeat, Transient, period, sampling,
    settling, significance, stated_period,
};

/// Largest relative difference between a period in samples and a whole number at which it is
/// rounded to that number.
const WHOLE_SAMPLES_TOLERANCE: f64 = 1e-6;

/// Deviations between periods below this share of the spectrum's norm are rounding errors of the
/// Fourier transform: the periods are copies of each other.
const ROUNDING_SHARE: f64 = 1e-13;

/// Input and response of one axis, sampled together.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Record {
    /// Times, s.
    pub time_s: Vec<f64>,
    /// Input, input units.
    pub input: Vec<f64>,
    /// Response, response units.
    pub output: Vec<f64>,
    /// Position in the order of acquisition, if known.
    pub run: Option<f64>,
}

/// Why a record cannot be converted into an experiment. Sample indices start at 0.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum RecordError {
    /// Time stands still or runs backwards.
    #[error("time does not increase: {time_s} s comes after {before_s} s")]
    NotIncreasing {
        /// The later sample.
        sample: usize,
        /// Its time, s.
        time_s: f64,
        /// Time of the sample before, s.
        before_s: f64,
    },
    /// The time steps are not equal.
    #[error("sampling is unequal: a step of {step_s:.6e} s where {usual_s:.6e} s is usual")]
    UnequalSampling {
        /// The sample at the end of the step that differs most.
        sample: usize,
        /// That step, s.
        step_s: f64,
        /// The median step, s.
        usual_s: f64,
    },
    /// The record has too few samples.
    #[error("the record has {samples} samples, which is too few")]
    TooShort {
        /// Number of samples.
        samples: usize,
    },
    /// No period was given, and none is found in the input.
    #[error(
        "no period is found in the input of {duration_s} s, which must hold at least two: \
         give period_s"
    )]
    NoPeriodFound {
        /// Duration of the record, s.
        duration_s: f64,
    },
    /// The input does not repeat with the given period.
    #[error(
        "the input does not repeat with the period of {period_s} s that is given: from one period \
         to the next it changes by {percent:.0} % of its root mean square; give the right \
         period_s, leave it out to have the period found, or say period_s: none where the record \
         does not repeat"
    )]
    NotRepeating {
        /// The period, s.
        period_s: f64,
        /// Change of the input from one period to the next, % of its root mean square.
        percent: f64,
    },
    /// The input repeats with another period than the given one.
    #[error(
        "the input does not repeat with the period of {period_s} s that is given, but with \
         {found_s} s: give that as period_s, or leave period_s out to have the period found"
    )]
    OtherPeriod {
        /// The given period, s.
        period_s: f64,
        /// The period that the input shows, s.
        found_s: f64,
    },
    /// The period has too few samples.
    #[error("the period {period_s} s has {samples:.3} samples, and at least 4 are needed")]
    Undersampled {
        /// The period, s.
        period_s: f64,
        /// Samples in it.
        samples: f64,
    },
    /// The record does not hold one whole period after the dropped ones.
    #[error(
        "no whole period: the record lasts {duration_s:.6} s, its period is {period_s} s, and \
         {settle_periods} periods are dropped"
    )]
    NoWholePeriod {
        /// Duration of the record, s.
        duration_s: f64,
        /// The period, s.
        period_s: f64,
        /// Periods dropped at its beginning.
        settle_periods: usize,
    },
}

impl Record {
    /// Sampling interval, s, by least squares over all samples.
    ///
    /// # Errors
    /// If time does not increase, or sampling is unequal.
    pub fn step_s(&self) -> Result<f64, RecordError> {
        sampling::step_s(&self.time_s)
    }

    /// Mean harmonics of the last whole periods, with the deviation of each period, and remarks on
    /// how they were found.
    ///
    /// Without `period_s` the period is found from the input. The first `settle_periods` are
    /// dropped; without it, those in which the response has not settled, if enough others follow.
    /// Phases refer to the beginning of the first period used. The harmonics of the input reach up
    /// to the Nyquist frequency, since all of them drive the machine; those of the response end
    /// where it disappears in the noise.
    ///
    /// # Errors
    /// See [`RecordError`].
    pub fn experiment(
        &self,
        period_s: Option<f64>,
        settle_periods: Option<usize>,
    ) -> Result<(Experiment, Vec<String>), RecordError> {
        let mut remarks = Vec::new();
        let step_s = self.step_s()?;
        let duration_s = step_s * self.time_s.len() as f64;
        if let Some(period_s) = period_s {
            enough_samples(period_s, step_s)?;
        }
        let (samples, period_s) = match period_s {
            Some(period_s) => {
                let (samples, remark) = stated_period::checked(&self.input, period_s, step_s)?;
                remarks.extend(remark);
                let is_stated =
                    (samples * step_s / period_s - 1.0).abs() <= WHOLE_SAMPLES_TOLERANCE;
                (samples, if is_stated { period_s } else { rounded(samples * step_s) })
            }
            None => {
                let found = period::find(&self.input);
                let found = found.ok_or(RecordError::NoPeriodFound { duration_s })?;
                enough_samples(found * step_s, step_s)?;
                let found_s = rounded(found * step_s);
                remarks.push(format!("the period of {found_s} s is found from the input"));
                (whole_if_nearly(found), found_s)
            }
        };
        let change = Change::of(&self.input, samples);
        if let Some(Change { share, .. }) = change.filter(|change| change.is_large()) {
            let percent = 100.0 * share;
            remarks.push(format!(
                "from one period to the next the input changes by {percent:.0} % of its root mean \
                 square"
            ));
        }
        let available = (self.time_s.len() as f64 / samples + WHOLE_SAMPLES_TOLERANCE) as usize;
        let count = available.saturating_sub(settle_periods.unwrap_or(0));
        if count == 0 {
            let settle_periods = settle_periods.unwrap_or(0);
            return Err(RecordError::NoWholePeriod { duration_s, period_s, settle_periods });
        }
        let mut outputs = spectrum::of_periods(&self.output, Periods { samples, count });
        if settle_periods.is_none() {
            let unsettled = settling::unsettled_periods(&outputs);
            if unsettled > 0 {
                let periods = match unsettled {
                    1 => "period".to_owned(),
                    more => format!("{more} periods"),
                };
                remarks.push(format!(
                    "in the first {periods} the response has not settled: left out; state \
                     settle_periods to choose for yourself"
                ));
            }
            outputs = outputs.split_off(unsettled);
        }
        let count = outputs.len();
        let periods = Periods { samples, count };
        let inputs = spectrum::of_periods(&self.input, periods);
        remarks.push(format!("the last {count} whole periods of {period_s} s are used"));
        let beginning = settling::Beginning::of(&outputs, &self.output, samples);
        let experiment = self.joined(period_s, &inputs, &outputs, &mut remarks);
        remarks.extend(beginning.remark(count));
        Ok((experiment, remarks))
    }

    /// The whole record as one motion that does not repeat.
    ///
    /// # Errors
    /// If time does not increase, or sampling is unequal.
    pub fn transient(
        &self,
        intersample: Intersample,
        beginning: Beginning,
    ) -> Result<Transient, RecordError> {
        Ok(Transient {
            step_s: self.step_s()?,
            input: self.input.clone(),
            output: self.output.clone(),
            intersample,
            beginning,
            run: self.run,
        })
    }

    fn joined(
        &self,
        period_s: f64,
        inputs: &[Vec<Complex>],
        outputs: &[Vec<Complex>],
        remarks: &mut Vec<String>,
    ) -> Experiment {
        let (input, input_deviations) = mean_and_deviations(inputs);
        let (output, output_deviations) = mean_and_deviations(outputs);
        let scatters = |deviations: &[Vec<Complex>], mean: &[Complex]| {
            let rounding = ROUNDING_SHARE * ROUNDING_SHARE * power(mean);
            deviations.iter().any(|deviation| power(deviation) > rounding)
        };
        let input_scatters = scatters(&input_deviations, &input);
        let output_scatters = scatters(&output_deviations, &output);
        let highest = if output_scatters {
            let deviations: Vec<&[Complex]> = output_deviations.iter().map(Vec::as_slice).collect();
            significance::highest_of_periods(&output, &deviations)
        } else {
            significance::highest_of_one_period(&output, &input)
        };
        if inputs.len() == 1 {
            remarks.push("one whole period: its scatter is not known".into());
        } else if !input_scatters && !output_scatters {
            remarks.push("the periods are copies and say nothing of the noise".into());
        }
        remarks.push(format!("{highest} output harmonics above the noise are used"));
        let repeats = input_deviations
            .into_iter()
            .zip(output_deviations)
            .map(|(input, mut response)| {
                response.truncate(highest + 1);
                Repeat { input: if input_scatters { input } else { Vec::new() }, response }
            })
            .take_while(|_| input_scatters || output_scatters)
            .collect();
        Experiment {
            magnitude: half_peak_to_peak(&input),
            omega_rad_s: std::f64::consts::TAU / period_s,
            input,
            input_mean_measured: true,
            response: output[..=highest]
                .iter()
                .enumerate()
                .map(|(order, value)| Harmonic { order, value: *value, std: None })
                .collect(),
            run: self.run,
            repeats,
            from_record: true,
        }
    }
}

fn enough_samples(period_s: f64, step_s: f64) -> Result<(), RecordError> {
    let samples = period_s / step_s;
    match samples < period::SHORTEST {
        true => Err(RecordError::Undersampled { period_s, samples }),
        false => Ok(()),
    }
}

/// The nearest whole number if `samples` hardly differs from it, else `samples`.
pub(super) fn whole_if_nearly(samples: f64) -> f64 {
    let whole = samples.round();
    if (samples - whole).abs() <= WHOLE_SAMPLES_TOLERANCE * samples { whole } else { samples }
}

/// `value` to twelve digits. A step fitted to decimal times has rounding errors beyond them.
fn rounded(value: f64) -> f64 {
    format!("{value:.11e}").parse().unwrap_or(value)
}

pub(super) fn power(harmonics: &[Complex]) -> f64 {
    harmonics.iter().map(Complex::norm_sqr).sum()
}

pub(super) fn mean_and_deviations(spectra: &[Vec<Complex>]) -> (Vec<Complex>, Vec<Vec<Complex>>) {
    let count = spectra.len() as f64;
    let mean: Vec<Complex> = (0..spectra[0].len())
        .map(|k| spectra.iter().map(|spectrum| spectrum[k]).sum::<Complex>() / count)
        .collect();
    let deviations = spectra
        .iter()
        .map(|spectrum| spectrum.iter().zip(&mean).map(|(value, mean)| value - mean).collect())
        .collect();
    (mean, deviations)
}
