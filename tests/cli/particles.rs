//! Particle files from file to picture: what is chosen, what is said, and that pictures are true.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::fs;

use photosphere::color::{Rgb, ciede2000};
use photosphere::image_io::read_raw_channels;

use crate::desk::{Desk, SCENE};

/// A LAMMPS dump of a cubic lattice: two types, and an energy that grows along x.
fn dump() -> String {
    let mut text = String::from(
        "ITEM: TIMESTEP\n100\nITEM: NUMBER OF ATOMS\n216\nITEM: BOX BOUNDS pp pp pp\n0 6\n0 6\n0 6\n\
         ITEM: ATOMS id type x y z c_pe\n",
    );
    for row in 0..216 {
        let [x, y, z] = [row % 6, row / 6 % 6, row / 36];
        let energy = -3.0 + 0.125 * f64::from(x);
        let _ = writeln!(text, "{} {} {x}.5 {y}.5 {z}.5 {energy}", row + 1, 1 + row % 2);
    }
    text
}

fn desk() -> Desk {
    let desk = Desk::empty();
    fs::write(desk.path().join("run.lammpstrj"), dump()).expect("the dump is written");
    desk
}

const SMALL: &str = "--size 48x36 --spp 16 --accel native";

/// The channels of a picture as numbers.
fn channels(desk: &Desk, name: &str) -> BTreeMap<String, Vec<f32>> {
    let raw = read_raw_channels(&desk.path().join(name)).expect("a picture");
    let floats = |bits: Vec<u32>| bits.into_iter().map(f32::from_bits).collect();
    raw.into_iter().map(|channel| (channel.name, floats(channel.bits))).collect()
}

#[test]
fn one_command_makes_a_picture_and_tells_what_it_chose() {
    let desk = desk();
    let done = desk.run(&format!("render run.lammpstrj -o a.png {SMALL}")).succeeds();
    let told = "chosen automatically: --view '-55,25' --radius 0.5 --color type\n";
    assert!(done.stderr.contains(told), "{}", done.stderr);
    // The options that are told make the same picture.
    let fixed = "--view -55,25 --radius 0.5 --color type";
    desk.run(&format!("render run.lammpstrj -o b.png {SMALL} {fixed} --quiet")).succeeds();
    assert_eq!(channels(&desk, "a.png"), channels(&desk, "b.png"));
    desk.run("reproduce a.png").succeeds();
}

#[test]
fn an_imported_scene_renders_to_the_same_picture() {
    let desk = desk();
    let look = "--color c_pe --range p0,p100 --style dark --ortho --replicate 2,1,1 --cell";
    desk.run(&format!("render run.lammpstrj -o a.exr {SMALL} {look}")).succeeds();
    desk.run(&format!("import run.lammpstrj -o scene.toml --size 48x36 --spp 7 {look}")).succeeds();
    desk.run(&format!("render scene.toml -o b.exr {SMALL}")).succeeds();
    assert_eq!(channels(&desk, "a.exr"), channels(&desk, "b.exr"));
    let scene = String::from_utf8(desk.read("scene.toml")).expect("text");
    let keys = ["file = \"run.lammpstrj\"", "color = \"c_pe\"", "range = \"-3,-2.375\""];
    for line in keys.into_iter().chain(["samples_per_pixel = 7"]) {
        assert!(scene.contains(line), "{scene}");
    }
}

#[test]
fn what_is_drawn_over_the_picture_does_not_change_it() {
    let desk = desk();
    let render = |name: &str, options: &str| {
        let all = format!("render run.lammpstrj -o {name} {SMALL} --color c_pe {options}");
        desk.run(&all).succeeds();
        channels(&desk, name)
    };
    // The view leaves room for the colour bar in both.
    let mut with = render("a.exr", "--axes --scale-bar --title energy");
    let without = render("b.exr", "--no-legend");
    let overlay: Vec<String> =
        with.keys().filter(|name| name.starts_with("overlay.")).cloned().collect();
    assert_eq!(overlay, ["overlay.A", "overlay.B", "overlay.G", "overlay.R"]);
    assert!(with["overlay.A"].contains(&1.0) && with["overlay.A"].contains(&0.0));
    overlay.iter().for_each(|name| _ = with.remove(name));
    assert_eq!(with, without);
    let shown = render("a.png", "--axes");
    assert_ne!(shown, render("b.png", "--no-legend"));
    for picture in ["a.exr", "a.png"] {
        desk.run(&format!("reproduce {picture}")).succeeds();
    }
}

