//! Pictures that say how they were made, and how they look.

use std::fs;

use image::RgbImage;

use crate::desk::{Desk, SCENE};

fn pixels(desk: &Desk, name: &str) -> RgbImage {
    image::load_from_memory(&desk.read(name)).expect("a picture").into_rgb8()
}

#[test]
fn a_picture_says_how_it_was_made() {
    let desk = Desk::new(SCENE);
    let options = "--accel native --spp 3 --seed 5 --set materials.grass.albedo=[0.5,0.4,0.3]";
    desk.run(&format!("render scene.toml -o a.png -o a.exr {options}")).succeeds();
    for name in ["a.png", "a.exr"] {
        let shown = desk.run(&format!("info {name}")).succeeds();
        assert!(shown.row("version").starts_with("0."), "{}", shown.stdout);
        for (row, text) in [
            ("intersector", "native"),
            ("size", "16x12"),
            ("samples", "0..3"),
            ("biased", "max_depth = 6"),
        ] {
            assert_eq!(shown.row(row), text);
        }
        for line in ["\n    radius = 250.0\n", "\n    render.seed = 5\n"] {
            assert!(shown.stdout.contains(line), "{}", shown.stdout);
        }
        assert!(!shown.stdout.contains("\nscene:\n"), "its text says the same: {}", shown.stdout);
        let said = desk.run(&format!("info {name} --json")).succeeds().json();
        assert_eq!(said["scene-text"], SCENE);
        assert_eq!(said["settings"]["render"]["seed"], 5);
        let albedo = &said["scene"]["materials"][0]["surface"]["albedo"];
        assert_eq!(*albedo, serde_json::json!([0.5f32, 0.4f32, 0.3f32]));
        for identity in ["scene-identity", "job-identity"] {
            assert_eq!(said[identity].as_str().map(str::len), Some(64), "{identity}");
        }
        let command = said["command"].as_str().expect("a command");
        assert!(command.starts_with("photosphere render scene.toml -o a.png"), "{command}");
        assert!(said["rays"].is_u64() && said["commit"].is_string() && said["seconds"].is_f64());
    }
}

#[test]
fn equal_pictures_are_equal_files_without_the_figures_of_the_run() {
    let desk = Desk::new(SCENE);
    let render = "render scene.toml --accel native --quiet";
    desk.run(&format!("{render} -o a.exr -o a.png --threads 1 --no-run-figures")).succeeds();
    desk.run(&format!("{render} -o b.exr -o b.png --threads 2 --no-run-figures")).succeeds();
    desk.run(&format!("{render} -o c.exr -o c.png --threads 2")).succeeds();
    assert_eq!(desk.read("a.exr"), desk.read("b.exr"));
    assert_eq!(desk.read("a.png"), desk.read("b.png"));
    let said = desk.run("info a.png").succeeds().stdout;
    assert!(!said.contains("command") && !said.contains("seconds"), "{said}");
    // Without the text of the scene, its values are shown by their keys.
    for line in
        ["camera.vertical_fov_degrees = ", "materials.grass.albedo = [", "spheres.0.radius = "]
    {
        assert!(said.contains(&format!("\n    {line}")), "{said}");
    }
    assert_eq!(pixels(&desk, "a.png"), pixels(&desk, "c.png"));
    desk.run("compare a.exr c.exr --max-rmse 0").succeeds();
}

#[test]
fn what_has_no_records_says_so() {
    let desk = Desk::new(SCENE);
    RgbImage::new(2, 2).save(desk.path().join("foreign.png")).expect("a picture");
    desk.run("info foreign.png").fails(3, &["`foreign.png` has no metadata of photosphere"]);
    desk.run("render scene.toml -o a.hdr --accel native").succeeds();
    desk.run("info a.hdr").fails(3, &[".hdr files hold only pixels", "help: use a .png or .exr"]);
    desk.run("info missing.exr").fails(4, &["cannot read `missing.exr`"]);
    fs::write(desk.path().join("broken.png"), "no picture").expect("a file");
    desk.run("info broken.png").fails(4, &["cannot read `broken.png`"]);
    desk.run("info a.png --set render.seed=1").fails(3, &["but `a.png` is a picture"]);
}

#[test]
fn a_tone_is_for_the_screen_alone() {
    let desk = Desk::new(SCENE);
    let render = "render scene.toml --accel native --quiet";
    desk.run(&format!("{render} -o plain.exr -o plain.png --no-run-figures")).succeeds();
    let toned = "--no-run-figures --tone agx --exposure 1.5 --dither --dpi 300";
    desk.run(&format!("{render} -o agx.exr -o agx.png {toned}")).succeeds();
    assert_eq!(desk.read("plain.exr"), desk.read("agx.exr"));
    let (plain, agx) = (pixels(&desk, "plain.png"), pixels(&desk, "agx.png"));
    assert!(plain.pixels().zip(agx.pixels()).all(|(plain, agx)| plain.0[1] < agx.0[1]));
    let said = desk.run("info agx.png").succeeds();
    assert_eq!(said.row("look"), "agx, exposure 1.5, dithered");
    let has_resolution = |name: &str| desk.read(name).windows(4).any(|bytes| bytes == b"pHYs");
    assert!(has_resolution("agx.png") && !has_resolution("plain.png"));
    assert!(!desk.run("info plain.png").succeeds().stdout.contains("\nlook "));
}

