//! What is drawn over pictures: that options change it, or say why not.

use std::fmt::Write;
use std::fs;

use photosphere::image_io::read_raw_channels;

use crate::desk::Desk;

/// A desk with twelve beads of growing mass in `beads.csv`.
fn beads() -> Desk {
    let desk = Desk::empty();
    let mut text = String::from("x,y,z,radius,mass\n");
    for i in 0..12 {
        let _ = writeln!(text, "{},{},0,0.5,{i}", i % 4, i / 4);
    }
    fs::write(desk.path().join("beads.csv"), text).expect("the beads are written");
    desk
}

const SMALL: &str = "--size 64x48 --spp 4 --accel native";

/// A desk with a picture of beads with a colour bar, as `a.exr` and `a.png`.
fn pictures() -> Desk {
    let desk = beads();
    let render = format!("render beads.csv -o a.exr -o a.png --color mass {SMALL} --quiet");
    desk.run(&render).succeeds();
    desk
}

#[test]
fn convert_changes_the_texts_of_a_layer() {
    let desk = pictures();
    desk.run("convert a.exr -o b.png --title kg --font-size 14").succeeds();
    assert_eq!(desk.run("info b.png").row("overlay"), "colour bar `kg` (viridis from 0 to 11)");
    desk.run("convert a.exr -o c.png --title kg").succeeds();
    let [a, b, c] = ["a.png", "b.png", "c.png"].map(|name| desk.read(name));
    assert!(a != c && b != c, "neither the title nor the size of its texts changes a pixel");
    desk.run("reproduce b.png").succeeds();
    // With the layers as they are, another program draws what the file has.
    desk.run("convert a.exr -o d.exr").succeeds();
    desk.run("convert d.exr -o d.png --title kg").succeeds();
    assert_eq!(desk.run("info d.png").row("overlay"), desk.run("info c.png").row("overlay"));
    // Without the bar, nothing has a title.
    desk.run("convert a.exr -o e.exr --layer beauty").succeeds();
    desk.run("convert e.exr -o no.png --title kg").fails(3, &["nothing is drawn over `e.exr`"]);
    desk.run("convert a.exr -o f.png --no-legend").succeeds();
    desk.run("convert f.png -o no.png --title kg").fails(3, &["nothing is drawn over `f.png`"]);
    desk.run("convert f.png -o g.png --no-legend").succeeds();
}

#[test]
fn what_is_in_the_pixels_is_neither_changed_nor_drawn_again() {
    let desk = pictures();
    let parts = ["the colour bar or legend of `a.png` is a part of its pixels", "the .exr file"];
    for options in ["--title kg", "--no-legend", "--colormap magma", "--font-size 14"] {
        desk.run(&format!("convert a.png -o no.png {options}")).fails(3, &parts);
    }
    // By way of a file with layers, the bar is still drawn once.
    desk.run("convert a.png -o b.exr").succeeds();
    desk.run("convert b.exr -o c.png").succeeds();
    let pixels = |name: &str| image::load_from_memory(&desk.read(name)).expect("a picture");
    assert_eq!(pixels("a.png"), pixels("c.png"));
    desk.run("convert b.exr -o no.png --title kg").fails(3, &["nothing is drawn over `b.exr`"]);
}

#[test]
fn options_of_false_colours_are_not_ignored() {
    let desk = beads();
    let layers = "--layers direct,indirect,sphere_id,normal --quiet";
    desk.run(&format!("render beads.csv -o a.exr --color mass {SMALL} {layers}")).succeeds();
    let fails = |options: &str, part: &str| {
        desk.run(&format!("convert a.exr -o no.png {options}")).fails(3, &[part]);
    };
    for range in ["--range 0,1", "--log"] {
        fails(range, "a range and a logarithm are for numbers, but the layer `beauty` is light");
    }
    fails("--layer direct --title kg", "nothing is drawn over");
    for options in ["--colormap magma", "--range 0,1", "--title kg", "--font-size 9"] {
        fails(&format!("--layer sphere_id {options}"), "shown by a colour for each id");
        fails(&format!("--layer normal {options}"), "shown by coordinates as red");
    }
}

#[test]
fn bits_that_show_nothing_are_told() {
    let desk = pictures();
    let done = desk.run("convert a.png -o b.png --bits 16").succeeds();
    let told = "warning: `a.png` has 8 bits: 16 show the same 256 steps";
    assert!(done.stderr.starts_with(told), "{}", done.stderr);
    let done = desk.run("convert b.png -o c.png --bits 16").succeeds();
    assert_eq!(done.stderr, "");
}

