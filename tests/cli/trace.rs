//! `photosphere trace` as its users meet it: the path that render takes, told and drawn.

use std::collections::BTreeMap;
use std::fs;

use photosphere::image_io::{BEAUTY, read_image};
use serde_json::Value;

use crate::desk::{Desk, Outcome};

/// A small version of a scene of the repository, rendered with one sample per pixel.
fn desk(scene: &str) -> Desk {
    desk_with(scene, "")
}

/// A small version of a scene of the repository, rendered with more options.
fn desk_with(scene: &str, options: &str) -> Desk {
    let desk = Desk::of_file(scene);
    // A lamp in the open in place of one that hardly sticks out, so that few paths meet its light.
    let file = desk.path().join("scene.toml");
    let text = fs::read_to_string(&file).expect("a scene");
    let text = text.replace("681.33", "86.0").replace("radius = 600.0", "radius = 16.0");
    fs::write(&file, text).expect("room for it");
    desk.run(&format!("render scene.toml {SMALL} --quiet -o one.exr {options}")).succeeds();
    desk
}

const SMALL: &str = "--size 16x12 --spp 1 --seed 3";

fn trace(desk: &Desk, arguments: &str) -> Outcome {
    desk.run(&format!("trace scene.toml {SMALL} {arguments}"))
}

/// One of the numbers of a step, or three of them.
fn rgb(step: &Value, key: &str) -> [f64; 3] {
    match &step[key] {
        Value::Array(list) => [0, 1, 2].map(|c| list[c].as_f64().expect("a number")),
        one => [one.as_f64().unwrap_or_else(|| panic!("no `{key}` in {step}")); 3],
    }
}

fn product<const N: usize>(factors: [[f64; 3]; N]) -> [f64; 3] {
    [0, 1, 2].map(|c| factors.iter().map(|factor| factor[c]).product())
}

fn must_be_equal(told: [f64; 3], expected: [f64; 3], about: &str) {
    for (told, expected) in told.into_iter().zip(expected) {
        assert!(
            (told - expected).abs() <= 1e-5 * expected.abs() + 1e-30,
            "{told} {expected}: {about}"
        );
    }
}

/// Multiplies what the steps tell, and compares with what they tell of the products.
fn must_multiply(steps: &[Value]) {
    // What the light sample of a vertex, 0, and its connections bring.
    let (mut throughput, mut aimed) = ([1.0; 3], BTreeMap::new());
    for step in steps {
        let of = |key: &str| rgb(step, key);
        let inverse = |key: &str| rgb(step, key).map(f64::recip);
        let about = format!("{step} in {steps:#?}");
        match step["event"].as_str().expect("a word") {
            "camera_ray" => throughput = [1.0; 3],
            "hit" => throughput = product([throughput, of("transmittance")]),
            "bsdf_sample" => throughput = product([throughput, of("f_cos_over_p")]),
            "roulette" if step["survives"] == false => continue,
            "roulette" => throughput = product([throughput, inverse("survival")]),
            "emission" => {
                let light = product([throughput, of("L_e"), of("weight"), of("clamp")]);
                must_be_equal(of("contribution"), light, &about);
            }
            "light_sample" | "connection" => {
                let light = product([throughput, of("f_r"), of("cos"), of("L_e")]);
                let weight = product([of("transmittance"), of("weight"), inverse("p")]);
                aimed.insert(step["number"].as_u64().unwrap_or(0), product([light, weight]));
            }
            "shadow_catcher" => {
                aimed.insert(0, product([throughput, of("L")]));
            }
            "shadow_ray" => {
                let aimed = aimed[&step["connection"].as_u64().expect("a number")];
                must_be_equal(of("contribution"), product([aimed, of("V"), of("clamp")]), &about);
            }
            _ => {}
        }
        if step.get("throughput").is_some() {
            must_be_equal(of("throughput"), throughput, &about);
        }
    }
}

const PIXELS: [(usize, usize); 10] =
    [(0, 11), (5, 6), (8, 7), (12, 3), (15, 0), (9, 5), (6, 8), (11, 9), (3, 7), (1, 7)];

/// The sample that is told is the one that was rendered, and what is told multiplies and adds up to
/// it. Each of the `wanted` is told at least once.
fn must_be_what_render_takes(scene: &str, options: &str, wanted: &[fn(&Value) -> bool]) {
    let desk = desk_with(scene, options);
    let picture = read_image(&desk.path().join("one.exr")).expect("a picture");
    let pixels = &picture.layer(BEAUTY).expect("a beauty").pixels;
    let mut all = Vec::new();
    for (x, y) in PIXELS {
        let told = trace(&desk, &format!("--pixel {x},{y} --json {options}"));
        let mut told = told.succeeds().json();
        let rendered = pixels[y * 16 + x].to_array();
        let steps = told["events"].as_array_mut().expect("a list");
        must_multiply(steps);
        let mut sum = [0.0; 3];
        for step in steps.iter().filter(|step| step.get("contribution").is_some()) {
            let contribution = rgb(step, "contribution");
            (0..3).for_each(|c| sum[c] += contribution[c]);
        }
        all.append(steps);
        for c in 0..3 {
            let radiance = rgb(&told, "radiance")[c];
            assert_eq!(radiance as f32, rendered[c], "{scene} {x},{y}");
            assert!((sum[c] - radiance).abs() <= 1e-6 * radiance, "{scene} {x},{y}");
        }
    }
    for (number, wanted) in wanted.iter().enumerate() {
        assert!(all.iter().any(wanted), "number {number} of {scene} is not told");
    }
}

