//! Pictures shown in another way.

use std::fs;

use image::DynamicImage;

use crate::desk::{Desk, SCENE};

fn picture(desk: &Desk, name: &str) -> DynamicImage {
    image::load_from_memory(&desk.read(name)).expect("a picture")
}

/// A desk with a picture in `a.exr`, with layers, and the same for the screen in `a.png`.
fn desk(options: &str) -> Desk {
    let desk = Desk::new(SCENE);
    let layers = "--layers direct,indirect,albedo,normal,depth,sphere_id,sample_count";
    let render = "render scene.toml --accel native --quiet -o a.exr -o a.png";
    desk.run(&format!("{render} {layers} {options}")).succeeds();
    desk
}

#[test]
fn a_view_transform_afterwards_is_the_one_of_the_render() {
    let desk = desk("--tone agx --exposure 1.5 --dither --dpi 300 --no-run-figures");
    desk.run("convert a.exr -o b.png --tone agx --exposure 1.5 --dither --dpi 300").succeeds();
    assert_eq!(desk.read("a.png"), desk.read("b.png"), "the record, too");
    desk.run("convert a.exr -o c.exr").succeeds();
    assert_eq!(desk.read("a.exr"), desk.read("c.exr"));
    let alpha = "-o t.exr -o t.png --layers direct,alpha --no-run-figures";
    desk.run(&format!("render scene.toml --accel native --quiet {alpha}")).succeeds();
    desk.run("convert t.exr -o u.png").succeeds();
    assert_eq!(desk.read("t.png"), desk.read("u.png"));
    for name in ["b.png", "c.exr", "u.png"] {
        let said = desk.run(&format!("reproduce {name} --quiet")).succeeds().stdout;
        assert!(said.starts_with("all pixels agree"), "{said}");
    }
}

#[test]
fn sixteen_bits_are_recorded_and_come_out_again() {
    let desk = desk("");
    desk.run("convert a.exr -o deep.png --bits 16 --tone filmic").succeeds();
    assert_eq!(picture(&desk, "deep.png").color(), image::ColorType::Rgb16);
    let said = desk.run("info deep.png").succeeds();
    assert_eq!((said.row("bits"), said.row("look")), ("16", "filmic"));
    desk.run("reproduce deep.png --quiet").succeeds();
    // The finer levels of a file of 8 bits are not those of a render.
    desk.run("convert a.png -o up.png --bits 16").succeeds();
    let said = desk.run("info up.png").succeeds();
    assert_eq!(said.row("converted"), "from 8 bits for the screen");
    desk.run("reproduce up.png").fails(3, &["changed after it was rendered: from 8 bits"]);
}

#[test]
fn a_crop_is_that_of_a_render() {
    let desk = desk("--no-run-figures");
    let render = "render scene.toml --accel native --quiet --no-run-figures";
    desk.run("convert a.exr -o crop.exr --layer direct,beauty,depth --crop 3,2,11,9").succeeds();
    let layers = "--layers direct,beauty,depth";
    desk.run(&format!("{render} {layers} --crop 3,2,11,9 -o wanted.exr")).succeeds();
    desk.run("compare crop.exr wanted.exr --max-mse 0").succeeds();
    desk.run("reproduce crop.exr --quiet").succeeds();
    assert_eq!(desk.run("info crop.exr").succeeds().row("crop"), "3,2,11,9");
    // A crop of a crop counts from the full picture.
    desk.run("convert crop.exr -o less.png --crop 4,3,9,8").succeeds();
    desk.run("reproduce less.png --quiet").succeeds();
    let (small, whole) = (picture(&desk, "less.png").into_rgb8(), picture(&desk, "a.png"));
    let whole = whole.into_rgb8();
    assert_eq!(small.dimensions(), (5, 5));
    assert!(small.enumerate_pixels().all(|(x, y, p)| p == whole.get_pixel(x + 4, y + 3)));
    let words = ["the crop 0,0,4,4 is not within the picture, which is 3,2,11,9"];
    desk.run("convert crop.exr -o no.png --crop 0,0,4,4").fails(3, &words);
}

/// Tiles of a crop keep the counts that they had.
#[test]
fn a_crop_of_uneven_samples_comes_out_again() {
    let desk = Desk::new(SCENE);
    let render = "render scene.toml --accel native --quiet --size 64x48 --noise 3% --max-spp 20000";
    desk.run(&format!("{render} -o a.exr")).succeeds();
    assert!(desk.run("info a.exr").succeeds().stdout.contains("tiles of 16 x 4 pixels"));
    desk.run("convert a.exr -o b.exr --crop 10,5,60,41").succeeds();
    desk.run("reproduce b.exr --quiet").succeeds();
}

