//! Files of sphere tables. The first line of an input holds the keys of the table in a scene, the
//! rest is the file. A reader of another format gets a function here.

use std::fs;
use std::path::Path;

use super::{accepted, first_line, read_scene};

/// Rows of raw numbers, as `columns` describes them.
pub(super) fn rows(input: &[u8]) -> bool {
    read_table("table.f32", input)
}

/// A NumPy file.
pub(super) fn npy(input: &[u8]) -> bool {
    read_table("table.npy", input)
}

fn read_table(name: &str, input: &[u8]) -> bool {
    let (keys, file) = first_line(input);
    let Ok(keys) = std::str::from_utf8(keys) else { return false };
    let folder = tempfile::tempdir().expect("a folder for temporary files");
    fs::write(folder.path().join(name), file).expect("a file in it");
    let text = format!(
        "format = 1\n[camera]\nposition = [0, 0, 5]\nlook_at = [0, 0, 0]\n\
         [materials.m]\ntype = \"diffuse\"\nalbedo = [0.5, 0.5, 0.5]\n\
         [[sphere_tables]]\nfile = \"{name}\"\nmaterial = \"m\"\n{}\n",
        keys.replace(';', "\n")
    );
    read_spheres(&text, folder.path())
}

/// Reads a scene of one table. Every sphere has a place and a size.
fn read_spheres(text: &str, folder: &Path) -> bool {
    let Some(file) = read_scene(text, folder, &[]) else { return false };
    let announced = file.size().spheres;
    let Some((scene, _)) = accepted(file.build()) else { return false };
    let spheres = scene.spheres();
    let found = spheres.len() as u64 + spheres.duplicates() as u64;
    assert_eq!(found, announced, "the header announces {announced} spheres");
    for id in 0..spheres.len() as u32 {
        let sphere = spheres.sphere(id);
        assert!(sphere.center.is_finite(), "{sphere:?}");
        assert!(sphere.radius.is_finite() && sphere.radius > 0.0, "{sphere:?}");
        let material = scene.sphere_material(id);
        assert!(material.material.emission.is_finite(), "{sphere:?}");
    }
    true
}
