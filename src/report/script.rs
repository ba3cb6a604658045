//! The script that makes figures something to read off: cursor, zoom, pan, traces on and off. It
//! is this project's own, works over the figures as they are drawn, and asks nobody for anything.

use std::sync::LazyLock;

macro_rules! file {
    ($name:literal) => {
        ($name, include_str!(concat!("script/", $name)))
    };
}

/// Its modules: name and text, each behind those that it imports.
pub const FILES: &[(&str, &str)] =
    &[file!("plot-axis.js"), file!("plot-panel.js"), file!("plot-tools.js"), file!("plot.js")];

/// What a page that stands alone does with them.
const PAGE: &str = include_str!("script/plot-page.js");

static INLINE: LazyLock<String> = LazyLock::new(|| {
    let texts = FILES.iter().map(|(_, text)| *text).chain([PAGE]);
    let lines = texts.flat_map(str::lines).filter(|line| !line.starts_with("import "));
    let lines: Vec<&str> = lines.map(|line| line.strip_prefix("export ").unwrap_or(line)).collect();
    // HTML takes a script as it is, XML only as a section of characters.
    format!("//<![CDATA[\n{}\n//]]>", lines.join("\n"))
});

/// All of it as one module for a page that stands alone.
pub fn inline() -> &'static str {
    &INLINE
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_script_of_a_page_is_all_modules_in_one() {
        let text = inline();
        assert!(!text.contains("\nimport ") && !text.contains("\nexport "));
        for part in ["class Axis", "class Panel", "function tools", "function interactive"] {
            assert_eq!(text.matches(part).count(), 1, "{part}");
        }
    }

    #[test]
    fn nothing_ends_the_script_early_in_html_or_xml() {
        let text = inline();
        assert!(!text.contains("</script") && !text.contains("<!--"));
        assert_eq!(text.matches("]]>").count(), 1);
    }

    #[test]
    fn it_is_small() {
        let is_code = |line: &&str| !line.trim().is_empty() && !line.trim().starts_with("//");
        let lines = |text: &str| text.lines().filter(is_code).count();
        assert!(FILES.iter().all(|(_, text)| lines(text) <= 250));
        assert!(lines(inline()) <= 420, "{} lines", lines(inline()));
    }
}