fn is(step: &Value, name: &str) -> bool {
    step["event"] == name
}

#[test]
fn the_path_is_the_one_that_render_takes() {
    let arrives = |step: &Value| is(step, "shadow_ray") && rgb(step, "V") == [1.0; 3];
    must_be_what_render_takes("paper/fig2.toml", "", &[arrives]);
    must_be_what_render_takes("cornell-spheres.toml", "", &[arrives]);
    let other = "--integrator direct --estimator light --sampler independent --max-depth 3";
    must_be_what_render_takes("cornell-spheres.toml", other, &[arrives]);
    let chance = "--estimator bsdf --sampler stratified";
    must_be_what_render_takes("cornell-spheres.toml", chance, &[|step| is(step, "bsdf_sample")]);
    let paper = "--integrator paper --set render.paper.subpixels=1";
    must_be_what_render_takes("paper/fig2.toml", paper, &[|step| is(step, "bsdf_sample")]);
}

/// Surfaces that are there for some paths only dim a shadow ray, which is told, and so is what they
/// do to a path.
#[test]
fn what_is_not_opaque_has_its_factor() {
    must_be_what_render_takes(
        "paper/fig2.toml",
        "--set materials.floating.opacity=0.4 --set materials.resting.opacity=0.5 \
         --set materials.lamp.opacity=0.7",
        &[
            |step| is(step, "shadow_ray") && (1e-3..0.9).contains(&rgb(step, "V")[0]),
            |step| is(step, "transparent"),
            |step| is(step, "hit") && rgb(step, "opacity")[0] < 1.0,
        ],
    );
}

#[test]
fn a_clamp_that_bites_and_a_medium_that_absorbs_have_their_factors() {
    must_be_what_render_takes(
        "cornell-spheres.toml",
        "--set render.clamp_indirect=0.02 --set materials.glass.absorption=[0.01,0.02,0.03]",
        &[
            |step| is(step, "shadow_ray") && rgb(step, "clamp")[0] < 1.0,
            |step| is(step, "hit") && rgb(step, "transmittance")[2] < 1.0,
        ],
    );
}

/// A connection over a polished ball is told, drawn, and one of the sums.
#[test]
fn a_connection_has_its_factors_words_and_lines() {
    let scene = "caustics/two-balls.toml";
    let arrives =
        |step: &Value| is(step, "shadow_ray") && step["connection"] != 0 && rgb(step, "V")[0] > 0.0;
    must_be_what_render_takes(
        scene,
        "--set render.clamp_indirect=0.02",
        &[
            |step| is(step, "connection") && rgb(step, "weight")[0] > 0.0,
            arrives,
            |step| is(step, "shadow_ray") && rgb(step, "clamp")[0] < 1.0,
        ],
    );
    let desk = desk(scene);
    let mut all = String::new();
    for pixel in ["12,8", "14,6", "14,7"] {
        all += &trace(&desk, &format!("--pixel {pixel} --svg path.svg")).succeeds().stdout;
        all += &fs::read_to_string(desk.path().join("path.svg")).expect("written");
    }
    for told in [
        "connects reflected off `mirror ball` to `lamp`",
        "connects through `glass ball`",
        "|dA / dw| = ",
        "by BSDF sampling: w = ",
        "class=\"unoccluded\"",
    ] {
        assert!(all.contains(told), "`{told}` is not in\n{all}");
    }
}

/// A point that catches shadows lists the light that it asks for, and adds up to what is rendered.
#[test]
fn a_shadow_catcher_lists_its_light() {
    let caught = "--set spheres.ground.shadow_catcher=true --set background.backdrop=[0.2,0.3,0.4]";
    let arrives = |step: &Value| {
        is(step, "shadow_ray") && rgb(step, "contribution") == [0.2f32, 0.3, 0.4].map(f64::from)
    };
    let of_lamp = |step: &Value| is(step, "shadow_catcher") && step["source"] == "`lamp`";
    must_be_what_render_takes("paper/fig2.toml", caught, &[arrives, of_lamp]);
    let dark = format!("{caught} --set materials.lamp.emission=[0,0,0]");
    let nothing = |step: &Value| is(step, "shadow_catcher") && step["source"].is_null();
    must_be_what_render_takes("paper/fig2.toml", &dark, &[nothing, arrives]);
    let desk = desk("paper/fig2.toml");
    let story = trace(&desk, &format!("--pixel 8,11 {caught}")).succeeds().stdout;
    for told in ["catches shadows: behind it the camera sees L = (0.2,", "+ T L = (0.2, 0.3, 0.4)"]
    {
        assert!(story.contains(told), "`{told}` is not in\n{story}");
    }
}

