//! Examples of measurements, and of what is said of their files.

use std::collections::BTreeMap;

use serde_json::Value;
use servoscope_core::answers::{
    Detectability, DetectableEffect, EffectSize, Inspection, NoiseSource, SizedParameter,
};

use crate::http::previews::PreviewView;
use crate::service::{
    ColumnLook, FileLook, Look, Mapping, Measured, Preview, Quantities, Quantity, TableLook,
};
use crate::store::MeasurementRow;

use super::{AT, AT_MS, COLUMN_NAMES, LAYOUT, MEASUREMENT, shown};

pub(super) fn measured() -> Measured {
    let row = MeasurementRow {
        id: MEASUREMENT.into(),
        created_at_ms: AT_MS,
        name: Some("stepped sine".into()),
        machine: Some("press 4".into()),
        axis: Some("Y".into()),
        operator: Some("Ada".into()),
        measured_at: Some(AT.into()),
        labels: String::new(),
        sha256: "9acce10255ee0080c236607c559852ad2a5a72352215e8641117972aeba3b441".into(),
        experiments: 27,
        highest_harmonic: 5,
        magnitude_min: 1.0,
        magnitude_max: 3.0,
        omega_min_rad_s: 1.0,
        omega_max_rad_s: 100.0,
        notes: String::new(),
        quantities: None,
        files: String::new(),
        simulation_s: None,
        diagnosis_s: None,
    };
    let quantity = |name: &str, unit: &str| Quantity { name: name.into(), unit: unit.into() };
    let quantities = Quantities {
        input: quantity("current", "A"),
        response: quantity("velocity", "rad/s"),
        response_kind: "velocity".into(),
        r#loop: Some("open".into()),
    };
    let labels = BTreeMap::from([("site".to_owned(), "north".to_owned())]);
    let notes = vec!["column temperature is unknown and not used".to_owned()];
    let files = vec!["press-4-y.csv".to_owned()];
    Measured { row, labels, quantities: Some(quantities), notes, files }
}

pub(super) fn mapping() -> Mapping {
    Mapping {
        name: "rig 7".into(),
        settings: [("column_names".to_owned(), COLUMN_NAMES.to_owned())].into(),
        layout: Some(LAYOUT.into()),
        updated_at_ms: AT_MS,
    }
}

pub(super) fn preview() -> Value {
    let column = |name: &str, quantity, unit: &str, used_as| ColumnLook {
        name: name.into(),
        quantity: Some(quantity),
        unit: unit.into(),
        used_as: Some(used_as),
    };
    let table = TableLook {
        delimiter: Some("semicolons"),
        decimal: Some("comma"),
        preamble: vec!["Rig 7".into()],
        line: Some(2),
        columns: vec![
            column("tick", "time", "ms", "time_s"),
            column("chan a", "current", "A", "input"),
        ],
        rows: vec![vec!["0".into(), "1,0".into()]],
        sheets: Vec::new(),
    };
    let file = FileLook {
        name: "rig.txt".into(),
        format: "text in columns",
        encoding: None,
        table: Some(table),
    };
    let preview = Preview {
        look: Look { files: vec![file], layout: Some(LAYOUT.into()) },
        given: mapping().settings,
        mapping: Some("rig 7".into()),
        read: Ok(measured()),
    };
    shown(PreviewView::from(preview))
}

pub(super) fn inspection() -> Inspection {
    let size = |value: f64| EffectSize {
        parameters: [("fs_plus".to_owned(), SizedParameter { value, unit: "A".into() })]
            .into_iter()
            .collect(),
        set_by: vec!["fs_plus".into()],
        change: 0.004,
    };
    let effect = DetectableEffect {
        effect: "static_friction".into(),
        title: "static friction".into(),
        detected_from: Some(size(0.52)),
        named_from: Some(size(0.55)),
        closest_imitator: Some("stribeck".into()),
        reason: None,
    };
    let detectability = Detectability {
        noise: NoiseSource::Given,
        nrmse: 0.0007,
        chi2_per_dof: Some(1.01),
        least_excess: 20.0,
        effects: vec![effect],
    };
    Inspection { doubts: Vec::new(), detectability: Some(detectability), obstacle: None }
}
