//! One file of an upload.

/// One uploaded file.
#[derive(Debug, Clone, Copy)]
pub struct Source<'a> {
    /// Name to use in messages.
    pub name: &'a str,
    /// Content.
    pub bytes: &'a [u8],
}
