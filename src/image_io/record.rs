//! Image metadata: named texts, with names that start with [`PREFIX`] in the file. PNG files store
//! them as text chunks, EXR files as attributes.

/// Prefix of all our metadata names in files.
const PREFIX: &str = "photosphere:";

/// A named text, such as `seed`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MetadataEntry {
    /// Name without the prefix: ASCII letters, digits and `-`, at most 60.
    pub name: String,
    /// Text without zero bytes.
    pub text: String,
}

impl MetadataEntry {
    /// Creates an entry; zero bytes in `text` are removed.
    pub fn new(name: &str, text: impl Into<String>) -> Self {
        Self { name: name.to_owned(), text: text.into().replace('\0', "") }
    }

    /// The name used in files.
    pub(super) fn key(&self) -> String {
        format!("{PREFIX}{}", self.name)
    }

    /// Returns true if a name in a file is one of ours.
    pub fn is_ours(key: &str) -> bool {
        key.starts_with(PREFIX)
    }

    /// Creates an entry from a name and text in a file; `None` if another program wrote it.
    pub(super) fn from_key(key: &str, text: String) -> Option<Self> {
        Some(Self { name: key.strip_prefix(PREFIX)?.to_owned(), text })
    }
}
