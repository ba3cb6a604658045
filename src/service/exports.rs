//! Measurements and answers as tables for other programs.

use std::sync::Arc;

use serde_json::{Map, Number, Value, json};

use servoscope_core::answers::{Answer, ComparedHarmonic, Comparison, Identification};
use servoscope_core::measurement::Measurement;
use servoscope_core::measurement::formats::write_harmonic_csv;

use super::descriptions::described;
use super::measurements::sources;
use super::{Compared, Service, ServiceError, harmless};

/// Keys and values of a JSON object.
type Members = Map<String, Value>;

impl Service {
    /// A measurement as a harmonic table, which can be uploaded again.
    ///
    /// # Errors
    /// [`ServiceError::Unknown`] when there is none with this id.
    pub async fn measurement_csv(&self, id: &str) -> Result<String, ServiceError> {
        self.with_measurement(id, |measurement| table(&measurement)).await
    }

    /// The same as JSON.
    ///
    /// # Errors
    /// As for [`Service::measurement_csv`].
    pub async fn measurement_json(&self, id: &str) -> Result<String, ServiceError> {
        self.with_measurement(id, |measurement| document(&table(&measurement)).to_string()).await
    }

    /// The parameters of all models of an answer, one row each.
    ///
    /// # Errors
    /// As [`Service::result`].
    pub async fn parameters_csv(&self, id: &str) -> Result<String, ServiceError> {
        Ok(parameters(&self.answer(id).await?))
    }

    /// Every harmonic of a job's measurement beside what the models of its answer
    /// make of it, one row each, units in the header. `std_estimated` is 1 where `std` is estimated
    /// from the residual, 0 where it is given or from repeats.
    ///
    /// # Errors
    /// As [`Service::result`]; [`ServiceError::NoPlot`] where they cannot be compared.
    pub async fn comparison_csv(&self, id: &str) -> Result<String, ServiceError> {
        let answer = self.answer(id).await?;
        let measurement_id = self.job(id).await?.row.measurement_id;
        let numerics = Arc::clone(&self.numerics);
        let id = id.to_owned();
        self.with_measurement(&measurement_id, move |measurement| {
            let compared = Compared::of(numerics.as_ref(), Ok(&measurement), &answer);
            let base = compared.base.map_err(|reason| {
                let name = "comparison.csv".into();
                ServiceError::NoPlot { id, name, reason, available: Vec::new() }
            })?;
            Ok(comparison(&base, compared.extended.as_ref()))
        })
        .await?
    }

    /// Reads a stored measurement and makes something of it, off the threads that
    /// answer requests.
    pub(super) async fn with_measurement<T: Send + 'static>(
        &self,
        id: &str,
        make: impl FnOnce(Measurement) -> T + Send + 'static,
    ) -> Result<T, ServiceError> {
        let stored = self.measurement(id).await?;
        let (place, files) = self.place_with_files(id).await?;
        let numerics = Arc::clone(&self.numerics);
        let making = place.compute(move || {
            let measurement = numerics.read(&sources(&files))?;
            Ok(make(described(measurement, &stored)))
        });
        making.await
    }
}

fn table(measurement: &Measurement) -> String {
    let mut text = Vec::new();
    // Writing to memory cannot fail, and numbers and what was UTF-8 stay UTF-8.
    let _ = write_harmonic_csv(measurement, &mut text);
    String::from_utf8_lossy(&text).into_owned()
}

/// A harmonic table as the JSON that an upload may have: metadata, and the rows
/// of each experiment under what they share.
fn document(table: &str) -> Value {
    let (mut metadata, mut columns) = (Members::new(), Vec::new());
    let mut experiments: Vec<Members> = Vec::new();
    let mut latest = None;
    for line in table.lines() {
        if let Some((key, value)) = line.strip_prefix("# ").and_then(|line| line.split_once(": ")) {
            metadata.insert(key.to_owned(), value.into());
        } else if columns.is_empty() {
            columns = line.split(',').collect();
        } else {
            let cells = columns.iter().copied().zip(line.split(','));
            let mut row: Members = cells.filter_map(|(name, cell)| member(name, cell)).collect();
            let index = row.shift_remove("experiment");
            let mut shared = Members::new();
            for name in ["magnitude", "omega_rad_s", "run"] {
                shared.extend(row.shift_remove(name).map(|value| (name.to_owned(), value)));
            }
            if latest != index {
                latest = index;
                shared.insert("harmonics".into(), json!([]));
                experiments.push(shared);
            }
            let rows =
                experiments.last_mut().and_then(|experiment| experiment.get_mut("harmonics"));
            if let Some(Value::Array(rows)) = rows {
                rows.push(Value::Object(row));
            }
        }
    }
    json!({"metadata": metadata, "experiments": experiments})
}

fn member(name: &str, cell: &str) -> Option<(String, Value)> {
    let number = match cell.parse::<u64>() {
        Ok(whole) => Number::from(whole),
        Err(_) => Number::from_f64(cell.parse().ok()?)?,
    };
    Some((name.to_owned(), Value::Number(number)))
}

fn parameters(answer: &Answer) -> String {
    let mut rows = vec![
        ["model", "parameter", "value", "std", "low95", "high95", "unit"]
            .map(str::to_owned)
            .to_vec(),
    ];
    let mut add = |model: &str, answer: &Identification| {
        for (name, estimate) in &answer.parameters {
            let interval = estimate.interval95;
            rows.push(vec![
                model.to_owned(),
                name.clone(),
                cell(estimate.value),
                cell(estimate.std),
                cell(interval.map(|[low, _]| low)),
                cell(interval.map(|[_, high]| high)),
                estimate.unit.clone(),
            ]);
        }
    };
    add("base", answer.base());
    if let Some(extended) = answer.extended() {
        add("extended", extended);
    }
    csv(&rows)
}