#[test]
fn numbers_become_colours_with_a_bar() {
    let desk = desk("");
    let told = desk.run("convert a.exr -o depth.png --layer depth --no-legend").succeeds().stderr;
    assert!(told.starts_with("depth.png: layer depth, colour map viridis from "), "{told}");
    let depth = picture(&desk, "depth.png").into_rgba8();
    // The top shows nothing.
    assert_eq!(depth.get_pixel(0, 0).0[3], 0);
    // Viridis begins with violet.
    let is_near = |p: &&image::Rgba<u8>| p.0 == [68, 1, 84, 255];
    assert!(depth.pixels().find(is_near).is_some());
    let bar = "--layer sample_count --colormap gray --range 0,5 --title n";
    desk.run(&format!("convert a.exr -o n.png {bar}")).succeeds();
    // Four samples of five.
    assert_eq!(picture(&desk, "n.png").into_rgb8().get_pixel(0, 0).0, [204; 3]);
    let said = desk.run("info n.png").succeeds();
    assert_eq!(said.row("converted"), "layer sample_count; colour map gray from 0 to 5");
    assert_eq!(said.row("overlay"), "colour bar `n` (gray from 0 to 5)");
    desk.run("convert a.exr -o id.png --layer sphere_id --quiet").succeeds();
    let ids = picture(&desk, "id.png").into_rgba8();
    let mut colors: Vec<_> = ids.pixels().map(|p| p.0).collect();
    colors.sort_unstable();
    colors.dedup();
    assert_eq!(colors.len(), 3, "two spheres and nothing");
    desk.run("convert a.exr -o up.png --layer normal").succeeds();
    // The ground looks up.
    let [r, g, b, _] = picture(&desk, "up.png").into_rgba8().get_pixel(8, 11).0;
    assert!(g > 250 && (r as i32 - 128).abs() < 8 && (b as i32 - 128).abs() < 12, "{r} {g} {b}");
    // Linear files keep the numbers.
    desk.run("convert a.exr -o depth.pfm --layer depth").succeeds();
    desk.run("convert a.exr -o light.png --colormap inferno --log").succeeds();
}

#[test]
fn layers_are_chosen_by_name() {
    let desk = desk("");
    desk.run("convert a.exr -o few.exr --layer depth,albedo").succeeds();
    let words = ["`few.exr` has no layer `beauty` to show", "albedo, depth"];
    desk.run("convert few.exr -o no.png").fails(3, &words);
    desk.run("convert few.exr -o albedo.png --layer albedo").succeeds();
    let said = desk.run("info few.exr").succeeds();
    assert_eq!(
        (said.row("layers"), said.row("converted")),
        ("albedo,depth", "without the layer beauty")
    );
    desk.run("convert a.exr -o no.exr --layer dept").fails(3, &["no layer `dept`", "beauty, "]);
    let words = ["a .png file holds one layer", "help: name one, such as depth"];
    desk.run("convert a.exr -o no.png --layer depth,albedo").fails(3, &words);
    assert!(!desk.path().join("no.png").exists() && !desk.path().join("no.exr").exists());
}

#[test]
fn pictures_of_other_programs_and_formats_are_converted() {
    let desk = desk("");
    for name in ["b.hdr", "b.pfm", "c.exr"] {
        desk.run(&format!("convert a.exr -o {name}")).succeeds();
        desk.run(&format!("convert {name} -o {name}.png --exposure -1")).succeeds();
    }
    let dark = |name: &str| picture(&desk, name).into_rgb8();
    assert_eq!(dark("b.pfm.png"), dark("c.exr.png"));
    image::RgbImage::from_pixel(3, 2, image::Rgb([9, 99, 199]))
        .save(desk.path().join("foreign.png"))
        .expect("a picture");
    desk.run("convert foreign.png -o foreign.exr").succeeds();
    desk.run("convert foreign.exr -o back.png").succeeds();
    assert_eq!(picture(&desk, "back.png").into_rgb8().get_pixel(2, 1).0, [9, 99, 199]);
    desk.run("info back.png").fails(3, &["has no metadata of photosphere"]);
}

#[test]
fn what_makes_no_sense_is_refused() {
    let desk = desk("");
    let refused = |arguments: &str, parts: &[&str]| {
        desk.run(&format!("convert {arguments}")).fails(3, parts);
    };
    refused("a.exr -o a.exr", &["would replace `a.exr`"]);
    refused("a.exr -o b.hdr --tone agx", &["`--tone` applies only to .png files, and `b.hdr` is"]);
    refused("a.exr -o b.exr --bits 16", &["`--bits` applies only to .png files"]);
    refused("a.exr -o b.png --bits 16 --dither", &["`--dither` hides the steps of 8 bits"]);
    refused("a.png -o b.png --exposure 1", &["`a.png` has been through a view transform"]);
    refused("a.exr -o b.png --layer depth --tone agx", &["are for light", "`depth`"]);
    refused("a.exr -o b.png --layer depth --log --range=-1,5", &["no positive number"]);
    refused("a.exr -o b.jpg", &["does not end in .png"]);
    desk.run("convert none.exr -o b.png").fails(4, &["cannot read `none.exr`"]);
    desk.run("render scene.toml -o a.part --quiet").succeeds();
    refused("a.part -o b.png", &["is a part", "photosphere merge 'a.part'"]);
    fs::write(desk.path().join("broken.exr"), "no picture").expect("a file");
    desk.run("convert broken.exr -o b.png").fails(4, &["cannot read `broken.exr`"]);
    assert!(!desk.path().join("b.png").exists());
}