#[test]
fn an_estimator_that_combines_nothing_prints_no_second_pdf() {
    let desk = desk("cornell-spheres.toml");
    for (estimator, told, other) in [
        ("mis", "by BSDF sampling: w = 0.", "alone"),
        ("light", "by light sampling alone: w = 1", "by BSDF sampling"),
        ("bsdf", "the path ends: ", "by light sampling"),
    ] {
        let mut all = String::new();
        for y in 0..12 {
            let arguments = format!("--pixel 8,{y} --estimator {estimator} --caustics chance");
            all += &trace(&desk, &arguments).succeeds().stdout;
        }
        assert!(all.contains(told) && !all.contains(other), "{estimator}\n{all}");
    }
}

#[test]
fn a_path_ends_once_and_a_symbol_stays_with_its_value() {
    let desk = desk("cornell-spheres.toml");
    let mut roulettes = 0;
    for y in 0..12 {
        let story = trace(&desk, &format!("--pixel 8,{y}")).succeeds().stdout;
        assert_eq!(story.matches("the path ends: ").count(), 1, "{story}");
        roulettes += story.matches("the path ends: Russian roulette").count();
        let parted = |line: &str| line.trim_start().starts_with('=') || line.ends_with('=');
        assert!(!story.lines().any(parted), "{story}");
    }
    assert!(roulettes > 0);
}

#[test]
fn the_story_has_the_letters_of_the_equation_and_the_names_of_the_spheres() {
    let desk = desk("cornell-spheres.toml");
    let mut all = String::new();
    for y in 0..12 {
        all += &trace(&desk, &format!("--pixel 8,{y}")).succeeds().stdout;
    }
    for told in [
        "x_0  the camera at (",
        "x_1  `",
        "hit from",
        "T = (",
        "samples `",
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
fn the_story_has_words_for_what_dims_and_for_what_is_not_there() {
    let desk = desk("paper/fig2.toml");
    let veils = "--set materials.floating.opacity=0.4 --set materials.resting.opacity=0.5 \
                 --set render.clamp_indirect=0.02";
    let mut all = String::new();
    for pixel in ["5,6", "9,5", "8,7"] {
        all += &trace(&desk, &format!("--pixel {pixel} {veils}")).succeeds().stdout;
    }
    assert!(all.lines().all(|line| line.len() <= 80), "{all}");
    let all = all.split_whitespace().collect::<Vec<_>>().join(" ");
    for told in [
        "; opacity 0.5 ",
        "transparent for this path: passes straight through",
        "partly occluded: V = (0.5, 0.5, 0.5) + T f_r |cos| L_e V w / p = (",
        "(indirect; scaled by 0.",
    ] {
        assert!(all.contains(told), "`{told}` is not in\n{all}");
    }
    assert!(!all.contains("boundary hidden by a medium"), "{all}");
}

#[test]
fn the_drawing_shows_the_spheres_and_finite_numbers_only() {
    let desk = desk("cornell-spheres.toml");
    for y in [2, 6, 10] {
        trace(&desk, &format!("--pixel 8,{y} --svg path.svg")).succeeds();
        let svg = fs::read_to_string(desk.path().join("path.svg")).expect("written");
        for part in ["<svg xmlns", "class=\"path\"", "x₁", "class=\"emitter\"", "</svg>"] {
            assert!(svg.contains(part), "{part}");
        }
        assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
    }
}

#[test]
fn what_is_not_there_cannot_be_traced() {
    let desk = desk("paper/fig2.toml");
    for (arguments, code, told) in [
        ("--pixel 16,0", 3, "there is no pixel 16,0: the picture has 16 x 12"),
        ("--pixel 1,1 --sample 1", 3, "there is no sample 1: each pixel has 1"),
        ("--pixel 1", 2, "such as 320,240"),
        ("", 2, "--pixel"),
        ("--pixel 1,1 --integrator raycast", 3, "`raycast` traces no paths"),
        ("--pixel 1,1 --svg none/a.svg", 4, "does not exist"),
        ("--pixel 1,1 --svg a.png", 3, "`a.png` does not end in .svg"),
    ] {
        let Outcome { code: found, stderr, .. } = trace(&desk, arguments);
        assert_eq!(found, Some(code), "{arguments}: {stderr}");
        assert!(stderr.contains(told), "{arguments}: {stderr}");
    }
}
