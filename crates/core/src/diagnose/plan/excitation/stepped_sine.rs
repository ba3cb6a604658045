//! The experiments of a plan as one input, with ramps between them.

use std::f64::consts::{PI, TAU};

use crate::answers::Plan;
use crate::diagnose::plan::design::{sample_s, samples_per_period};
use crate::diagnose::plan::setting::Setting;

use super::Samples;

/// A ramp takes this share of the settling, and a period at most.
const RAMP_SHARE: f64 = 0.25;

/// All steps in their order. Each begins with a ramp, in which the amplitude of the step before falls while
/// its own rises; then it settles; then its periods are measured. In the end the input falls to 0.
pub(super) fn samples(plan: &Plan, setting: &Setting) -> Samples {
    let step_s = sample_s(setting);
    let mut values = Vec::new();
    let cosine = |magnitude: f64, period: usize, sample: usize| {
        magnitude * (TAU * (sample % period) as f64 / period as f64).cos()
    };
    let mut before = (0.0, 1);
    for experiment in &plan.experiments {
        let period = samples_per_period(setting, experiment.omega_rad_s);
        let settle = experiment.settle_periods * period;
        let ramp = ((RAMP_SHARE * settle as f64) as usize).clamp(1, period);
        let measured = experiment.repeats * experiment.measured_periods * period;
        for sample in 0..settle + measured {
            let own = cosine(experiment.magnitude, period, sample);
            let value = match sample < ramp {
                true => {
                    let share = rise(sample, ramp);
                    share * own + (1.0 - share) * cosine(before.0, before.1, sample)
                }
                false => own,
            };
            values.push((value, (sample >= settle).then_some(experiment.run)));
        }
        before = (experiment.magnitude, period);
    }
    let (magnitude, period) = before;
    let fall = |sample| (1.0 - rise(sample, period)) * cosine(magnitude, period, sample);
    values.extend((0..period).map(|sample| (fall(sample), None)));
    values.push((0.0, None));
    let comments = vec![
        "stepped sine: one segment for each experiment; rows without a segment are ramps and settling".into(),
        "add a column output with the measured velocity in the same rows, and servoscope reads the file".into(),
    ];
    Samples { step_s, values, comments }
}

/// A raised cosine from 0 to 1.
fn rise(sample: usize, ramp: usize) -> f64 {
    0.5 - 0.5 * (PI * sample as f64 / ramp as f64).cos()
}
