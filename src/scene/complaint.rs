//! Diagnostics about sphere tables.

use std::io;
use std::path::Path;

/// A message about a table, and optional help.
pub(super) type TableDiagnostic = (String, Option<String>);

/// Diagnostic for a file that cannot be read.
pub(super) fn read_error(path: &Path, error: &io::Error) -> TableDiagnostic {
    let help = match error.kind() {
        io::ErrorKind::NotFound => Some("a relative path starts at the scene's folder".to_owned()),
        _ => None,
    };
    (format!("cannot read `{}`: {error}", path.display()), help)
}

/// Help text for an unexpected row layout.
pub(super) fn layout_help(columns: usize, row_bytes: u64) -> String {
    format!(
        "according to `columns`, a row is {columns} little-endian numbers in {row_bytes} bytes, and \
         there is no header; correct `columns` or the file"
    )
}
