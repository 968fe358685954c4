//! What is wrong with a table, in words.

use std::io;
use std::path::Path;

/// What is wrong with a table, and what to do about it.
pub(super) type TableDiagnostic = (String, Option<String>);

/// Of a file that cannot be read.
pub(super) fn read_error(path: &Path, error: &io::Error) -> TableDiagnostic {
    let help = match error.kind() {
        io::ErrorKind::NotFound => Some("a relative path starts at the scene's folder".to_owned()),
        _ => None,
    };
    (format!("cannot read `{}`: {error}", path.display()), help)
}

/// What to look at where the rows are not what was expected.
pub(super) fn layout_help(columns: u64) -> String {
    format!(
        "a row is {columns} little-endian f32 numbers, as `columns` says, and there is no header: \
         mend `columns` or the file"
    )
}
