//! `photosphere generate`, from its command line to a picture of what it made.

use std::fs;

use photosphere::scene::{SceneFile, read_file};

use crate::desk::Desk;

#[test]
fn every_arrangement_makes_a_table_and_a_scene_that_renders() {
    let desk = Desk::empty();
    for arrangement in ["gas", "packed", "clusters", "lattice"] {
        for colors in ["", "--colors"] {
            let words =
                format!("generate {arrangement} -n 2e3 -o t.f32 --scene s.toml --seed 5 {colors}");
            desk.run(&words).succeeds();
            let render = "render s.toml -o s.png --size 32x24 --spp 1 --quiet";
            let rendered = desk.run(render).succeeds();
            assert_eq!(rendered.stderr, "", "no warning about {arrangement}");
            let file = read_file(&desk.path().join("s.toml"), &[]);
            let (scene, _) = file.and_then(SceneFile::build).expect("it rendered");
            assert_eq!(scene.spheres().len(), 2000);
            assert_eq!(scene.sphere_material(0).albedo.is_some(), !colors.is_empty());
        }
    }
}

#[test]
fn a_recipe_has_one_table_whatever_the_threads() {
    let desk = Desk::empty();
    let make = |options: &str| {
        desk.run(&format!("generate gas --count 300000 {options}")).succeeds();
    };
    make("-o one.f32 --threads 1");
    make("-o two.f32 --threads 2 --seed 0");
    make("-o other.f32 --seed 1");
    assert!(desk.read("one.f32") == desk.read("two.f32"));
    assert!(desk.read("one.f32") != desk.read("other.f32"));
    assert_eq!(desk.read("one.f32").len(), 300_000 * 16);
}

/// The first rows of a table with a known recipe: these numbers may not change.
#[test]
fn the_numbers_stay_the_same() {
    let desk = Desk::empty();
    desk.run("generate gas -n 1e6 --colors -o t.f32 --seed 42").succeeds();
    let bytes = desk.read("t.f32");
    let number = |i: usize| f32::from_le_bytes([0, 1, 2, 3].map(|k| bytes[4 * i + k]));
    assert_eq!([0, 1, 2, 3, 4, 5, 6].map(number), FIRST);
}

const FIRST: [f32; 7] =
    [-0.18854089, 0.29671478, 0.40457347, 0.0016038271, 0.73259884, 0.37301525, 0.18041067];

#[test]
fn a_scene_elsewhere_still_finds_its_table() {
    let desk = Desk::empty();
    fs::create_dir_all(desk.path().join("scenes")).expect("a folder");
    desk.run("generate lattice -n 8 -o t.f32 --scene scenes/s.toml").succeeds();
    let spheres = || {
        let file = read_file(&desk.path().join("scenes/s.toml"), &[]).expect("a good scene");
        file.description.spheres.len()
    };
    assert_eq!(spheres(), 0);
    desk.run("generate lattice -n 8 -o t.f32 --scene scenes/s.toml --floor").succeeds();
    assert_eq!(spheres(), 1);
    desk.run("generate lattice -n 8 -o t.f32 --floor").fails(2, &["--scene"]);
}

#[test]
fn what_cannot_be_made_is_refused() {
    let desk = Desk::empty();
    let refused = |words: &str, code: i32, message: &str| {
        let outcome = desk.run(words);
        assert_eq!(outcome.code, Some(code), "{}", outcome.stderr);
        assert!(outcome.stderr.contains(message), "{}", outcome.stderr);
        assert!(desk.names().is_empty());
    };
    refused("generate gas -n 0 -o t.f32", 3, "a table has at least one sphere");
    refused("generate gas -n 1e10 -o t.f32", 3, "more than the 4294967293 that a scene can hold");
    refused("generate gas -n 1.5 -o t.f32", 2, "whole number, such as 250000 or 1e6");
    refused("generate gas -n 9 -o t.f32 --scene t.f32", 3, "cannot be the same file");
    refused("generate gas -n 9 -o no/t.f32", 4, "the folder `no` does not exist");
}
