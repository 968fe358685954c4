//! What a file says of its picture beside the pixels: texts with names, all of which begin with
//! [`PREFIX`] in the file. PNG files hold them as text chunks, EXR files as attributes.

/// What all our names in files begin with.
const PREFIX: &str = "photosphere:";

/// A text with a name, such as `seed`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MetadataEntry {
    /// The name without the prefix: ASCII letters, digits and `-`, 60 at most.
    pub name: String,
    /// Any text without zero bytes.
    pub text: String,
}

impl MetadataEntry {
    /// A record.
    pub fn new(name: &str, text: impl Into<String>) -> Self {
        Self { name: name.to_owned(), text: text.into().replace('\0', "") }
    }

    /// The name in files.
    pub(super) fn key(&self) -> String {
        format!("{PREFIX}{}", self.name)
    }

    /// A record of a file, if it is one of ours.
    pub(super) fn from_key(key: &str, text: String) -> Option<Self> {
        Some(Self { name: key.strip_prefix(PREFIX)?.to_owned(), text })
    }
}
