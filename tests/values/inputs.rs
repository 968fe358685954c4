//! Tables that a program has stand in place of the files that a scene names.

use std::fs;
use std::path::Path;

use photosphere::particles::{ReadRequest, read};
use photosphere::scene::{Override, Scene, SphereArrays, TableInput, read_text, read_text_with};
use photosphere::studio::{StudioOptions, import, import_particles};

use super::{balls, narrow, rows};

const TABLE: &str = "format = 1\n[camera]\nposition = [0, 0, 12]\nlook_at = [0, 0, 0]\n\
    [background]\nradiance = [1, 1, 1]\n[materials.grey]\ntype = \"diffuse\"\n\
    albedo = [0.5, 0.5, 0.5]\n[[sphere_tables]]\nfile = \"balls.f32\"\n\
    columns = [\"x\", \"y\", \"z\", \"radius\"]\nmaterial = \"grey\"\n";

fn xyz(folder: &Path) -> std::path::PathBuf {
    let file = folder.join("a.xyz");
    let atoms = ["O 0 0 0", "H 0.9 0.1 0", "H -0.2 0.9 0.3", "C 3 2 1"].join("\n");
    fs::write(&file, format!("4\nwater and carbon\n{atoms}\n")).expect("the folder is ours");
    file
}

#[test]
fn particles_of_a_program_are_those_of_a_file() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = xyz(folder.path());
    let options = StudioOptions::default();
    let name = Path::new("a.xyz");
    let overrides = [Override::new("particles.0.color", "z")];
    let of_file = import("a.xyz", name, folder.path(), &options, &overrides).expect("good atoms");
    let particles = read(&file, &ReadRequest::default()).expect("good atoms");
    let input = TableInput::from(particles);
    let given = import_particles("a.xyz", name, &options, &overrides, input).expect("good atoms");
    assert_eq!(given.text, of_file.text);
    // Those of a scene that has been read keep their look, and can be framed once more.
    let again = given.scene.particle_input().expect("there are particles");
    let view = [overrides[0].clone(), Override::new("image.width", "100")];
    let other = import_particles("a.xyz", name, &options, &view, again).expect("good atoms");
    assert_eq!(other.scene.settings.image.width, 100);
    let hash = |scene: Scene| scene.content_hash();
    let expected = hash(of_file.scene.build().expect("a scene").0);
    assert_eq!(hash(given.scene.build().expect("a scene").0), expected);
}

#[test]
fn arrays_of_a_program_are_those_of_a_table() {
    let folder = tempfile::tempdir().expect("a folder");
    let numbers = narrow(&rows(&balls(false)));
    let bytes: Vec<u8> = numbers.iter().flatten().flat_map(|x| x.to_le_bytes()).collect();
    fs::write(folder.path().join("balls.f32"), bytes).expect("the folder is ours");
    let file = read_text("balls", TABLE, folder.path(), &[]).expect("a good scene");
    let arrays = SphereArrays::from_rows(numbers);
    let inputs = vec![TableInput::from(arrays)];
    let given = read_text_with("balls", TABLE, Path::new("nowhere"), &[], inputs);
    let [file, given] = [file, given.expect("a good scene")].map(|file| file.build().unwrap().0);
    assert_eq!(file.spheres().len(), given.spheres().len());
    assert_eq!(file.content_hash(), given.content_hash());
}

#[test]
fn wrong_options_of_given_particles_are_told_by_their_keys() {
    let folder = tempfile::tempdir().expect("a folder");
    let particles = read(&xyz(folder.path()), &ReadRequest::default()).expect("good atoms");
    let overrides = [Override::new("particles.0.color", "zz")];
    let (options, name) = (StudioOptions::default(), Path::new("a.xyz"));
    let error = import_particles("a.xyz", name, &options, &overrides, particles.into());
    let error = error.expect_err("there is no such column").to_string();
    assert!(error.contains("zz"), "{error}");
}
