//! Mean and deviations of the repeats of one experiment in a harmonic table.

use super::columns::Column;
use super::fault::Fault;
use super::harmonic_row::Entry;
use super::harmonic_table::Group;
use super::part::Remarked;
use super::table::Table;
use crate::measurement::waveform::half_peak_to_peak;
use crate::measurement::{Complex, Experiment, Harmonic, Repeat};

/// Makes an experiment of the rows of one group.
pub(super) fn experiment(
    table: &Table,
    group: &Group,
    from_record: bool,
) -> Result<Remarked<Experiment>, Fault> {
    let repeats: Vec<&[Entry]> = group.repeats.values().map(Vec::as_slice).collect();
    check_alike(table, group)?;
    let mut remarks = Vec::new();

    let response_rows: Vec<Vec<&Entry>> = repeats
        .iter()
        .map(|entries| entries.iter().filter(|entry| entry.response.is_some()).collect())
        .collect();
    let responses: Vec<Vec<Complex>> = response_rows
        .iter()
        .map(|rows| rows.iter().filter_map(|entry| entry.response).collect())
        .collect();
    let mean_response = mean(&responses);
    if mean_response.is_empty() {
        return Err(table.row(group.row).fault_of_row("the experiment has no response"));
    }
    let response: Vec<Harmonic> = mean_response
        .iter()
        .enumerate()
        .map(|(position, value)| Harmonic {
            order: response_rows[0][position].harmonic,
            value: *value,
            std: deviation_of_mean(response_rows.iter().map(|rows| rows[position].noise.std)),
        })
        .collect();

    let mean_measured = repeats[0].iter().any(|entry| entry.harmonic == 0 && entry.input.is_some());
    if group.bias.is_some() && mean_measured {
        return Err(table.row(group.row).fault(
            Column::Bias,
            "the bias is a second statement of the input's mean, which u_re gives for harmonic 0: \
             give one of them",
        ));
    }
    let bias = Complex::new(group.bias.unwrap_or(0.0), 0.0);
    let inputs: Vec<Vec<Complex>> =
        repeats.iter().filter_map(|entries| input(entries, bias)).collect();
    // Inputs that are identical in all repeats are settings, not measurements.
    let input_scatters = inputs.windows(2).any(|pair| pair[0] != pair[1]);
    let mean_input = match (group.magnitude, inputs.first()) {
        (_, Some(first)) => {
            if input_scatters {
                mean(&inputs)
            } else {
                first.clone()
            }
        }
        (Some(m), None) => vec![bias, Complex::new(m, 0.0)],
        (None, None) => {
            return Err(table
                .row(group.row)
                .fault(Column::Magnitude, "the experiment has neither magnitude nor input"));
        }
    };
    let magnitude = group.magnitude.unwrap_or_else(|| half_peak_to_peak(&mean_input));

    let deviations = |value: &[Complex], mean: &[Complex]| -> Vec<Complex> {
        value.iter().zip(mean).map(|(value, mean)| value - mean).collect()
    };
    let repeats_of_mean = if repeats.len() < 2 {
        Vec::new()
    } else {
        responses
            .iter()
            .enumerate()
            .map(|(index, response)| Repeat {
                input: match inputs.get(index) {
                    Some(input) if input_scatters => deviations(input, &mean_input),
                    _ => Vec::new(),
                },
                response: deviations(response, &mean_response),
            })
            .collect()
    };
    if from_record && repeats_of_mean.is_empty() {
        remarks.push("one period: its scatter is not known".into());
    }
    Ok(Remarked {
        content: Experiment {
            magnitude,
            omega_rad_s: group.omega_rad_s,
            input: mean_input,
            input_mean_measured: mean_measured || group.bias.is_some(),
            mean_velocity: 0.0,
            rounding_std: 0.0,
            open_samples: None,
            bad_samples: None,
            clipping: None,
            range: None,
            unknown_input: Vec::new(),
            response,
            run: run(&repeats, &mut remarks),
            repeats: repeats_of_mean,
            from_record,
        },
        remarks,
    })
}

/// Checks that all repeats of an experiment have the same harmonics of input and response.
fn check_alike(table: &Table, group: &Group) -> Result<(), Fault> {
    let orders = |entries: &[Entry]| -> [(&str, Vec<usize>); 2] {
        let of = |given: fn(&&Entry) -> bool| {
            entries.iter().filter(given).map(|entry| entry.harmonic).collect()
        };
        [
            ("the response", of(|entry| entry.response.is_some())),
            ("the input", of(|entry| entry.input.is_some())),
        ]
    };
    let mut repeats = group.repeats.iter();
    let Some((first_index, first)) = repeats.next() else { return Ok(()) };
    let expected = orders(first);
    for (index, entries) in repeats {
        for ((what, here), (_, there)) in orders(entries).iter().zip(&expected) {
            if here != there {
                return Err(table.row(entries[0].row).fault(
                    Column::Repeat,
                    format!(
                        "repeat {index} gives harmonics {} of {what}, repeat {first_index} of \
                         the same experiment {}: they must be the same",
                        list(here),
                        list(there)
                    ),
                ));
            }
        }
    }
    Ok(())
}

fn list(orders: &[usize]) -> String {
    const SHOWN: usize = 12;
    let shown: Vec<String> = orders.iter().take(SHOWN).map(usize::to_string).collect();
    let rest = if orders.len() > SHOWN { " …" } else { "" };
    format!("[{}{rest}]", shown.join(" "))
}

/// Uₖ for k from 0 to the highest given one: U₀ is the bias where it is not given, all others 0.
fn input(entries: &[Entry], bias: Complex) -> Option<Vec<Complex>> {
    let highest = entries.iter().rfind(|entry| entry.input.is_some())?.harmonic;
    let mut input = vec![Complex::ZERO; highest.max(1) + 1];
    input[0] = bias;
    for entry in entries {
        if let Some(value) = entry.input {
            input[entry.harmonic] = value;
        }
    }
    Some(input)
}

fn mean(values: &[Vec<Complex>]) -> Vec<Complex> {
    let mut sum = values[0].clone();
    for value in &values[1..] {
        for (sum, value) in sum.iter_mut().zip(value) {
            *sum += value;
        }
    }
    sum.iter_mut().for_each(|sum| *sum /= values.len() as f64);
    sum
}

/// Standard deviation √(Σ sᵢ²)/M of the mean of M values with deviations sᵢ, if all are known.
fn deviation_of_mean(stds: impl Iterator<Item = Option<f64>>) -> Option<f64> {
    let stds = stds.collect::<Option<Vec<f64>>>()?;
    match stds[..] {
        [std] => Some(std),
        _ => Some(stds.iter().fold(0.0, |norm: f64, std| norm.hypot(*std)) / stds.len() as f64),
    }
}

/// Position of the experiment in the order of acquisition: the mean over its rows, since its
/// repeats may be spread over the whole acquisition.
fn run(repeats: &[&[Entry]], remarks: &mut Vec<String>) -> Option<f64> {
    let runs: Vec<f64> = repeats.iter().copied().flatten().filter_map(|entry| entry.run).collect();
    let first = *runs.first()?;
    if runs.iter().all(|run| *run == first) {
        return Some(first);
    }
    let mean = runs.iter().map(|run| run / runs.len() as f64).sum();
    remarks.push(format!("its rows have different runs: their mean {mean} is used"));
    Some(mean)
}
