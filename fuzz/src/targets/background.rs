//! Pictures as light.

use std::fs;

use photosphere::scene::Override;

use super::pictures::extension;
use super::render::all_pictures_agree;
use super::{accepted, read_scene};

/// A ball under the light of a picture.
const SCENE: &str = "\
format = 1
[image]
width = 3
height = 2
[camera]
position = [0, 0, 5]
look_at = [0, 0, 0]
[background.image]
file = \"NAME\"
[materials.m]
type = \"diffuse\"
albedo = [0.5, 0.5, 0.5]
[[spheres]]
center = [0, 0, 0]
radius = 1
material = \"m\"
";

/// The input is a panorama. A picture is rendered in its light.
pub(super) fn environment(input: &[u8]) -> bool {
    let extension = extension(input).filter(|extension| matches!(*extension, "exr" | "hdr"));
    let Some(extension) = extension else { return false };
    let folder = tempfile::tempdir().expect("a folder for temporary files");
    let name = format!("a.{extension}");
    fs::write(folder.path().join(&name), input).expect("a file in it");
    let text = SCENE.replace("NAME", &name);
    let turned = Override::new("background.image.rotation_degrees", "30");
    let Some(file) = read_scene(&text, folder.path(), &[turned]) else { return false };
    let Some((scene, settings)) = accepted(file.build()) else { return false };
    all_pictures_agree(&scene, settings)
}
