//! What is drawn over pictures: that options change it, or say why not.

use std::fmt::Write;
use std::fs;

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
        fails(range, "`--range` and `--log` are for numbers, but the layer `beauty` is light");
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
