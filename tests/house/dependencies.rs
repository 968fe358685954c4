//! CONTRIBUTING.md says of every dependency what it replaces, and names none that is gone; the
//! library goes without those of the command line.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;
use std::process::Command;

use toml::de::{DeTable, DeValue};

/// The tables of a Cargo.toml, and what stands behind a name in CONTRIBUTING.md.
const KINDS: [(&str, &str, &str); 4] = [
    ("Cargo.toml", "dependencies", ""),
    ("Cargo.toml", "build-dependencies", " (build)"),
    ("Cargo.toml", "dev-dependencies", " (tests)"),
    ("python/Cargo.toml", "dependencies", " (Python)"),
];

const HEADER: &str = "| crate | what it replaces |";

#[test]
fn every_dependency_has_its_row_and_every_row_its_dependency() {
    assert_eq!(rows(), dependencies());
}

/// What the command line alone needs.
const OF_THE_COMMAND_LINE: [&str; 8] = [
    "clap",
    "clap_complete",
    "clap_mangen",
    "indicatif",
    "miette",
    "shlex",
    "signal-hook",
    "tev_client",
];

#[test]
fn the_library_needs_nothing_of_the_command_line() {
    let (library, program) = (crates_with(&[]), crates_with(&["--features", "cli"]));
    for name in OF_THE_COMMAND_LINE {
        assert!(!library.contains(name), "the library needs `{name}`");
        assert!(program.contains(name), "the command line does not need `{name}`");
    }
}

/// The names of all crates that are built without the usual features, but with these.
fn crates_with(features: &[&str]) -> BTreeSet<String> {
    let tree = Command::new(env!("CARGO"))
        .args(["tree", "--locked", "--no-default-features", "--edges", "normal"])
        .args(["--prefix", "none"])
        .args(features)
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .output()
        .expect("cargo runs this test");
    assert!(tree.status.success(), "{}", String::from_utf8_lossy(&tree.stderr));
    let text = String::from_utf8(tree.stdout).expect("names of crates");
    text.lines().filter_map(|line| line.split(' ').next()).map(str::to_owned).collect()
}

/// The first cells of the table, as in "`cc` (build)".
fn rows() -> BTreeSet<String> {
    let document = read("CONTRIBUTING.md");
    let (_, table) = document.split_once(HEADER).expect("the table of dependencies");
    let rows = table.trim_start().lines().skip(1).take_while(|row| row.starts_with('|'));
    rows.filter_map(|row| row.split('|').nth(1)).map(|cell| cell.trim().to_owned()).collect()
}

/// The dependencies of the packages, written alike. Those of the library need no second row.
fn dependencies() -> BTreeSet<String> {
    let mut rows = BTreeSet::new();
    let mut known = BTreeSet::from(["photosphere".to_owned()]);
    for (file, key, kind) in KINDS {
        let text = read(file);
        let manifest = DeTable::parse(&text).expect("cargo has read it too");
        let table = manifest.get_ref().get(key).expect("there are some");
        let DeValue::Table(table) = table.get_ref() else { panic!("`{key}` is no table") };
        for name in table.keys().map(|name| name.get_ref().to_string()) {
            if file == "Cargo.toml" || !known.contains(&name) {
                rows.insert(format!("`{name}`{kind}"));
            }
            known.insert(name);
        }
    }
    rows
}

fn read(file: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(file);
    fs::read_to_string(path).expect("the repository's files can be read")
}
