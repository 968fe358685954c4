//! Sphere tables beside the scene.

use std::fs;

use crate::desk::{Desk, SCENE};

const TABLE: &str = r#"
[[sphere_tables]]
file = "grains.f32"
columns = ["x", "y", "z", "radius"]
material = "grass"

[render]"#;

fn desk(rows: &[f32], spare_bytes: usize) -> Desk {
    let desk = Desk::new(&SCENE.replace("[render]", TABLE));
    let mut bytes: Vec<u8> = rows.iter().flat_map(|value| value.to_le_bytes()).collect();
    bytes.extend(vec![0; spare_bytes]);
    fs::write(desk.path().join("grains.f32"), bytes).expect("the table is written");
    desk
}

#[test]
fn a_table_adds_its_spheres() {
    let desk = desk(&[0.0, 3.0, 0.0, 0.5, 2.0, 3.0, 0.0, 0.5], 0);
    assert_eq!(desk.run("info scene.toml --json").succeeds().json()["spheres"], 4);
}

#[test]
fn a_table_that_is_no_whole_number_of_rows_is_refused() {
    let parts = &["error: ", "grains.f32", "21 bytes", "1 row of 16 bytes"];
    desk(&[0.0, 3.0, 0.0, 0.5], 5).run("info scene.toml").fails(3, parts);
}

#[test]
fn a_table_with_bad_numbers_is_refused() {
    for bad in [f32::NAN, 0.0, -1.0] {
        let desk = desk(&[0.0, 3.0, 0.0, 0.5, 2.0, 3.0, 0.0, bad], 0);
        desk.run("render scene.toml -o a.png").fails(3, &["error: ", "grains.f32", "radius"]);
    }
}

#[test]
fn a_missing_table_is_missed_where_the_scene_names_it() {
    let desk = desk(&[], 0);
    fs::remove_file(desk.path().join("grains.f32")).expect("it was there");
    desk.run("info scene.toml").fails(3, &["[scene.toml:34:8]", "grains.f32", "No such file"]);
}