#[test]
fn a_title_without_a_legend_is_told() {
    let desk = beads();
    let render = format!("render beads.csv -o a.png {SMALL} --quiet --title kg");
    let told = desk.run(&render).succeeds().stderr;
    assert!(told.starts_with("warning: the title is drawn nowhere"), "{told}");
    assert_eq!(desk.run(&format!("{render} --color mass")).succeeds().stderr, "");
    desk.run("import beads.csv -o scene.toml --color mass").succeeds();
    desk.run(&format!("render scene.toml -o b.png {SMALL} --quiet --title kg")).succeeds();
    let bar = "colour bar `kg` (viridis from 0 to 11)";
    assert_eq!(desk.run("info b.png").row("overlay"), bar);
    for option in ["--title kg", "--no-legend", "--scale-bar"] {
        let parts = ["is no part of its scene: give '--", "to photosphere render"];
        desk.run(&format!("import beads.csv -o scene.toml {option}")).fails(2, &parts);
    }
}

#[test]
fn numbers_beyond_the_bar_are_recorded() {
    let desk = beads();
    let render = format!("render beads.csv -o a.png --color mass {SMALL} --quiet");
    for (range, beyond) in [
        ("2,20", ", numbers beyond the lower end"),
        ("-3,9", ", numbers beyond the upper end"),
        ("p0,p100", ""),
    ] {
        desk.run(&format!("{render} --range={range}")).succeeds();
        let told = desk.run("info a.png");
        assert!(told.row("overlay").ends_with(&format!("{beyond})")), "{}", told.stdout);
        assert_eq!(told.row("overlay").contains("beyond"), !beyond.is_empty());
    }
}

/// A fitted camera leaves room at the right: where the bar and its texts are, no particle is.
#[test]
fn a_fitted_camera_keeps_clear_of_the_bar() {
    let desk = beads();
    let scene = "format = 1\n[image]\nwidth = 120\nheight = 60\n[camera]\nfit = true\n\
                 direction = \"z\"\n[background]\nradiance = [1, 1, 1]\ntransparent = true\n\
                 [materials.m]\ntype = \"diffuse\"\nalbedo = [0.5, 0.5, 0.5]\n\
                 [[particles]]\nfile = \"wide.csv\"\ncolor = \"mass\"\nmaterial = \"m\"\n";
    let rows = (0..20).map(|i| format!("{i},{},0,0.5,{i}\n", i % 3));
    let wide = "x,y,z,radius,mass\n".to_owned() + &rows.collect::<String>();
    fs::write(desk.path().join("wide.csv"), wide).expect("the beads are written");
    fs::write(desk.path().join("scene.toml"), scene).expect("the scene is written");
    let covered = |options: &str| {
        let layers = "--layers direct,alpha --spp 4 --accel native --quiet";
        desk.run(&format!("render scene.toml -o a.exr {layers} {options}")).succeeds();
        let raw = read_raw_channels(&desk.path().join("a.exr")).expect("a picture");
        let values = |name: &str| {
            let channel = raw.iter().find(|channel| channel.name == name).expect("a channel");
            channel.bits.iter().map(|bits| f32::from_bits(*bits)).collect::<Vec<_>>()
        };
        let (over, particles) = (values("overlay.A"), values("A"));
        over.iter().zip(&particles).filter(|(over, under)| **over > 0.0 && **under > 0.0).count()
    };
    assert_eq!(covered(""), 0);
    assert!(covered("--set camera.right_margin=0.05") > 0, "without room it would cover some");
}

#[test]
fn texts_that_no_file_holds_are_named() {
    let desk = beads();
    let told = |options: &str| {
        let render = format!("render beads.csv --color mass {SMALL} --quiet {options}");
        desk.run(&render).succeeds().stderr
    };
    for option in ["--title kg", "--scale-bar", "--axes", "--font-size 9"] {
        let told = told(&format!("-o a.pfm -o a.hdr {option}"));
        let name = option.split(' ').next().unwrap_or_default();
        let warning = format!("warning: `{name}` has no effect: only .png files");
        assert!(told.contains(&warning), "{option}: {told}");
        assert_eq!(told.matches("warning").count(), 1, "{option}: {told}");
    }
    for files in ["-o a.pfm -o a.png", "-o a.exr", "-o a.pfm --preview p.png", "-o a.pfm -o a.part"]
    {
        assert!(!told(&format!("{files} --title kg")).contains("warning"), "{files}");
    }
    assert!(!told("-o a.pfm").contains("warning"), "nobody asked for texts");
}

#[test]
fn a_number_for_a_column_is_told() {
    let desk = beads();
    let told = |color: &str| {
        let render = format!("render beads.csv -o a.png --color {color} {SMALL} --quiet");
        desk.run(&render).succeeds().stderr
    };
    assert!(
        told("5").contains("warning: all particles have one colour: `color` is the number 5, not")
    );
    assert_eq!(told("mass"), "");
}
