//! What a picture records of how it was made, as `info` and `reproduce` read it.

use std::path::Path;

use photosphere::color::Rgb;
use photosphere::image_io::{ImageWriter, MetadataEntry, Picture, WriteOptions};
use photosphere::job::Metadata;
use photosphere::job::reproduce::{ReproduceOptions, ReproductionCost, read_metadata, reproduce};
use photosphere::report::FileRecords;
use photosphere::scene::{Scene, SceneDescription};

use super::accepted;

/// Larger pictures are not rendered again.
const MAX_SAMPLES: u64 = 1 << 12;
const MAX_SPHERES: usize = 64;
const MAX_DEPTH: u32 = 12;

/// The input is a list of names and texts, which a picture records; a zero byte ends each. The
/// identity of the scene is made right, so that the picture can be rendered again.
pub(super) fn metadata(input: &[u8]) -> bool {
    let Ok(text) = std::str::from_utf8(input) else { return false };
    let parts: Vec<&str> = text.split('\0').collect();
    let metadata: Vec<MetadataEntry> =
        parts.chunks_exact(2).map(|pair| MetadataEntry::new(pair[0], pair[1])).collect();
    let folder = tempfile::tempdir().expect("a folder for temporary files");
    let path = folder.path().join("a.png");
    let pixels = vec![Rgb::ZERO; 6];
    let picture = Picture {
        width: 3,
        height: 2,
        direct: pixels.clone(),
        indirect: pixels,
        ..Picture::default()
    };
    let notes = WriteOptions { metadata, fast: true, ..WriteOptions::default() };
    let target = accepted(ImageWriter::new(&path)).expect("a folder of our own");
    // Names that a file cannot have are refused.
    if accepted(target.write_with(&picture, &notes)).is_none() {
        return false;
    }
    let is_read = describe(&path);
    let found = accepted(read_metadata(&path));
    assert_eq!(found.is_some(), is_read, "info and reproduce disagree");
    found.is_some_and(|found| render_again(found, folder.path()))
}

/// Describes the picture as `info` does.
fn describe(path: &Path) -> bool {
    let Some(records) = accepted(FileRecords::read(path)) else { return false };
    accepted(records.to_text()).is_some() && accepted(records.json()).is_some()
}

/// Renders the picture again, if that takes little.
fn render_again(mut recorded: Metadata, folder: &Path) -> bool {
    let Some(cost) = accepted(ReproductionCost::of(&recorded)) else { return false };
    let render = &mut recorded.settings.render;
    render.max_depth = Some(render.max_depth.unwrap_or(MAX_DEPTH).min(MAX_DEPTH));
    let Some(description) = recorded.scene.clone() else { return true };
    if cost.samples > MAX_SAMPLES || description.spheres.len() > MAX_SPHERES {
        return true;
    }
    if cost.pixels > MAX_SAMPLES || !names_no_file(&description) {
        return true;
    }
    if let Some(scene) = accepted(Scene::build(description)) {
        recorded.scene_identity = scene.content_hash();
    }
    let options = ReproduceOptions { folder: folder.to_path_buf(), ..ReproduceOptions::default() };
    accepted(reproduce(&recorded, &options, &|_, _| {}));
    true
}

/// Returns true if the scene is all in its description.
fn names_no_file(scene: &SceneDescription) -> bool {
    use photosphere::scene::description::EnvironmentDescription;
    let is_image = matches!(scene.background.dome, EnvironmentDescription::Image { .. });
    scene.tables.is_empty() && !is_image
}