/// A dense melt: beads at random places, with a number that grows along x.
fn melt() -> String {
    let mut state = 1u64;
    let mut random = move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (state >> 40) as f64 / (1u64 << 24) as f64 * 12.0
    };
    let mut text = String::from("x,y,z,radius,c_pe\n");
    for _ in 0..1700 {
        let [x, y, z] = [random(), random(), random()];
        let _ = writeln!(text, "{x},{y},{z},0.5,{x}");
    }
    text
}

/// Median colour difference between pixels and the colours of their particles, as measured here and
/// as printed.
fn median_difference(file: &str, style: &str, shade: f32) -> [f64; 2] {
    let desk = desk();
    fs::write(desk.path().join("melt.csv"), melt()).expect("the melt is written");
    let look = format!("--color c_pe --style {style} --layers albedo,alpha,sphere_id --json");
    let size = "--size 80x60 --spp 32 --accel native --view -30,20";
    let done = desk.run(&format!("render {file} -o a.exr {size} {look}")).succeeds();
    assert!(done.stderr.contains("colours differ from the legend by "), "{}", done.stderr);
    let printed = done.json()["color_difference"].as_f64().expect("a number");
    let picture = channels(&desk, "a.exr");
    let color = |layer: &str, pixel: usize| {
        let name = |channel: &str| format!("{layer}{channel}");
        Rgb::from_array(["R", "G", "B"].map(|channel| picture[&name(channel)][pixel]))
    };
    // The ground, if there is one, is the sphere in row 0.
    let is_particle = |pixel: &usize| {
        let id = picture["sphere_id"][*pixel].to_bits();
        id != u32::MAX && picture["A"][*pixel] == 1.0 && !(style == "studio" && id == 0)
    };
    let pixels = (0..80 * 60).filter(is_particle);
    // A picture for the screen clips at white.
    let shown = |pixel| ciede2000(color("", pixel).min(Rgb::ONE), color("albedo.", pixel) / shade);
    let mut differences: Vec<f64> = pixels.map(shown).collect();
    differences.sort_by(f64::total_cmp);
    assert!(differences.len() > 500, "{}", differences.len());
    [differences[differences.len() / 2], printed]
}

#[test]
fn colours_are_those_of_the_colour_bar() {
    for file in ["run.lammpstrj", "melt.csv"] {
        for (style, shade, most) in [("flat", 0.15, 3.0), ("studio", 0.95, 8.0)] {
            let [measured, printed] = median_difference(file, style, shade);
            assert!(measured <= most, "{file}, {style}: {measured}");
            assert!((measured - printed).abs() < 1.0, "{file}, {style}: {measured} {printed}");
        }
    }
}

#[test]
fn particles_smaller_than_a_pixel_are_said_to_be_mixed() {
    let desk = desk();
    fs::write(desk.path().join("melt.csv"), melt()).expect("the melt is written");
    // Diameters of about 4 pixels, and of 0.4.
    for (size, are_mixed) in [("80x60", false), ("8x6", true)] {
        let look = "--color c_pe --style flat --spp 4 --accel native --view -30,20";
        let done = desk.run(&format!("render melt.csv -o a.png --size {size} {look}")).succeeds();
        let said = done.stderr.contains("most particles are smaller than a pixel");
        assert!(done.stderr.contains("colours differ from the legend"), "{}", done.stderr);
        assert_eq!(said, are_mixed, "{size}: {}", done.stderr);
    }
}

