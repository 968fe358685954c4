//! What is packaged, and the texts about it, have the version of Cargo.toml.

use std::fs;
use std::path::Path;

const VERSION: &str = env!("CARGO_PKG_VERSION");

/// Texts that begin before a version, in files that are not made from Cargo.toml.
const MENTIONS: [(&str, &str); 7] = [
    ("python/Cargo.toml", "\nversion = \""),
    ("packaging/conda/recipe.yaml", "\n  version: \""),
    ("packaging/PUBLISH.md", "`git tag -s v"),
    ("README.md", "pip install photosphere-"),
    ("README.md", "-xzf photosphere-"),
    ("README.md", "apt install ./photosphere_"),
    ("CHANGELOG.md", "\n## "),
];

#[test]
fn every_file_has_the_version_of_the_crate() {
    let is_wrong = |(file, before): &(&str, &str)| {
        // The changelog goes on with earlier versions.
        read(file).split(before).nth(1).map(version_at_start).as_deref() != Some(VERSION)
    };
    let wrong: Vec<_> = MENTIONS.iter().filter(|mention| is_wrong(mention)).collect();
    assert!(wrong.is_empty(), "not followed by {VERSION}: {wrong:#?}");
}

/// The digits and dots at the start, without a dot at their end.
fn version_at_start(text: &str) -> String {
    let end = text.find(|c: char| !c.is_ascii_digit() && c != '.').unwrap_or(text.len());
    text[..end].trim_end_matches('.').to_owned()
}

fn read(file: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(file);
    fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}
