//! `photosphere converge` as its users meet it: slopes, references, refusals.

use std::fs;

use serde_json::Value;

use crate::desk::{Desk, Outcome};

/// A folder with figure 2 of the paper in it.
fn desk() -> Desk {
    Desk::of_file("paper/fig2.toml")
}

fn run(desk: &Desk, arguments: &str) -> Outcome {
    desk.run(&format!("converge {arguments}"))
}

fn json(desk: &Desk, arguments: &str) -> Value {
    run(desk, &format!("{arguments} --json --quiet")).succeeds().json()
}

/// With 12 seeds and independent numbers the slope is -1/2 within its own 99.98 % interval, which
/// is 2.4 times the printed one (Student's t, 11 degrees of freedom).
#[test]
fn independent_samples_have_the_slope_of_one_half_for_every_estimator() {
    let desk = desk();
    let told = json(
        &desk,
        "scene.toml --size 24x18 --integrator paper,path --sampler independent --spp 16,4,64 \
         --seeds 12 -o noise.svg",
    );
    let names: Vec<_> = told["series"].as_array().unwrap().iter().map(|s| &s["name"]).collect();
    assert_eq!(names, ["paper, independent", "path, independent"]);
    for series in told["series"].as_array().unwrap() {
        let slope = &series["slope_against_samples"];
        let (mean, half) = (number(&slope["mean"]), number(&slope["half_width_95"]));
        assert!((mean + 0.5).abs() < 2.4 * half, "{series}");
        assert!(half < 0.2, "{series}");
        let points = series["points"].as_array().unwrap();
        let samples: Vec<_> =
            points.iter().map(|p| p["samples_per_pixel"].as_u64().unwrap()).collect();
        assert_eq!(samples, [4, 16, 64]);
        assert!(points.iter().all(|point| number(&point["seconds"]["mean"]) > 0.0));
    }
    assert_eq!(told["reference"]["integrator"], "path");
    assert_eq!(told["reference"]["samples_per_pixel"], 1024);
    let svg = fs::read_to_string(desk.path().join("noise.svg")).expect("written");
    for text in ["scene.toml", "paper, independent", "samples per pixel", "is subtracted"] {
        assert!(svg.contains(text), "{text}");
    }
}

fn number(value: &Value) -> f64 {
    value.as_f64().expect("a number")
}

#[test]
fn a_picture_can_be_the_reference_and_its_error_is_then_not_known() {
    let desk = desk();
    let best = "--integrator path --size 16x12 --spp 512 --quiet -o best.exr";
    desk.run(&format!("render scene.toml {best}")).succeeds();
    let arguments =
        "scene.toml --integrator path --spp 1,4 --seeds 2 --reference best.exr -o n.svg";
    let outcome = run(&desk, &format!("{arguments} --size 16x12 --metric relmse"));
    assert_eq!(outcome.code, Some(0), "{}", outcome.stderr);
    for told in
        ["reference: best.exr; its own error is unknown", "relMSE", "slope against samples -"]
    {
        assert!(outcome.stdout.contains(told), "{told}: {}", outcome.stdout);
    }
    let outcome = run(&desk, arguments);
    assert_eq!(outcome.code, Some(3));
    assert!(outcome.stderr.contains("add --size 16x12"), "{}", outcome.stderr);
}

/// The paper's sub-pixels are k x k, and all curves have points at the same samples.
#[test]
fn the_usual_samples_are_such_that_the_paper_can_take_them() {
    let desk = desk();
    let few = "scene.toml --size 6x4 --seeds 2 --reference-spp 8 -o n.svg";
    let samples = |told: &Value| -> Vec<Vec<u64>> {
        let of = |series: &Value| {
            let points = series["points"].as_array().unwrap().iter();
            points.map(|point| point["samples_per_pixel"].as_u64().unwrap()).collect()
        };
        told["series"].as_array().unwrap().iter().map(of).collect()
    };
    let told = json(&desk, &format!("{few} --integrator paper,path"));
    assert_eq!(samples(&told), [[4, 8, 16, 32, 64, 128, 256]; 2]);
    let three = "--set render.paper.subpixels=3";
    let told = json(&desk, &format!("{few} --integrator paper {three}"));
    assert_eq!(samples(&told), [[9, 18, 36, 72, 144, 288, 576]]);
    let told = json(&desk, &format!("{few} --integrator path {three}"));
    assert_eq!(samples(&told), [[1, 2, 4, 8, 16, 32, 64]]);
}

