//! `photosphere generate`, from its command line to a picture of what it made.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use photosphere::scene::{SceneFile, read_file};
use tempfile::TempDir;

fn photosphere(folder: &Path, words: &str) -> Output {
    let program = env!("CARGO_BIN_EXE_photosphere");
    let run = Command::new(program).args(words.split_whitespace()).current_dir(folder).output();
    run.expect("the program starts")
}

fn folder() -> TempDir {
    tempfile::tempdir().expect("a folder")
}

fn told(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

#[test]
fn every_arrangement_makes_a_table_and_a_scene_that_renders() {
    let desk = folder();
    for arrangement in ["gas", "packed", "clusters", "lattice"] {
        for colors in ["", "--colors"] {
            let words =
                format!("generate {arrangement} -n 2e3 -o t.f32 --scene s.toml --seed 5 {colors}");
            let made = photosphere(desk.path(), &words);
            assert!(made.status.success(), "{}", told(&made));
            let render = "render s.toml -o s.png --size 32x24 --spp 1 --quiet";
            let rendered = photosphere(desk.path(), render);
            assert!(rendered.status.success(), "{}", told(&rendered));
            assert_eq!(told(&rendered), "", "no warning about {arrangement}");
            let file = read_file(&desk.path().join("s.toml"), &[]);
            let (scene, _) = file.and_then(SceneFile::build).expect("it rendered");
            assert_eq!(scene.spheres().len(), 2000);
            assert_eq!(scene.surface(0).albedo.is_some(), !colors.is_empty());
        }
    }
}

#[test]
fn a_recipe_has_one_table_whatever_the_threads() {
    let desk = folder();
    let make = |options: &str| {
        let made = photosphere(desk.path(), &format!("generate gas --count 300000 {options}"));
        assert!(made.status.success(), "{}", told(&made));
    };
    make("-o one.f32 --threads 1");
    make("-o two.f32 --threads 2 --seed 0");
    make("-o other.f32 --seed 1");
    let read = |name: &str| fs::read(desk.path().join(name)).expect("the table is there");
    assert!(read("one.f32") == read("two.f32"));
    assert!(read("one.f32") != read("other.f32"));
    assert_eq!(read("one.f32").len(), 300_000 * 16);
}

/// The first rows of a table with a known recipe: these numbers may not change.
#[test]
fn the_numbers_stay_the_same() {
    let desk = folder();
    let made = photosphere(desk.path(), "generate gas -n 1e6 --colors -o t.f32 --seed 42");
    assert!(made.status.success(), "{}", told(&made));
    let bytes = fs::read(desk.path().join("t.f32")).expect("the table is there");
    let number = |i: usize| f32::from_le_bytes([0, 1, 2, 3].map(|k| bytes[4 * i + k]));
    assert_eq!([0, 1, 2, 3, 4, 5, 6].map(number), FIRST);
}

const FIRST: [f32; 7] =
    [-0.18854089, 0.29671478, 0.40457347, 0.0016038271, 0.73259884, 0.37301525, 0.18041067];

#[test]
fn a_scene_elsewhere_still_finds_its_table() {
    let desk = folder();
    fs::create_dir_all(desk.path().join("scenes")).expect("a folder");
    let made = photosphere(desk.path(), "generate lattice -n 8 -o t.f32 --scene scenes/s.toml");
    assert!(made.status.success(), "{}", told(&made));
    assert!(read_file(&desk.path().join("scenes/s.toml"), &[]).is_ok());
}

#[test]
fn what_cannot_be_made_is_refused() {
    let desk = folder();
    let refused = |words: &str, code: i32, message: &str| {
        let output = photosphere(desk.path(), words);
        assert_eq!(output.status.code(), Some(code), "{}", told(&output));
        assert!(told(&output).contains(message), "{}", told(&output));
        assert_eq!(fs::read_dir(desk.path()).expect("the folder").count(), 0);
    };
    refused("generate gas -n 0 -o t.f32", 3, "a table has at least one sphere");
    refused("generate gas -n 1e10 -o t.f32", 3, "more than the 4294967293 that a scene can hold");
    refused("generate gas -n 1.5 -o t.f32", 2, "whole number, as in 250000 or 1e6");
    refused("generate gas -n 9 -o t.f32 --scene t.f32", 3, "cannot be the same file");
    refused("generate gas -n 9 -o no/t.f32", 4, "the folder `no` does not exist");
}
