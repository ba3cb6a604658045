//! A measurement as it is understood, before anything is computed of it, as text for a terminal.

use servoscope_core::answers::{Detectability, Inspection, NoiseSource};

use super::brief;
use super::columns::{Side, table};
use super::number::significant;
use super::page::{Measured, read};
use super::summary::wrapped;
use super::tables;
use super::text::section;
use super::written::lines;

/// Writes how a measurement was understood, what looks wrong with it, and what it can show. Sentences
/// are broken into lines of at most `width` columns; tables are not.
pub fn inspection(measured: &Measured, inspection: &Inspection, width: usize) -> String {
    let mut sections = Vec::new();
    if !inspection.doubts.is_empty() {
        let doubts =
            inspection.doubts.iter().flat_map(|doubt| [format!("- {}", brief::doubt(doubt))]);
        sections.push(section("Looks wrong", doubts.collect()));
    }
    let pairs = read(measured).into_iter().map(|(name, value)| [name.to_lowercase(), value]);
    let mut read = table(&[Side::Left; 2], &pairs.collect::<Vec<_>>());
    read.extend(measured.notes.iter().map(|note| format!("- {note}")));
    sections.push(section("What was read", read));
    if let Some(found) = &inspection.detectability {
        let mut text = vec![noise(found)];
        text.extend(lines(&tables::visible(found)));
        sections.push(section("What it can reveal", text));
        let unseen = tables::unseen(found);
        if !unseen.rows.is_empty() {
            sections.push(section("What it cannot reveal", lines(&unseen)));
        }
    }
    if let Some(obstacle) = &inspection.obstacle {
        sections.push(section("No model can be fitted", vec![obstacle.clone()]));
    }
    let text = sections.join("\n");
    let lines = text.lines().flat_map(|line| match line.trim_start().starts_with("- ") {
        true => wrapped(line, width),
        false => vec![line.to_owned()],
    });
    lines.map(|line| line + "\n").collect()
}

/// Beyond what the effects show.
fn noise(found: &Detectability) -> String {
    let source = match found.noise {
        NoiseSource::Given => "the stated noise",
        NoiseSource::Repeats => "the scatter of the repeats",
        NoiseSource::Periods => "the scatter from period to period",
        NoiseSource::Estimated => "the residual of the base model, since the noise is not known",
    };
    let left = significant(100.0 * found.nrmse, 2);
    let hint = match found.chi2_per_dof {
        Some(each) if each > 1.5 => {
            format!(
                "; the residual of the base model is {left} % of the response, more than noise: run \
                 diagnose"
            )
        }
        _ => format!("; the residual of the base model is {left} % of the response"),
    };
    format!("the smallest size of each effect that shows beyond {source}{hint}")
}