/// Aiming at the emitter of figure 2 is worth far more than finding it by chance: a factor of ten
/// in the error, at the least.
#[test]
fn estimators_are_curves_of_their_own() {
    let desk = desk();
    let arguments = "scene.toml --size 16x12 --spp 16,64 --seeds 4 --estimator mis,bsdf -o n.svg";
    let told = json(&desk, &format!("{arguments} --integrator path"));
    let series = told["series"].as_array().unwrap();
    let names: Vec<_> = series.iter().map(|series| series["name"].as_str().unwrap()).collect();
    assert_eq!(names, ["path, mis", "path, bsdf"]);
    let error = |series: &Value| number(&series["points"][1]["error"]["mean"]);
    assert!(error(&series[1]) > 10.0 * error(&series[0]), "{told}");
}

/// A path that ends after direct light misses what the reference has, at any number of samples.
#[test]
fn values_of_a_key_are_compared() {
    let desk = desk();
    let arguments = "scene.toml --size 16x12 --spp 64 --seeds 2 --integrator path \
                     --compare render.max_depth=2,8 -o n.svg";
    let told = json(&desk, arguments);
    let series = told["series"].as_array().unwrap();
    let names: Vec<_> = series.iter().map(|series| series["name"].as_str().unwrap()).collect();
    assert_eq!(names, ["path, max_depth=2", "path, max_depth=8"]);
    let error = |series: &Value| number(&series["points"][0]["error"]["mean"]);
    assert!(error(&series[0]) > 2.0 * error(&series[1]), "{told}");
}

/// A lamp that a mirror ball shows to one of many thousand samples decides the error of a pixel.
#[test]
fn a_few_pixels_that_carry_the_error_are_named() {
    let desk = Desk::of_file("caustics/mirror-ball.toml");
    let outcome = run(&desk, "scene.toml --size 64x48 --spp 4 --reference-spp 256 -o n.svg");
    assert_eq!(outcome.code, Some(0), "{}", outcome.stderr);
    for told in ["is in 1 of 3072 pixels, the worst in column 29, row 17", "--reference-spp"] {
        assert!(outcome.stderr.contains(told), "{}", outcome.stderr);
    }
    let even = run(&self::desk(), "scene.toml --size 16x12 --spp 4 --seeds 2 -o n.svg");
    assert!(!even.stderr.contains("half of the squared error"), "{}", even.stderr);
}

#[test]
fn a_scene_without_any_error_is_not_told_to_have_a_better_reference() {
    let desk = desk();
    let black =
        "scene.toml --size 6x4 --seeds 2 --spp 1,2 --integrator path --set render.max_depth=1";
    let outcome = run(&desk, &format!("{black} -o noise.svg"));
    assert_eq!(outcome.code, Some(3), "{}", outcome.stderr);
    assert!(outcome.stderr.contains("there is no error to plot"), "{}", outcome.stderr);
    assert!(!outcome.stderr.contains("reference-spp"), "{}", outcome.stderr);
    assert!(!desk.path().join("noise.svg").exists());
}

#[test]
fn mistakes_are_told_before_anything_is_rendered() {
    let desk = desk();
    for (arguments, code, told) in [
        ("scene.toml -o noise.png", 3, "does not end in .svg"),
        ("scene.toml -o none/noise.svg", 4, "does not exist"),
        ("none.toml -o noise.svg", 4, "none.toml"),
        ("scene.toml --integrator path,pth -o noise.svg", 3, "--integrator pth"),
        ("scene.toml --estimator mis,mos -o noise.svg", 3, "--estimator mos"),
        (
            "scene.toml --integrator paper --spp 4,6 -o noise.svg",
            3,
            "multiple of the 2 x 2 sub-pixels",
        ),
        ("scene.toml --integrator ambient-occlusion,normals -o noise.svg", 3, "different pictures"),
        ("scene.toml --integrator path,direct -o noise.svg", 3, "--reference-integrator"),
        ("scene.toml --spp 0 -o noise.svg", 2, "0"),
        ("scene.toml --compare materials.lamp.opacity=0,1 -o n.svg", 2, "keys of [render]"),
        ("scene.toml --compare render.max_depht=2,8 -o n.svg", 3, "did you mean `max_depth`"),
        ("scene.toml --seeds 1 -o noise.svg", 2, "1"),
        ("scene.toml --spp 4 --reference a.exr --reference-spp 8 -o n.svg", 2, "cannot be used"),
    ] {
        let outcome = run(&desk, arguments);
        assert_eq!(outcome.code, Some(code), "{arguments}: {}", outcome.stderr);
        assert!(outcome.stderr.contains(told), "{arguments}: {}", outcome.stderr);
        assert!(!desk.path().join("noise.svg").exists());
    }
}