#[test]
fn a_tone_without_a_screen_is_refused() {
    let desk = Desk::new(SCENE);
    let refused = |options: &str, code: i32, parts: &[&str]| {
        desk.run(&format!("render scene.toml {options}")).fails(code, parts);
        assert_eq!(desk.names(), ["scene.toml"]);
    };
    refused(
        "-o a.exr --tone filmic",
        3,
        &["`--tone` applies only to .png files, and `a.exr` is not", "help: add a .png file"],
    );
    refused("-o a.pfm -o a.hdr --exposure -1", 3, &["`--exposure`", "`a.pfm` and `a.hdr` are not"]);
    refused("-o a.exr --dither", 3, &["`--dither` applies only to .png files"]);
    refused("-o a.exr --preview p.png --dpi 300", 3, &["`--dpi` applies only to .png files"]);
    refused("-o a.png --dpi 0", 2, &["0 is not in 1..=100000"]);
    // A preview is for the screen.
    let preview = "--tone filmic --preview p.png --quiet";
    desk.run(&format!("render scene.toml -o a.exr {preview}")).succeeds();
    desk.run("render scene.toml -o a.png --tone filmic --quiet").succeeds();
    assert_eq!(pixels(&desk, "a.png"), pixels(&desk, "p.png"));
    for name in ["a.exr", "a.png", "p.png"] {
        fs::remove_file(desk.path().join(name)).expect("it was written");
    }
    refused("-o a.png --tone aces", 2, &["invalid value 'aces'", "srgb, filmic, agx"]);
    refused("-o a.png --exposure bright", 2, &["a number of stops from -100 to 100"]);
    refused("-o a.png -o a.exr -o a.png", 3, &["-o a.png and -o a.png are the same file"]);
}

#[test]
fn layers_need_a_file_with_a_place_for_them() {
    let desk = Desk::new(SCENE);
    let refused = |options: &str, code: i32, parts: &[&str]| {
        desk.run(&format!("render scene.toml {options}")).fails(code, parts);
        assert_eq!(desk.names(), ["scene.toml"]);
    };
    refused(
        "-o a.exr --layers direct,albdo",
        2,
        &["invalid value 'albdo'", "emission, albedo, normal", "similar value exists: 'albedo'"],
    );
    refused(
        "-o a.png --layers beauty,normal",
        3,
        &["`a.png` cannot hold the layer `normal`", "help: layers need an .exr file"],
    );
    refused("-o a.pfm -o b.hdr --layers alpha", 3, &["`a.pfm` and `b.hdr` cannot hold", "`alpha`"]);
    desk.run("render scene.toml -o a.png -o a.exr --layers depth,alpha,sphere_id").succeeds();
    assert_eq!(desk.run("info a.exr").succeeds().row("layers"), "depth,alpha,sphere_id");
    assert!(!desk.run("info a.png").succeeds().stdout.contains("\nlayers"));
    desk.run("render scene.toml -o b.png --layers beauty,alpha").succeeds();
}

/// No counts of thousands of tiles, no JSON, errors as percentages; all of it is in `--json`.
#[test]
fn what_a_picture_says_is_in_words() {
    let desk = Desk::new(SCENE);
    let noise = "--size 64x48 --noise 3% --max-spp 20000 --crop 3,5,60,45";
    let render = "render scene.toml --accel native --quiet -o a.exr";
    desk.run(&format!("{render} {noise} --layers depth,sample_count")).succeeds();
    let said = desk.run("info a.exr").succeeds();
    assert_eq!(said.row("noise"), "3.00 % for 95 % of the values");
    let error = said.row("error");
    assert!(error.ends_with(" % of the brightness, for 95 % of the values"), "{error}");
    let counts = said.row("counts");
    assert!(counts.contains(" tiles of 16 x 4 pixels, ") && counts.len() < 80, "{counts}");
    let before_text = said.stdout.split("scene-text").next().expect("all");
    assert!(!before_text.contains('{'), "{before_text}");
    let all = desk.run("info a.exr --json").succeeds().json();
    assert!(all["counts"].as_array().is_some_and(|runs| runs.len() > 1));
    assert!(all["error"].as_f64().is_some_and(|error| error < 0.05));
    // A scene of many lines is cut.
    let many: String = (0..200).map(|i| SCENE_BALL.replace('#', &i.to_string())).collect();
    let desk = Desk::new(&format!("{SCENE}{many}"));
    desk.run("render scene.toml --accel native --quiet --spp 1 -o a.png").succeeds();
    let said = desk.run("info a.png").succeeds().stdout;
    assert!(said.contains(" more lines\n") && said.lines().count() < 250, "{said}");
}

/// One more ball of the scene, whose number stands for `#`.
const SCENE_BALL: &str = "
[[spheres]]
name = \"ball #\"
center = [#.0, 1.0, -9.0]
radius = 0.4
material = \"grass\"
";
