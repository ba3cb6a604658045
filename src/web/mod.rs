//! The dashboard: files that a browser asks for, carried inside the program.
//!
//! The page needs no build step: style sheet and script modules are served as they
//! lie in `assets`. What it shows it asks of the same interface as any other
//! client; colours, type and the words of an answer are those of the report page,
//! so that both look and read alike. A new file is one line in the list `FILES`.

use std::borrow::Cow;
use std::collections::BTreeMap;

use crate::report::{page, script};

/// A file as it is sent.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Asset {
    /// Media type.
    pub media_type: &'static str,
    /// Content: text, all of it.
    pub text: Cow<'static, str>,
}

const HTML: &str = "text/html; charset=utf-8";
const CSS: &str = "text/css; charset=utf-8";
const SCRIPT: &str = "text/javascript; charset=utf-8";

macro_rules! file {
    ($name:literal, $media_type:expr) => {
        ($name, $media_type, include_str!(concat!("assets/", $name)))
    };
}

/// Every file: its name, its media type and its content.
const FILES: &[(&str, &str, &str)] = &[
    file!("icon.svg", "image/svg+xml"),
    // What a stranger has at hand: the measurement of the demonstration.
    ("example.csv", "text/csv; charset=utf-8", include_str!("../cli/demo/sticky_axis.csv")),
    file!("dashboard.css", CSS),
    file!("theme.js", SCRIPT),
    file!("main.js", SCRIPT),
    file!("dom.js", SCRIPT),
    file!("format.js", SCRIPT),
    file!("api.js", SCRIPT),
    file!("figure.js", SCRIPT),
    file!("overview.js", SCRIPT),
    file!("upload.js", SCRIPT),
    file!("files.js", SCRIPT),
    file!("preview.js", SCRIPT),
    file!("columns.js", SCRIPT),
    file!("mappings.js", SCRIPT),
    file!("measurement.js", SCRIPT),
    file!("inspection.js", SCRIPT),
    file!("start.js", SCRIPT),
    file!("job.js", SCRIPT),
    file!("live.js", SCRIPT),
    file!("answer.js", SCRIPT),
    file!("status.js", SCRIPT),
    file!("tried.js", SCRIPT),
    file!("compare.js", SCRIPT),
    file!("axes.js", SCRIPT),
    file!("session.js", SCRIPT),
    file!("form.js", SCRIPT),
    file!("plans.js", SCRIPT),
    file!("plan.js", SCRIPT),
    file!("together.js", SCRIPT),
    file!("batches.js", SCRIPT),
    file!("batch.js", SCRIPT),
    file!("find.js", SCRIPT),
    file!("describe.js", SCRIPT),
    file!("reread.js", SCRIPT),
];

/// The page, the same at each of its addresses: its script shows what the address
/// names.
pub fn index() -> Asset {
    Asset { media_type: HTML, text: include_str!("assets/index.html").into() }
}

/// The file of this name, if there is one.
pub fn asset(name: &str) -> Option<Asset> {
    match name {
        "shared.css" => return Some(Asset { media_type: CSS, text: page::shared_style().into() }),
        "dark.css" => return Some(Asset { media_type: CSS, text: page::dark_colours().into() }),
        "parameters.js" => return Some(Asset { media_type: SCRIPT, text: parameters().into() }),
        _ => {}
    }
    if let Some((_, text)) = script::FILES.iter().find(|(known, _)| *known == name) {
        return Some(Asset { media_type: SCRIPT, text: (*text).into() });
    }
    let (_, media_type, text) = FILES.iter().find(|(known, _, _)| *known == name)?;
    Some(Asset { media_type, text: (*text).into() })
}

/// What every parameter is called, as a script module.
fn parameters() -> String {
    let names: BTreeMap<String, String> = page::parameter_names().collect();
    // Names are texts, which JSON always holds.
    let object = serde_json::to_string(&names).unwrap_or_default();
    format!(
        "// What the parameters of a model are called, by id.\n\nexport const PARAMETERS = {object};\n"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_parameter_is_shown_by_its_raw_name() {
        let text = parameters();
        for part in
            ["\"fc_plus\":\"Dry friction forwards\"", "\"backlash.gap\":\"", "\"pole\":\"Pole\""]
        {
            assert!(text.contains(part), "{part}: {text}");
        }
    }

    /// Names that a file asks for: behind `/assets/` and in imports.
    fn asked_for(text: &str) -> Vec<&str> {
        let behind =
            |opening| text.split(opening).skip(1).filter_map(|rest| rest.split(['"', '\'']).next());
        behind("\"/assets/").chain(behind("from \"./")).collect()
    }

    #[test]
    fn every_file_that_a_file_asks_for_is_there() {
        let texts = FILES.iter().map(|(_, _, text)| *text);
        let texts = texts.chain(script::FILES.iter().map(|(_, text)| *text));
        let texts = texts.chain([include_str!("assets/index.html")]);
        let names: Vec<&str> = texts.flat_map(asked_for).collect();
        assert!(names.len() > FILES.len(), "{names:?}");
        for name in names {
            assert!(asset(name).is_some(), "{name} is asked for and not served");
        }
    }

    #[test]
    fn every_file_of_the_folder_is_served_as_it_lies_there() {
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/src/web/assets");
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            let name = path.file_name().unwrap().to_str().unwrap();
            let served = if name == "index.html" { Some(index()) } else { asset(name) };
            let served = served.unwrap_or_else(|| panic!("{name} is not in the list"));
            assert_eq!(served.text, std::fs::read_to_string(&path).unwrap());
        }
    }

    #[test]
    fn nothing_is_asked_of_anybody_else() {
        for (name, _, text) in FILES {
            let text = text.replace("http://www.w3.org/2000/svg", "");
            assert!(!text.contains("http://") && !text.contains("https://"), "{name}");
        }
    }
}
