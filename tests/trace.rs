//! `photosphere trace` as its users meet it: the path that render takes, told and drawn.

use std::fs;
use std::process::{Command, Output};

use photosphere::output::{BEAUTY, read};
use serde_json::Value;
use tempfile::TempDir;

/// A small version of a scene of the repository, rendered with one sample per pixel.
fn desk(scene: &str) -> TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    let path = format!("{}/scenes/{scene}", env!("CARGO_MANIFEST_DIR"));
    fs::copy(path, folder.path().join("scene.toml")).expect("copied");
    let arguments = "render scene.toml --size 16x12 --spp 1 --seed 3 --quiet -o one.exr";
    let output = run(&folder, arguments);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    folder
}

fn run(folder: &TempDir, arguments: &str) -> Output {
    Command::new(env!("CARGO_BIN_EXE_photosphere"))
        .args(arguments.split_whitespace())
        .current_dir(folder.path())
        .output()
        .expect("the program starts")
}

fn text(bytes: &[u8]) -> &str {
    std::str::from_utf8(bytes).expect("UTF-8")
}

const TRACE: &str = "trace scene.toml --size 16x12 --seed 3";

/// The sample that is told is the one that was rendered, and what is added adds up to it.
#[test]
fn the_path_is_the_one_that_render_takes() {
    for scene in ["paper/fig2.toml", "cornell-spheres.toml"] {
        let folder = desk(scene);
        let picture = read(&folder.path().join("one.exr")).expect("a picture");
        let pixels = &picture.layer(BEAUTY).expect("a beauty").pixels;
        for (x, y) in [(0, 11), (5, 6), (8, 7), (12, 3), (15, 0)] {
            let output = run(&folder, &format!("{TRACE} --pixel {x},{y} --json"));
            assert!(output.status.success(), "{}", text(&output.stderr));
            let told: Value = serde_json::from_slice(&output.stdout).expect("JSON");
            let rendered = pixels[y * 16 + x].to_array();
            let mut sum = [0.0; 3];
            for step in told["steps"].as_array().expect("a list") {
                for (c, sum) in sum.iter_mut().enumerate() {
                    *sum += step["added"][c].as_f64().unwrap_or(0.0);
                }
            }
            for c in 0..3 {
                let radiance = told["radiance"][c].as_f64().expect("a number");
                assert_eq!(radiance as f32, rendered[c], "{scene} {x},{y}");
                assert!((sum[c] - radiance).abs() <= 1e-6 * radiance, "{scene} {x},{y}");
            }
        }
    }
}

#[test]
fn the_story_has_the_letters_of_the_equation_and_the_names_of_the_spheres() {
    let folder = desk("cornell-spheres.toml");
    let mut all = String::new();
    for y in 0..12 {
        let output = run(&folder, &format!("{TRACE} --pixel 8,{y}"));
        assert!(output.status.success(), "{}", text(&output.stderr));
        all += text(&output.stdout);
    }
    for told in [
        "x_0  the camera at (",
        "x_1  `",
        "met from",
        "T = (",
        "aims at `",
        "f_r = (",
        "|cos| = ",
        "p = ",
        "w = ",
        "   + T f_r |cos| L_e w / p = (",
        "(indirect)",
        "scatters (diffuse): w_i = (",
        "the path ends: ",
        "L_o at the camera = (",
        "rays traced",
    ] {
        assert!(all.contains(told), "`{told}` is not in\n{all}");
    }
}

#[test]
fn the_drawing_shows_the_spheres_and_finite_numbers_only() {
    let folder = desk("cornell-spheres.toml");
    for y in [2, 6, 10] {
        let output = run(&folder, &format!("{TRACE} --pixel 8,{y} --svg path.svg"));
        assert!(output.status.success(), "{}", text(&output.stderr));
        let svg = fs::read_to_string(folder.path().join("path.svg")).expect("written");
        for part in ["<svg xmlns", "class=\"path\"", "x₁", "class=\"lamp\"", "</svg>"] {
            assert!(svg.contains(part), "{part}");
        }
        assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
    }
}

#[test]
fn what_is_not_there_cannot_be_traced() {
    let folder = desk("paper/fig2.toml");
    for (arguments, code, told) in [
        ("--pixel 16,0", 3, "there is no pixel 16,0: the picture has 16 x 12"),
        ("--pixel 1,1 --sample 64", 3, "the last is --sample 63"),
        ("--pixel 1", 2, "as in 320,240"),
        ("", 2, "--pixel"),
        ("--pixel 1,1 --integrator raycast", 3, "`raycast` follows no paths"),
        ("--pixel 1,1 --svg none/a.svg", 4, "does not exist"),
    ] {
        let output = run(&folder, &format!("{TRACE} {arguments}"));
        let stderr = text(&output.stderr);
        assert_eq!(output.status.code(), Some(code), "{arguments}: {stderr}");
        assert!(stderr.contains(told), "{arguments}: {stderr}");
    }
}
