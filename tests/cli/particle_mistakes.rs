//! What is wrong with particle files and their options: where, and what to do.

use std::fs;

use crate::desk::{Desk, outcome};

const RENDER: &str = "-o out.png --size 16x12 --spp 1 --accel native --quiet";

fn desk(name: &str, text: &str) -> Desk {
    let desk = Desk::empty();
    fs::write(desk.path().join(name), text).expect("the file is written");
    desk
}

/// Three beads, of which the middle one has these values.
fn beads(radius: &str, mass: &str) -> Desk {
    desk("a.csv", &format!("x,y,z,radius,mass\n0,0,0,1,3\n3,0,0,{radius},{mass}\n0,3,0,1,4\n"))
}

#[test]
fn missing_colours_are_told_with_file_and_line() {
    for mass in ["", "nan"] {
        let desk = beads("1", mass);
        let told = "warning: a.csv:3: `mass` is no number: drawn in grey\n";
        let render = format!("render a.csv --color mass {RENDER}");
        assert_eq!(desk.run(&render).succeeds().stderr, told);
        // Lines are those of the file, also behind rows that are left out.
        let mut selected = desk.command(&format!("{render} --select"));
        assert_eq!(outcome(selected.arg("x > 1 || y > 1")).succeeds().stderr, told);
        let json = desk.run(&format!("{render} --json")).succeeds().json();
        assert!(json["warnings"][0].as_str().is_some_and(|text| told.contains(text)), "{json}");
        desk.run("import a.csv -o scene.toml --color mass").succeeds();
        assert_eq!(desk.run(&format!("render scene.toml {RENDER}")).succeeds().stderr, told);
    }
    let desk = beads("1", "-1");
    let told = desk.run(&format!("render a.csv --color mass --log {RENDER}")).succeeds().stderr;
    assert_eq!(told, "warning: a.csv:3: `mass` is not positive: drawn in grey\n");
    let rgb = "x,y,z,red,green,blue\n0,0,0,1,1,1\n1,0,0,1,,1\n2,0,0,1,nan,1\n";
    let told = self::desk("a.csv", rgb).run(&format!("render a.csv {RENDER}")).succeeds().stderr;
    let expected = "`red` or `green` or `blue` is no number, like 2 of 3 particles: drawn in grey";
    assert_eq!(told, format!("warning: a.csv:3: {expected}\n"));
}

#[test]
fn radii_that_no_sphere_has_are_told_with_file_line_and_option() {
    for (radius, shown) in [("-2", "-2"), ("", "NaN"), ("0", "0")] {
        let desk = beads(radius, "1");
        let message =
            format!("error: a.csv:3: the radius `radius` of row 1 (the first is 0) is {shown};");
        for more in ["", "--color mass", "--set materials.particles.roughness=0.1"] {
            let told = desk.run(&format!("render a.csv {RENDER} {more}"));
            let parts = [&*message, "leave such particles out: radius > 0"];
            assert!(!told.stderr.contains("a.csv:4"), "a line of the scene: {}", told.stderr);
            told.fails(3, &parts);
        }
        // Not of those that are left out.
        let mut selected = desk.command(&format!("render a.csv {RENDER} --select"));
        outcome(selected.arg("radius > 0")).succeeds();
    }
    let desk = beads("1", "-3");
    let parts = ["a.csv:3: the radius `mass` of row 1 (the first is 0) is -3;", "--radius mass"];
    desk.run(&format!("render a.csv {RENDER} --radius mass")).fails(3, &parts);
}

#[test]
fn unknown_elements_are_told() {
    let atoms = "4\n\nO 0 0 0\nQq 1 0 0\nH 2 0 0\nXy 3 0 0\n";
    let desk = desk("a.xyz", atoms);
    let told =
        |options: &str| desk.run(&format!("render a.xyz {RENDER} {options}")).succeeds().stderr;
    let who = "a.xyz:4: no element is called `Qq` or `Xy`, like 2 of 4 particles: they are";
    assert_eq!(told(""), format!("warning: {who} grey and drawn with a radius of 0.8 Å\n"));
    assert_eq!(told("--radius 1"), format!("warning: {who} grey\n"));
    assert_eq!(told("--radius 1 --color red"), "");
}

