//! A figure of the document.

/// A figure.
#[derive(Debug, Clone, PartialEq)]
pub struct Chart {
    /// Its name: `figure-4`.
    pub name: &'static str,
    /// Its title.
    pub title: String,
    /// The SVG document.
    pub svg: String,
}

impl Chart {
    /// Name of its file.
    pub fn file(&self) -> String {
        format!("{}.svg", self.name)
    }
}
