//! Prints text: results on the standard output, remarks on the standard error.

use std::fmt::Display;
use std::io::{self, Write};
use std::path::Path;

use serde::Serialize;

use crate::error::{Error, Result};

pub(super) use crate::draw::text::{count, field, percent, row, si};

/// Prints a result. A closed pipe, as in `photosphere info x | head -1`, is no failure.
///
/// # Errors
/// If the standard output cannot be written for any other reason, such as a full disk.
pub(super) fn result(text: &str) -> Result<()> {
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
    result(&format!("{value:#}\n"))
}

/// Prints a remark, and ignores failures to do so.
pub(super) fn note(text: impl Display) {
    let _ = writeln!(io::stderr(), "{text}");
}

/// Prints a warning.
pub(super) fn warning(text: impl Display) {
    note(format_args!("warning: {text}"));
}

/// Formats a number of bytes with a binary prefix: `12.34 MiB`.
pub(super) fn bytes(bytes: u64) -> String {
    indicatif::BinaryBytes(bytes).to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_have_binary_prefixes() {
        assert_eq!(bytes(3 << 20), "3.00 MiB");
    }
}