#[test]
fn a_ground_is_laid_or_its_absence_told() {
    let desk = beads("1", "1");
    for yes in ["true", "yes", "on"] {
        desk.run(&format!("import a.csv -o scene.toml --ground {yes} --background none"))
            .succeeds();
        let scene = String::from_utf8(desk.read("scene.toml")).expect("text");
        assert!(scene.contains("shadow_catcher = true"), "{scene}");
    }
    for no in ["--ground no", "--background none"] {
        desk.run(&format!("import a.csv -o scene.toml {no}")).succeeds();
        let scene = String::from_utf8(desk.read("scene.toml")).expect("text");
        assert!(!scene.contains("[[spheres]]"), "{scene}");
        let parts =
            ["there is no ground, whose key `spheres.ground.radius` is set", "ask for a ground"];
        let set = format!("render a.csv {RENDER} {no} --set spheres.ground.radius=3");
        desk.run(&set).fails(3, &parts);
    }
    desk.run("render a.csv -o a.png --ground maybe").fails(2, &["[possible values: true, false]"]);
    let below = "there is no ground, because the camera would be below it\n";
    let told = desk.run("import a.csv -o scene.toml --ground on --view -z").succeeds().stderr;
    assert!(told.starts_with(below), "{told}");
    let parts = ["no entry of `spheres` is named \"lamp\"", "named are \"ground\""];
    desk.run(&format!("render a.csv {RENDER} --set spheres.lamp.radius=3")).fails(3, &parts);
}

/// Nobody has seen the scene yet that such an error is about.
#[test]
fn places_in_the_scene_of_a_particle_file_are_called_so() {
    let desk = beads("1", "1");
    let place = "[the scene that `import` writes of a.csv:";
    let set = format!("render a.csv {RENDER} --set materials.particles.type=mirror");
    desk.run(&set).fails(3, &["`materials.particles.reflectance` is missing", place]);
}

#[test]
fn all_rows_tell_what_columns_hold() {
    let desk = desk("a.csv", "x,y,z,mass,kind\n0,0,0,3,b\n1,0,5,,a\n2,0,0,-7.5,b\n");
    let plain = desk.run("info a.csv").succeeds().stdout;
    assert!(!plain.contains("-7.5") && plain.contains("unknown until it is read"), "{plain}");
    let told = desk.run("info a.csv --columns").succeeds();
    assert_eq!(told.row("particles"), "3");
    assert_eq!(told.row("positions"), "from (0 0 0) to (2 0 5)");
    let mass = "mass            numbers from -7.5 to 3, 1 row without a number\n";
    assert!(told.stdout.contains(mass), "{}", told.stdout);
    assert!(told.stdout.contains("kind            words: `a` (1), `b` (2)\n"), "{}", told.stdout);
    let json = desk.run("info a.csv --columns --json").succeeds().json();
    assert_eq!(json["columns"][0]["range"], serde_json::json!([-7.5, 3.0]));
    assert_eq!(json["columns"][1]["words"]["b"], 2);
    desk.run("render a.csv -o a.exr --size 16x12 --spp 1 --quiet").succeeds();
    desk.run("info a.exr --columns").fails(3, &["`--columns` reads particle files"]);
}

#[test]
fn a_file_that_moved_is_asked_for() {
    let desk = beads("1", "1");
    desk.run(&format!("render a.csv {RENDER}")).succeeds();
    fs::create_dir(desk.path().join("data")).expect("a folder");
    fs::rename(desk.path().join("a.csv"), desk.path().join("data/a.csv")).expect("it moves");
    let parts =
        ["cannot read `a.csv`", "name the folder that has the files of the scene: --folder"];
    desk.run("pick out.png 8 6").fails(4, &parts);
    desk.run("reproduce out.png").fails(4, &parts);
    desk.run("pick out.png 8 6 --folder data").succeeds();
    desk.run("reproduce out.png --folder data").succeeds();
}

#[test]
fn names_of_columns_with_brackets_are_found_or_explained() {
    let desk = desk("a.csv", "x,y,z,size (mm)\n0,0,0,0.5\n2,0,0,0.25\n");
    let render = |radius: &str| {
        outcome(desk.command(&format!("render a.csv {RENDER} --radius")).arg(radius))
    };
    render("size (mm)").succeeds();
    render("`size (mm)` / 2").succeeds();
    render("size (mm) / 2").fails(3, &["there is no function `size`", "stands in backticks"]);
}
