//! Experiments without the repeats that have wrong rows.

use crate::answers::MeasurementFault;
use crate::measurement::{Complex, Experiment, Harmonic, Repeat};

/// The experiment without the repeats that have a row to be left out, its means computed again; unchanged
/// if fewer than two would be left.
pub(super) fn without_repeats(
    index: usize,
    experiment: &Experiment,
    faults: &[MeasurementFault],
) -> Experiment {
    let rows = faults.iter().flat_map(|fault| &fault.left_out);
    let left_out: Vec<usize> =
        rows.filter(|row| row.experiment == index).filter_map(|row| row.repeat).collect();
    let rest: Vec<&Repeat> = experiment
        .repeats
        .iter()
        .enumerate()
        .filter(|(repeat, _)| !left_out.contains(repeat))
        .map(|(_, repeat)| repeat)
        .collect();
    if left_out.is_empty() || rest.len() < 2 {
        return experiment.clone();
    }
    let count = rest.len() as f64;
    let mean =
        |of: &dyn Fn(&Repeat) -> Complex| rest.iter().map(|r| of(r)).sum::<Complex>() / count;
    let response: Vec<Complex> =
        (0..experiment.response.len()).map(|i| mean(&|repeat| repeat.response[i])).collect();
    let shift = |i: usize| mean(&|repeat| repeat.input.get(i).copied().unwrap_or(Complex::ZERO));
    let input: Vec<Complex> = (0..experiment.input.len()).map(shift).collect();
    let less = |values: &[Complex], mean: &[Complex]| -> Vec<Complex> {
        values.iter().zip(mean).map(|(value, mean)| value - mean).collect()
    };
    let ratio = (experiment.repeats.len() as f64 / count).sqrt();
    Experiment {
        input: experiment.input.iter().zip(&input).map(|(u, shift)| u + shift).collect(),
        response: experiment
            .response
            .iter()
            .zip(&response)
            .map(|(harmonic, shift)| Harmonic {
                value: harmonic.value + shift,
                std: harmonic.std.map(|std| std * ratio),
                ..*harmonic
            })
            .collect(),
        repeats: rest
            .iter()
            .map(|repeat| Repeat {
                input: less(&repeat.input, &input),
                response: less(&repeat.response, &response),
            })
            .collect(),
        ..experiment.clone()
    }
}

#[cfg(test)]
mod tests {
    use super::super::fault;
    use super::*;
    use crate::answers::LeftOutRow;
    use crate::diagnose::tests::{exact, noisy};
    use crate::machines::draw::NoiseStatement;

    #[test]
    fn without_a_repeat_the_mean_is_that_of_the_others_and_they_deviate_from_it() {
        let before = noisy(&exact(), NoiseStatement::Repeats(3), 1);
        let old = &before.experiments()[4];
        let row = |repeat| LeftOutRow {
            experiment: 4,
            harmonic: 1,
            repeat: Some(repeat),
            line: None,
            off: 0.2,
            sigmas: 9.0,
        };
        let without = |repeats: &[usize]| {
            let fault = fault::bad_rows(repeats.iter().map(|repeat| row(*repeat)));
            without_repeats(4, old, &[fault])
        };
        let new = &without(&[0]);
        assert_eq!(new.repeats.len(), 2);
        let value =
            |e: &Experiment, repeat: usize| e.response[3].value + e.repeats[repeat].response[3];
        let mean = (value(old, 1) + value(old, 2)) / 2.0;
        // A few roundings.
        assert!((new.response[3].value - mean).norm() < 1e-14 * mean.norm());
        assert!((value(new, 0) - value(old, 1)).norm() < 1e-14 * mean.norm());
        assert_eq!(&without(&[0, 2]), old, "one repeat has no scatter");
    }
}