#[test]
fn other_commands_take_particle_files() {
    let desk = desk();
    desk.run("trace run.lammpstrj --pixel 24,18 --size 48x36 --view iso").succeeds();
    desk.run("crosscheck run.lammpstrj --rays 300").succeeds();
    let tiny = "--size 16x12 --spp 1,2 --seeds 2 --quiet";
    desk.run(&format!("converge run.lammpstrj -o a.svg {tiny}")).succeeds();
    let look = "--size 48x36 --accel native --view iso --color c_pe --title energy";
    let plan = "plan run.lammpstrj --shards 2 --spp 32 -o whole.png --size 48x36";
    let plan = desk.run(&format!("{plan} --view iso --style clay")).succeeds();
    assert!(plan.stdout.contains("--view iso --style clay"), "{}", plan.stdout);
    let by_crop = "plan run.lammpstrj --shards 2 --by crop -o whole.png";
    assert!(desk.run(by_crop).succeeds().stdout.contains("--spp 64"));
    // What is drawn over a picture is drawn over one that is merged from parts, and over previews.
    let preview = "--preview so-far.png";
    desk.run(&format!("render run.lammpstrj -o a.png --spp 32 {look} {preview}")).succeeds();
    for (part, samples) in [("a.part", "0..16"), ("b.part", "16..32")] {
        let samples = format!("--spp 32 --samples {samples}");
        desk.run(&format!("render run.lammpstrj -o {part} {samples} {look}")).succeeds();
    }
    desk.run("merge a.part b.part -o merged.png").succeeds();
    assert_eq!(channels(&desk, "a.png"), channels(&desk, "merged.png"));
    assert_eq!(channels(&desk, "a.png"), channels(&desk, "so-far.png"));
}

#[test]
fn columns_are_layers() {
    let desk = desk();
    let look = "--select type==2 --replicate 2,1,1 --layers c_pe,depth,id";
    desk.run(&format!("render run.lammpstrj -o a.exr {SMALL} {look}")).succeeds();
    let picture = channels(&desk, "a.exr");
    let mut seen = 0;
    for (pixel, energy) in picture["c_pe"].iter().enumerate() {
        let id = picture["id"][pixel];
        assert_eq!(energy.is_nan(), id.is_nan());
        if !energy.is_nan() {
            seen += 1;
            // The id is that of the row, counted from 1.
            let x = (id as i32 - 1) % 6;
            assert_eq!(*energy, -3.0 + 0.125 * x as f32);
            assert_eq!(id as i32 % 2, 0, "type 2");
        }
    }
    assert!(seen > 100 && seen < picture["c_pe"].len(), "{seen}");
    assert!(picture.contains_key("sphere_id") && picture.contains_key("depth"));
    desk.run("reproduce a.exr").succeeds();
    desk.run(&format!("render run.lammpstrj -o b.exr {SMALL} --layers c_pee"))
        .fails(3, &["there is no column `c_pee`"]);
    fs::write(desk.path().join("scene.toml"), SCENE).expect("the scene is written");
    desk.run("render scene.toml -o b.exr --layers c_pe").fails(3, &["there is no layer `c_pe`"]);
}

#[test]
fn without_a_number_of_samples_a_picture_gets_as_many_as_it_needs() {
    let desk = desk();
    let tiny = "--size 32x24 --accel native";
    let done = desk.run(&format!("render run.lammpstrj -o a.png {tiny}")).succeeds();
    for told in [" --quality good ", " --max-spp 1024\n"] {
        assert!(done.stderr.contains(told), "{}", done.stderr);
    }
    let fixed =
        format!("render run.lammpstrj -o b.png {tiny} --quality good --max-spp 1024 --quiet");
    desk.run(&fixed);
    assert_eq!(channels(&desk, "a.png"), channels(&desk, "b.png"));
}

#[test]
fn mistakes_are_shown_with_their_place() {
    let desk = desk();
    for (option, place, message) in [
        ("--select typ==2", "1:10", "no column `typ`"),
        ("--select type=2", "1:14", "`=` is no operator"),
        ("--select type>9", "1:10", "no particle fulfils the condition"),
        ("--slice type>0", "1:9", "all particles are hidden"),
        ("--color c_pee", "1:9", "no column `c_pee`"),
        ("--radius vdw", "1:10", "`run.lammpstrj` names no elements"),
        ("--radius -1", "1:10", "must be above 0, not -1"),
        ("--range 1", "1:9", "must be two numbers or percentiles"),
        ("--unwrap", "1:1", "lacks the image flags ix, iy and iz"),
        ("--replicate 2,2", "1:1", "must be three numbers, not 2"),
    ] {
        let done = desk.run(&format!("render run.lammpstrj -o a.png {option}"));
        done.fails(3, &[message, &format!("[command line:{place}]")]);
    }
    fs::write(desk.path().join("scene.toml"), SCENE).expect("the scene is written");
    desk.run("render scene.toml -o a.png --style clay")
        .fails(3, &["`--style` is for particle files, but `scene.toml` is a scene"]);
    assert_eq!(desk.names(), ["run.lammpstrj", "scene.toml"]);
}

