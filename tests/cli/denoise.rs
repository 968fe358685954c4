//! Denoised pictures: without the library, which is said, and with it, where it is installed.

use std::process::Command;

use photosphere::color::Rgb;
use photosphere::image_io::{BEAUTY, LayeredImage, read_image};

use crate::desk::{Desk, Outcome, SCENE, outcome};

/// Runs the program where it finds no library.
fn without_library(desk: &Desk, arguments: &str) -> Outcome {
    let mut command: Command = desk.command(arguments);
    command.env("OIDN_DIR", desk.path());
    outcome(&mut command)
}

/// Returns true if the library is installed. `scripts/try-denoise.sh` runs these tests with it.
fn has_library(desk: &Desk) -> bool {
    let told = desk.run("doctor");
    let is_there = told.stdout.contains("Intel Open Image Denoise 2.");
    assert!(is_there || std::env::var_os("OIDN_DIR").is_none(), "{}", told.stdout);
    is_there
}

fn picture(desk: &Desk, name: &str) -> LayeredImage {
    read_image(&desk.path().join(name)).expect("a picture")
}

#[test]
fn without_the_library_the_help_says_how_to_get_it_before_anything_is_rendered() {
    let desk = Desk::new(SCENE);
    let help = ["Open Image Denoise is not in OIDN_DIR", "help: pip install pyoidn", "OIDN_DIR=/"];
    without_library(&desk, "render scene.toml -o a.exr --denoise").fails(3, &help);
    assert_eq!(desk.names(), ["scene.toml"]);
    desk.run("render scene.toml -o a.exr --accel native --quiet").succeeds();
    without_library(&desk, "denoise a.exr -o b.exr").fails(3, &help);
    assert_eq!(desk.names(), ["a.exr", "scene.toml"]);
    let told = without_library(&desk, "doctor").stdout;
    assert!(
        told.contains("oidn        not found") && told.contains("pip install pyoidn"),
        "{told}"
    );
}

#[test]
fn what_cannot_be_denoised_is_refused() {
    let desk = Desk::new(SCENE);
    desk.run("render scene.toml -o a.exr -o a.png --accel native --quiet").succeeds();
    desk.run("denoise a.exr -o a.exr").fails(3, &["would replace `a.exr`"]);
    desk.run("denoise a.exr -o b.exr --tone agx").fails(3, &["`--tone` applies only to .png"]);
    if has_library(&desk) {
        desk.run("denoise a.png -o b.exr").fails(3, &["holds values for the screen, not light"]);
        desk.run("convert a.exr -o d.exr --layer direct").succeeds();
        desk.run("denoise d.exr -o b.exr").fails(3, &["has no layer `beauty`"]);
    }
}

/// Mean squared difference of a layer from the beauty of another picture, relative to the latter,
/// so that the edge of the lamp does not outweigh all else.
fn error(image: &LayeredImage, layer: &str, truth: &LayeredImage) -> f32 {
    let pixels = image.layer(layer).expect(layer).pixels.iter();
    let truth = &truth.layer(BEAUTY).expect("the picture").pixels;
    let relative = |(a, b): (&Rgb, &Rgb)| (*a - *b).length_squared() / (b.length_squared() + 0.03);
    let squares = pixels.zip(truth).map(relative);
    squares.sum::<f32>() / truth.len() as f32
}

#[test]
fn both_ways_give_the_same_layer_and_less_noise() {
    let desk = Desk::of_file("cornell-spheres.toml");
    if !has_library(&desk) {
        return;
    }
    let render = "render scene.toml --size 128x96 --accel native --quiet";
    let denoised = "--spp 16 --denoise -o a.exr -o a.png -o a.pfm --tone agx";
    desk.run(&format!("{render} {denoised}")).succeeds();
    desk.run(&format!("{render} --spp 1024 -o truth.exr")).succeeds();
    let (a, truth) = (picture(&desk, "a.exr"), picture(&desk, "truth.exr"));
    assert!(error(&a, "denoised", &truth) < 0.3 * error(&a, BEAUTY, &truth));
    // The other formats show the denoised picture.
    let alone = picture(&desk, "a.pfm");
    assert_eq!(alone.layers[0].pixels, a.layer("denoised").expect("it").pixels);
    desk.run("convert a.exr -o b.png --layer denoised --tone agx").succeeds();
    assert_eq!(desk.read("a.png"), desk.read("b.png"), "the record, too");
    // Afterwards, from the layers of the file, and of a picture that has been denoised before.
    desk.run("denoise a.exr -o again.exr").succeeds();
    assert_eq!(picture(&desk, "again.exr"), a);
    desk.run("denoise a.exr -o again.png --tone agx").succeeds();
    assert_eq!(desk.read("a.png"), desk.read("again.png"));
    // Without layers that guide it.
    desk.run("denoise a.pfm -o plain.exr").succeeds();
    assert!(picture(&desk, "plain.exr").layer("denoised").is_some());
}

#[test]
fn the_record_says_biased_and_the_samples_stay_as_they_were() {
    let desk = Desk::new(SCENE);
    if !has_library(&desk) {
        return;
    }
    let render = "render scene.toml --accel native --quiet --no-run-figures --threads 1";
    let layers = "--layers beauty,denoising_albedo,denoising_normal";
    desk.run(&format!("{render} --denoise -o a.exr --spp 16 --checkpoint a.state")).succeeds();
    for file in ["a.exr", "a.png"] {
        desk.run("convert a.exr -o a.png --layer denoised").succeeds();
        let said = desk.run(&format!("info {file}")).succeeds();
        assert!(said.row("biased").ends_with(", denoised"), "{}", said.stdout);
        let by = said.row("converted");
        assert!(by.starts_with("denoised by Intel Open Image Denoise 2."), "{by}");
        desk.run(&format!("reproduce {file}")).fails(3, &["changed after it was rendered: den"]);
        let cited = desk.run(&format!("cite {file}")).succeeds().stdout;
        assert!(cited.contains("denoised by Intel"), "{cited}");
    }
    // What is shown undenoised is a render again.
    desk.run("convert a.exr -o plain.png --layer beauty").succeeds();
    desk.run("reproduce plain.png --quiet").succeeds();
    assert!(!desk.run("info plain.png").succeeds().stdout.contains("denoised"));
    // The checkpoint and what comes of it know nothing of it, but that pictures are denoised.
    desk.run(&format!("{render} -o plain.exr --spp 16 {layers}")).succeeds();
    desk.run("convert a.exr -o raw.exr --layer beauty,direct,indirect").succeeds();
    desk.run("compare raw.exr plain.exr --max-mse 0 --layer beauty").succeeds();
    assert!(!desk.run("info a.state").succeeds().row("biased").contains("denoised"));
    desk.run("merge a.state -o merged.exr --no-run-figures").succeeds();
    assert!(picture(&desk, "merged.exr").layer("denoised").is_none());
    desk.run("resume a.state --extend-to 32 --quiet").succeeds();
    let resumed = picture(&desk, "a.exr");
    assert!(resumed.layer("denoised").is_some());
    desk.run(&format!("{render} -o longer.exr --spp 32 {layers}")).succeeds();
    let longer = picture(&desk, "longer.exr");
    assert_eq!(resumed.layer(BEAUTY), longer.layer(BEAUTY));
    // Samples are not held back for want of the library.
    let told = without_library(&desk, "resume a.state --extend-to 48 --quiet").succeeds().stderr;
    assert!(told.contains("the pictures are written as rendered"), "{told}");
    assert!(picture(&desk, "a.exr").layer("denoised").is_none());
}
