//! Sentences on motions that do not repeat: how they begin, and how they were compared.

use crate::answers::{BeginningValue, ValidatedMotion};
use crate::measurement::{Metadata, ResponseKind, after_number};

/// Says what is implausible in an estimated initial state, if anything is.
fn implausible(
    number: usize,
    model: &str,
    values: &[BeginningValue],
    metadata: &Metadata,
) -> Option<String> {
    let unlikely = |begun: &BeginningValue| {
        let why = begun.implausible.as_ref()?;
        Some(format!("{} ({why})", with_unit(begun, metadata)))
    };
    let all: Vec<String> = values.iter().filter_map(unlikely).collect();
    (!all.is_empty()).then(|| {
        format!(
            "motion {number}: the estimated initial state of the {model} is implausible: {}; it \
             compensates for something that the model lacks; state how the motion begins, as in \
             the line `# initial_velocity: 0`",
            all.join("; ")
        )
    })
}

/// An initial value with its unit: of the velocity or position, where the measurement states it.
fn with_unit(begun: &BeginningValue, metadata: &Metadata) -> String {
    let stated = after_number(&metadata.response.unit);
    let unit = match (begun.quantity.as_str(), metadata.response_kind) {
        ("velocity", ResponseKind::Velocity) | ("position", ResponseKind::Position) => stated,
        ("velocity", ResponseKind::Position) if !stated.is_empty() => format!("{stated}/s"),
        _ => String::new(),
    };
    format!("{} {:.4}{unit}", begun.quantity, begun.value)
}

/// How motions that do not repeat were compared, with an extended model or without.
pub(crate) fn of_motions(
    motions: &[ValidatedMotion],
    metadata: &Metadata,
    extended: bool,
) -> Vec<String> {
    let mut said = Vec::new();
    for motion in motions {
        let number = motion.experiment + 1;
        let begins = |model: &str, values: &[BeginningValue]| match values {
            [] => format!("{model}: at rest"),
            values => {
                let each = values.iter().map(|value| with_unit(value, metadata));
                format!("{model}: {}", each.collect::<Vec<_>>().join(", "))
            }
        };
        if motion.beginning_given {
            said.push(format!("motion {number} begins with the stated velocity"));
        } else if motion.unscored_s > 0.0 {
            let mut models = begins("base model", &motion.base);
            if extended {
                models = format!("{models}; {}", begins("model with the causes", &motion.extended));
            }
            said.push(format!(
                "motion {number}: the initial state is estimated from the first {:.4} s, which are \
                 not compared ({models})",
                motion.unscored_s,
            ));
            said.extend(implausible(number, "base model", &motion.base, metadata));
            let richest = "model with the causes";
            said.extend(implausible(number, richest, &motion.extended, metadata));
        } else {
            said.push(format!("motion {number} is assumed to begin at rest"));
        }
    }
    let response = match metadata.response_kind {
        ResponseKind::Velocity => return said,
        ResponseKind::Position => "position",
        ResponseKind::Acceleration => "acceleration",
    };
    said.push(format!("the {response} is compared without its mean, measured and simulated"));
    said
}
