//! Prints text: results on the standard output, remarks on the standard error.
//!
//! All of it may quote files, so control characters are escaped here, for every command.

use std::fmt::Display;
use std::io::{self, Write};
use std::path::Path;

use serde::Serialize;

use crate::error::{Error, Result};

use crate::draw::printable::{printable, printable_json, printable_line};

pub(super) use crate::draw::text::{count, field, percent, row, si};

/// Prints a result. A closed pipe, as in `photosphere info x | head -1`, is no failure.
///
/// # Errors
/// If the standard output cannot be written for any other reason, such as a full disk.
pub(super) fn result(text: &str) -> Result<()> {
    write(&printable(text))
}

fn write(text: &str) -> Result<()> {
    let mut out = io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(e) if e.kind() != io::ErrorKind::BrokenPipe => {
            Err(Error::file("write", Path::new("standard output"), e))
        }
        _ => Ok(()),
    }
}

/// Prints one value as JSON. Numbers that JSON cannot express become null.
///
/// # Errors
/// See [`result`].
pub(super) fn json(value: &impl Serialize) -> Result<()> {
    let value = serde_json::to_value(value).expect("keys are texts");
    write(&printable_json(&format!("{value:#}\n")))
}

/// Prints a remark, and ignores failures to do so.
pub(super) fn note(text: impl Display) {
    drawn(&printable(&text.to_string()));
}

/// Prints a warning, as one line.
pub(super) fn warning(text: impl Display) {
    drawn(&format!("warning: {}", printable_line(&text.to_string())));
}

/// Prints text with colours on the standard error. Its foreign parts must be escaped already.
pub(super) fn drawn(text: &str) {
    let _ = writeln!(io::stderr(), "{text}");
}

/// Quotes a path for a shell. Nothing can mistake it for an option.
pub(super) fn shell_path(path: &Path) -> String {
    let path = path.display().to_string();
    let folder = if path.starts_with('-') { "./" } else { "" };
    format!("'{folder}{}'", path.replace('\'', r"'\''"))
}

/// Formats a number of bytes with a binary prefix: `12.34 MiB`.
pub(super) fn bytes(bytes: u64) -> String {
    indicatif::BinaryBytes(bytes).to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_are_quoted_for_a_shell() {
        let shown = ["a b.part", "-a.part", "it's"].map(|path| shell_path(Path::new(path)));
        assert_eq!(shown, ["'a b.part'", "'./-a.part'", r"'it'\''s'"]);
    }

    #[test]
    fn sizes_have_binary_prefixes() {
        assert_eq!(bytes(3 << 20), "3.00 MiB");
    }
}
