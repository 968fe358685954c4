//! The Python whose packages read what we write.

use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::process::Command;

/// The interpreter that `scripts/setup-python.sh` makes, or the one in `PHOTOSPHERE_PYTHON`, if it
/// runs with these arguments, for which it needs the packages. Where it does not, this says that a
/// check is left out.
pub(crate) fn python(packages: &str, arguments: &[&str]) -> Option<PathBuf> {
    let ours = Path::new(env!("CARGO_MANIFEST_DIR")).join("target/python/bin/python");
    let python = std::env::var_os("PHOTOSPHERE_PYTHON").map_or(ours, PathBuf::from);
    let works = Command::new(&python).args(arguments).output();
    if works.is_ok_and(|output| output.status.success()) {
        return Some(python);
    }
    // Past the test harness, which would swallow it: a check left out must be seen.
    writeln!(io::stderr(), "SKIPPED: no Python with {packages}; scripts/setup-python.sh gets it")
        .expect("told");
    None
}
