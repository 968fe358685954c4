//! The scenes that the tests change, and how they are read.

use std::path::Path;

use photosphere::error::{Category, Diagnostic, Error};
use photosphere::scene::{Override, SceneFile, read_text};

/// The smallest scene; each test changes something.
pub(crate) const SCENE: &str = r#"format = 1

[image]
width = 64
height = 48

[camera]
position = [0, 1, 5]
look_at = [0, 1, 0]

[materials.grass]
type = "diffuse"
albedo = [0.2, 0.6, 0.2]

[materials.glass]
type = "dielectric"
ior = 1.5

[[spheres]]
name = "ground"
center = [0, -10, 0]
radius = 10
material = "grass"

[[spheres]]
center = [0, 1, 0]
radius = 1
material = "glass"

[render]
seed = 7
"#;

/// A scene with every section.
pub(crate) const EXAMPLE: &str = include_str!("../data/example.toml");

pub(crate) fn load(text: &str, options: &[&str]) -> Result<SceneFile, Error> {
    let overrides: Vec<_> = options.iter().map(|option| set(option)).collect();
    read_text("test.toml", text, Path::new("tests/data"), &overrides)
}

/// An override as `--set` makes it.
pub(crate) fn set(assignment: &str) -> Override {
    let (key, value) = assignment.split_once('=').expect("an assignment");
    Override::new(key, value).with_option(["--set", assignment])
}

/// `SCENE` with one line in place of another.
pub(crate) fn with(old: &str, new: &str) -> String {
    assert_eq!(SCENE.matches(old).count(), 1, "{old}");
    SCENE.replace(old, new)
}

/// Each mistake as `line:column: message | help`.
pub(crate) fn told(text: &str, options: &[&str]) -> Vec<String> {
    let built = load(text, options).and_then(SceneFile::build);
    let error = built.expect_err("a mistake");
    assert_eq!(error.category(), Category::Input);
    let tell = |mistake: &Diagnostic| {
        let told = mistake.to_string().trim_start_matches("test.toml:").to_owned();
        match &mistake.help {
            Some(help) => format!("{told} | {help}"),
            None => told,
        }
    };
    error.diagnostics().iter().map(tell).collect()
}

pub(crate) fn assert_told(text: &str, options: &[&str], expected: &[&str]) {
    assert_eq!(told(text, options), expected);
}