fn comparison(base: &Comparison, extended: Option<&Comparison>) -> String {
    let or = |unit: &str, quantity: &str| {
        if unit.is_empty() { quantity.to_owned() } else { unit.to_owned() }
    };
    let (input, response) = (or(&base.input_unit, "input"), or(&base.response_unit, "response"));
    let mut header = vec![
        "experiment".to_owned(),
        format!("magnitude [{input}]"),
        "omega [rad/s]".to_owned(),
        "run".to_owned(),
        "harmonic".to_owned(),
    ];
    header.extend(["u_re", "u_im"].map(|name| format!("{name} [{input}]")));
    let of_response = |name: &str| format!("{name} [{response}]");
    header.extend(["measured_re", "measured_im", "std"].map(of_response));
    header.push("std_estimated".to_owned());
    header.extend(["base_re", "base_im", "extended_re", "extended_im"].map(of_response));
    let mut rows = vec![header];
    for experiment in &base.experiments {
        let beside = extended.and_then(|extended| {
            extended.experiments.iter().find(|other| other.experiment == experiment.experiment)
        });
        for harmonic in &experiment.harmonics {
            let ComparedHarmonic { order, input, measured, simulated, std } = *harmonic;
            let other = beside
                .and_then(|other| other.harmonics.iter().find(|other| other.order == order))
                .map(|other| other.simulated);
            let mut row = vec![
                experiment.experiment.to_string(),
                cell(Some(experiment.magnitude)),
                cell(Some(experiment.omega_rad_s)),
                cell(experiment.run),
                order.to_string(),
            ];
            let numbers = [input[0], input[1], measured[0], measured[1], std];
            row.extend(numbers.map(|number| cell(Some(number))));
            row.push(u8::from(base.std_estimated).to_string());
            row.extend(simulated.map(|number| cell(Some(number))));
            row.extend([0, 1].map(|part| cell(other.map(|value| value[part]))));
            rows.push(row);
        }
    }
    csv(&rows)
}

/// A number with the fewest digits that read back as the same; empty for none.
fn cell(number: Option<f64>) -> String {
    number.map(|number| format!("{number:?}")).unwrap_or_default()
}

fn csv(rows: &[Vec<String>]) -> String {
    let mut table = csv::Writer::from_writer(Vec::new());
    // Rows of one length into memory: nothing can fail.
    for row in rows {
        let _ = table.write_record(row.iter().map(|cell| harmless(cell).into_owned()));
    }
    String::from_utf8(table.into_inner().unwrap_or_default()).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use servoscope_core::answers::sample;
    use servoscope_core::measurement::formats::{Source, read};

    use super::*;

    const TABLE: &str = "# input: current A\n# response: velocity rad/s\n# label.site: north\n\
        magnitude,omega_rad_s,experiment,harmonic,re,im,std,repeat,run\n\
        1.0,2.0,0,1,0.5,-0.25,0.1,0,3.0\n1.0,2.0,0,3,0.125,0.0,0.1,0,3.0\n\
        1.0,2.0,0,1,0.75,-0.25,0.1,1,3.0\n1.0,2.0,0,3,0.125,1e-9,0.1,1,3.0\n\
        2.0,7.5,1,1,0.5,-0.5,0.1,0,4.0\n2.0,7.5,1,1,0.5,-0.5,0.1,1,4.0\n";

    fn measurement(name: &str, text: &str) -> Measurement {
        read(&[Source { name, bytes: text.as_bytes() }]).unwrap()
    }

    #[test]
    fn a_table_and_its_json_are_the_same_measurement() {
        let original = measurement("a.csv", TABLE);
        let written = table(&original);
        let again = measurement("a.json", &document(&written).to_string());
        assert_eq!(again.experiments(), original.experiments());
        assert_eq!(again.metadata(), original.metadata());
        assert!(again.notes().is_empty(), "{:?}", again.notes());
    }

    #[test]
    fn parameters_of_both_models_are_listed_with_their_units() {
        let text = parameters(&sample::explained().into());
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines[0], "model,parameter,value,std,low95,high95,unit");
        assert!(lines.iter().any(|line| line.starts_with("base,pole,-10")), "{text}");
        let of_cause =
            lines.iter().find(|line| line.starts_with("extended,static_friction.fs_plus,0.80135,"));
        assert!(of_cause.is_some_and(|line| line.ends_with(",A")), "{text}");
    }

    #[test]
    fn a_comparison_has_its_units_in_the_header() {
        let base = sample::comparison();
        let text = comparison(&base, Some(&base));
        let (input, response) = (&base.input_unit, &base.response_unit);
        assert!(
            text.starts_with(&format!("experiment,magnitude [{input}],omega [rad/s],")),
            "{text}"
        );
        assert!(text.lines().next().unwrap().ends_with(&format!("extended_im [{response}]")));
        let harmonics: usize = base.experiments.iter().map(|e| e.harmonics.len()).sum();
        assert_eq!(text.lines().count(), 1 + harmonics);
        let alone = comparison(&base, None);
        assert!(alone.lines().nth(1).unwrap().ends_with(",,"), "{alone}");
        for estimated in [false, true] {
            let base = Comparison { std_estimated: estimated, ..base.clone() };
            let text = comparison(&base, None);
            let mut rows = text.lines().map(|line| line.split(',').collect::<Vec<_>>());
            let names = rows.next().unwrap();
            let at = names.iter().position(|name| *name == "std_estimated").unwrap();
            let expected = if estimated { "1" } else { "0" };
            assert!(rows.all(|row| row[at] == expected && row.len() == names.len()), "{text}");
        }
    }
}
