//! Scene files and overrides.

use std::path::Path;

use photosphere::report::SceneSummary;
use photosphere::scene::{Override, SceneDescription, SceneFile, Settings};

use super::{accepted, read_scene};

/// Scenes with more spheres are read but not built.
const MAX_SPHERES: u64 = 10_000;

/// The scene whose keys are replaced: it has a key of every section, and sphere lists to index.
const BASE: &str = include_str!("../../seeds/scene/base.toml");

/// The input is the text of a scene file without tables beside it.
pub(super) fn scene(input: &[u8]) -> bool {
    let Ok(text) = std::str::from_utf8(input) else { return false };
    read_scene(text, Path::new("nowhere"), &[]).is_some_and(build)
}

/// Each line of the input is an override, `key=value`.
pub(super) fn overrides(input: &[u8]) -> bool {
    let Ok(text) = std::str::from_utf8(input) else { return false };
    let pairs = text.lines().filter_map(|line| line.split_once('='));
    let overrides: Vec<Override> = pairs
        .map(|(key, value)| {
            Override::new(key, value).with_option(["--set", &format!("{key}={value}")])
        })
        .collect();
    read_scene(&smooth(BASE), Path::new("nowhere"), &overrides).is_some_and(build)
}

/// The scene with smooth surfaces. The tables of rough ones would take most of the time; overrides
/// can still ask for them.
fn smooth(scene: &str) -> String {
    let is_rough = |line: &str| line.starts_with("roughness");
    let lines = scene.lines().map(|line| if is_rough(line) { "roughness = 0.0" } else { line });
    lines.flat_map(|line| [line, "\n"]).collect()
}

/// Builds the scene. Its values survive the way into a picture file and back.
fn build(file: SceneFile) -> bool {
    if file.size().spheres > MAX_SPHERES {
        return false;
    }
    let Some((scene, settings)) = accepted(file.build()) else { return false };
    let summary = SceneSummary::of(&scene, &settings).to_string();
    assert!(!summary.is_empty());
    assert!(scene.description().to_keys().is_object() && settings.to_keys().is_object());
    let description = serde_json::to_string(scene.description()).expect("plain values");
    let read: SceneDescription = serde_json::from_str(&description).expect("what was written");
    assert_eq!(&read, scene.description());
    let written = serde_json::to_string(&settings).expect("plain values");
    let read: Settings = serde_json::from_str(&written).expect("what was written");
    assert_eq!(read, settings);
    true
}