#[test]
fn a_pixel_tells_its_particle() {
    let desk = desk();
    let look = "--select type==2 --view z --ortho --radius 0.45 --no-legend";
    let size = "--size 120x120 --spp 1 --accel native";
    desk.run(&format!("render run.lammpstrj -o a.png {size} {look}")).succeeds();
    let background = desk.run("pick a.png 0 0 --json").succeeds();
    // Below the particles is the ground, which is no particle.
    assert_eq!(background.json()["row"], serde_json::Value::Null);
    let mut found = 0;
    for y in (5..120).step_by(6) {
        let picked = desk.run(&format!("pick a.png 60 {y} --json")).succeeds().json();
        let Some(row) = picked["row"].as_u64() else { continue };
        found += 1;
        assert_eq!(picked["columns"]["id"], row + 1);
        assert_eq!(picked["columns"]["type"], 2);
        assert_eq!(picked["line"], row + 10);
        assert_eq!(picked["center"][2], 5.5, "the uppermost layer: {picked}");
    }
    assert!(found > 3, "{found}");
    fs::write(desk.path().join("run.lammpstrj"), dump().replace("0.5", "0.6")).expect("written");
    desk.run("pick a.png 60 58").fails(3, &["`run.lammpstrj` is not what the picture was made of"]);
}

#[test]
fn info_tells_what_is_in_a_file() {
    let desk = desk();
    let told = desk.run("info run.lammpstrj").succeeds();
    assert_eq!(told.row("format"), "lammps-dump");
    assert_eq!(told.row("particles"), "216");
    assert!(told.row("cell").contains("(6 0 0)"), "{}", told.stdout);
    let value = desk.run("info run.lammpstrj --json").succeeds().json();
    assert_eq!(value["count"], 216);
    assert!(value["memory_bytes"].as_u64().is_some_and(|bytes| bytes > 1 << 20), "{value}");
}

#[test]
fn a_checkpoint_of_a_particle_file_is_resumed() {
    let desk = desk();
    let options = "--size 48x36 --accel native --color c_pe --no-run-figures";
    desk.run(&format!("render run.lammpstrj -o whole.png {options} --spp 32")).succeeds();
    desk.run(&format!("render run.lammpstrj -o a.png {options} --spp 16 --checkpoint a.state"))
        .succeeds();
    desk.run("resume a.state --extend-to 32").succeeds();
    assert_eq!(channels(&desk, "a.png"), channels(&desk, "whole.png"));
}

#[test]
fn several_files_are_rendered_into_a_folder() {
    let desk = desk();
    fs::copy(desk.path().join("run.lammpstrj"), desk.path().join("b.dump")).expect("a copy");
    fs::write(desk.path().join("bad.xyz"), "three\n").expect("written");
    let tiny = "--size 16x12 --spp 1 --accel native --quiet";
    let done = desk.run(&format!("render run.lammpstrj bad.xyz b.dump -o out/ {tiny}"));
    assert_eq!(done.code, Some(3), "{}", done.stderr);
    assert!(done.stderr.contains("`bad.xyz` is not rendered"), "{}", done.stderr);
    let mut names: Vec<String> = fs::read_dir(desk.path().join("out"))
        .expect("the folder is made")
        .map(|entry| entry.expect("an entry").file_name().into_string().expect("a plain name"))
        .collect();
    names.sort();
    assert_eq!(names, ["b.png", "run.png"]);
    desk.run(&format!("render run.lammpstrj b.dump -o a.png {tiny}"))
        .fails(3, &["several files are rendered into a folder"]);
}
