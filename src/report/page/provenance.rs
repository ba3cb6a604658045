//! What was measured, and what is needed to compute the same answer again.

use maud::html;

use super::{Content, Section, measured};

pub(super) fn section(content: &Content<'_>) -> Option<Section> {
    let provenance = content.answer.provenance();
    let base = content.answer.base();
    let order = provenance.actuator_order.map_or("chosen from the data".into(), |n| n.to_string());
    // Options are plain data, whose JSON form cannot fail.
    let options = serde_json::to_string_pretty(&provenance.options).unwrap_or_default();
    let measured = content.measured;
    let body = html! {
        (measured::described(content))
        h3 { "How it was computed" }
        dl.pairs {
            div { dt { "Software" } dd { "servoscope " (provenance.software_version) } }
            div { dt { "Method" } dd { (base.method.name()) } }
            div { dt { "Seed" } dd { (base.seed) } }
            div { dt { "Actuator order" } dd { (order) } }
            div { dt { "Data, SHA-256" } dd { code.digest { (provenance.data_sha256) } } }
        }
        h3 { "Options" }
        pre { (options) }
        p.small { "The same data, options and seed give the same result, bit by bit." }
    };
    let short = format!(
        "servoscope {}, method {}, seed {}, {} experiment{}",
        provenance.software_version,
        base.method.name(),
        base.seed,
        measured.experiments,
        if measured.experiments == 1 { "" } else { "s" },
    );
    Section::new("provenance", "Provenance", short, body)
}
