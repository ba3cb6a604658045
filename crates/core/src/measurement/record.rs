//! Converts a sampled time record into the harmonics of its periods.

use std::borrow::Cow;

use super::period::{WHOLE_SAMPLES_TOLERANCE, whole_if_nearly};
use super::record_error::RecordError;
use super::repetition::Change;
use super::spectrum::{self, Periods, mean_and_deviations, power};
use super::travel::Travel;
use super::waveform::half_peak_to_peak;
use super::{
    BadSamples, Beginning, Complex, Experiment, Harmonic, Intersample, Loop, Repeat, ResponseKind,
    Transient, period, resolution, sampling, settling, significance, stated_period,
};

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

/// What is stated of a record.
#[derive(Debug, Clone, Copy, Default)]
pub struct RecordStatement {
    /// Kind of the response.
    pub kind: ResponseKind,
    /// Whether a controller was active.
    pub feedback: Option<Loop>,
    /// How the input runs between its samples.
    pub intersample: Option<Intersample>,
    /// Period of the input, s.
    pub period_s: Option<f64>,
    /// Periods at the beginning to leave out.
    pub settle_periods: Option<usize>,
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
    /// where it disappears in the noise. A position that moves on from period to period is used
    /// without that uniform motion, which becomes the mean velocity. Without `intersample` the
    /// input is the smoothest course through its samples.
    ///
    /// # Errors
    /// See [`RecordError`].
    pub fn experiment(
        &self,
        stated: RecordStatement,
    ) -> Result<(Experiment, Vec<String>), RecordError> {
        let mut remarks = Vec::new();
        let period = self.period(stated.period_s, self.step_s()?, &mut remarks)?;
        let (mut experiment, periods) = self.last_periods(period, stated, &mut remarks)?;
        if let Some((record, samples)) = self.without_bad_samples(periods, stated.kind) {
            let (mended, _) = record.last_periods(period, stated, &mut Vec::new())?;
            experiment.bad_samples = Some(Box::new(BadSamples { mended, samples }));
        }
        Ok((experiment, remarks))
    }

    /// The last whole periods, of so many samples and seconds each, with what their channels cut off, and
    /// which they are.
    fn last_periods(
        &self,
        (samples, period_s): (f64, f64),
        stated: RecordStatement,
        remarks: &mut Vec<String>,
    ) -> Result<(Experiment, Periods), RecordError> {
        let settle_periods = stated.settle_periods;
        let duration_s = self.step_s()? * self.time_s.len() as f64;
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
                    1 => "period is".to_owned(),
                    more => format!("{more} periods are"),
                };
                remarks.push(format!(
                    "the first {periods} left out, since the response has not settled; state \
                     settle_periods to choose how many"
                ));
            }
            outputs = outputs.split_off(unsettled);
        }
        remarks.push(format!("the last {} whole periods of {period_s} s are used", outputs.len()));
        let periods = Periods { samples, count: outputs.len() };
        let experiment = self.of_periods(outputs, (samples, period_s), stated, remarks);
        let clipping = self.clipping(periods, period_s, stated);
        Ok((Experiment { clipping, ..experiment }, periods))
    }

    /// The whole record as one period, and remarks on it.
    pub(super) fn one_period(
        &self,
        stated: RecordStatement,
        period_s: f64,
    ) -> (Experiment, Vec<String>) {
        let samples = self.time_s.len() as f64;
        let outputs = spectrum::of_periods(&self.output, Periods { samples, count: 1 });
        let mut remarks = Vec::new();
        let experiment = self.of_periods(outputs, (samples, period_s), stated, &mut remarks);
        (experiment, remarks)
    }

    /// Mean harmonics of the last periods, of so many samples and seconds each, from their responses.
    pub(super) fn of_periods(
        &self,
        mut outputs: Vec<Vec<Complex>>,
        (samples, period_s): (f64, f64),
        stated: RecordStatement,
        remarks: &mut Vec<String>,
    ) -> Experiment {
        let RecordStatement { kind, feedback, intersample, .. } = stated;
        let count = outputs.len();
        let periods = Periods { samples, count };
        // A closed loop holds the position.
        let is_free = kind == ResponseKind::Position && feedback != Some(Loop::Closed);
        let travel = if is_free { Travel::of(&self.output, periods) } else { Travel::None };
        let mut returning = Cow::Borrowed(&self.output);
        if travel != Travel::None {
            returning = Cow::Owned(travel.taken_out_of(&self.output, samples));
            outputs = spectrum::of_periods(&returning, periods);
        }
        let mut inputs = spectrum::of_periods(&self.input, periods);
        if let Some(intersample) = intersample {
            for (k, line) in inputs.iter_mut().flat_map(|lines| lines.iter_mut().enumerate()) {
                *line *= intersample.factor(k, samples);
            }
        }
        remarks.extend(travel.remark(&returning));
        let beginning = settling::Beginning::of(&outputs, &returning, samples);
        let rounding_std = self.rounding_std(&outputs, samples);
        // A line at the Nyquist frequency has no phase.
        let below_nyquist = (0.5 * samples).ceil() as usize;
        outputs.iter_mut().for_each(|lines| lines.truncate(below_nyquist));
        let experiment = Experiment {
            mean_velocity: travel.distance() / period_s,
            rounding_std,
            open_samples: intersample.is_none().then_some(samples),
            ..self.joined(period_s, &inputs, &outputs, remarks)
        };
        remarks.extend(beginning.remark(count));
        experiment
    }

    /// The period of the input, in samples and in seconds.
    fn period(
        &self,
        stated_s: Option<f64>,
        step_s: f64,
        remarks: &mut Vec<String>,
    ) -> Result<(f64, f64), RecordError> {
        if let Some(period_s) = stated_s {
            enough_samples(period_s, step_s)?;
            let (samples, remark) = stated_period::checked(&self.input, period_s, step_s)?;
            remarks.extend(remark);
            let is_stated = (samples * step_s / period_s - 1.0).abs() <= WHOLE_SAMPLES_TOLERANCE;
            return Ok((samples, if is_stated { period_s } else { rounded(samples * step_s) }));
        }
        let duration_s = step_s * self.time_s.len() as f64;
        let found = period::find(&self.input).ok_or(RecordError::NoPeriodFound { duration_s })?;
        enough_samples(found * step_s, step_s)?;
        let found_s = rounded(found * step_s);
        remarks.push(format!("the period of {found_s} s is found from the input"));
        Ok((whole_if_nearly(found), found_s))
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

    /// Standard deviation of a harmonic from rounding that repeats in every period.
    fn rounding_std(&self, outputs: &[Vec<Complex>], samples: f64) -> f64 {
        let (_, deviations) = mean_and_deviations(outputs);
        let others = outputs.len() - 1;
        if others == 0 {
            return 0.0;
        }
        // A line of amplitude A has the mean square A²/2.
        let scatter: f64 = deviations.iter().map(|deviation| 0.5 * power(deviation)).sum();
        let step = resolution::step(&self.output);
        (2.0 / samples * resolution::repeated_variance(step, scatter / others as f64)).sqrt()
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
        remarks.push(format!("harmonics of the response up to {highest} are used"));
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
            mean_velocity: 0.0,
            rounding_std: 0.0,
            open_samples: None,
            bad_samples: None,
            clipping: None,
            range: None,
            unknown_input: Vec::new(),
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

/// `value` to twelve digits. A step fitted to decimal times has rounding errors beyond them.
fn rounded(value: f64) -> f64 {
    format!("{value:.11e}").parse().unwrap_or(value)
}
