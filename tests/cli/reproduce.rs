//! Pictures rendered again from what they say of themselves.

use std::fs;
use std::process::Command;

use crate::desk::{Desk, SCENE};

const TABLE: &str = r#"
[[sphere_tables]]
file = "grains.f32"
columns = ["x", "y", "z", "radius"]
material = "grass"
"#;

fn desk_with_table(radius: f32) -> Desk {
    let desk = Desk::new(&format!("{SCENE}{TABLE}"));
    write_table(&desk, "grains.f32", radius);
    desk
}

fn write_table(desk: &Desk, name: &str, radius: f32) {
    let row = [1.5f32, 2.5, 0.0, radius];
    let bytes: Vec<u8> = row.iter().flat_map(|value| value.to_le_bytes()).collect();
    fs::write(desk.path().join(name), bytes).expect("a table");
}

#[test]
fn pictures_come_out_again_to_the_bit() {
    let desk = desk_with_table(0.5);
    let options = "--accel native --seed 3 --spp 20 --size 20x15 --crop 2,3,19,13 --quiet \
                   --set materials.grass.albedo=[0.5,0.4,0.3]";
    let files = "-o a.exr -o a.png --layers direct,normal,sphere_id,variance,alpha,crypto_sphere \
                 --tone agx --exposure 0.5 --dither";
    desk.run(&format!("render scene.toml {files} {options}")).succeeds();
    // The scene file is not needed any more.
    fs::remove_file(desk.path().join("scene.toml")).expect("it is there");
    for name in ["a.exr", "a.png"] {
        let said = desk.run(&format!("reproduce {name} --quiet --threads 1")).stdout;
        assert!(said.starts_with("all pixels agree to the bit, in "), "{said}");
    }
    assert_eq!(desk.names(), ["a.exr", "a.png", "grains.f32"]);
}

/// Whatever decides how many samples each pixel gets, the picture says what was decided.
#[test]
fn pictures_that_a_noise_target_a_time_or_a_signal_ended_come_out_again() {
    let wide = SCENE.replace("width = 16", "width = 400").replace("height = 12", "height = 300");
    let desk = Desk::new(&wide);
    let render = |options: &str| format!("render scene.toml --accel native --quiet {options}");
    let files = |name: &str| format!("-o {name}.exr -o {name}.png --layers normal,sample_count");
    let noise = "--noise 8% --size 50x40 --crop 3,2,50,40 --max-spp 200";
    desk.run(&render(&format!("{noise} {}", files("noise")))).succeeds();
    desk.run(&render(&format!("--time 60ms {}", files("time")))).succeeds();
    // Stopped while it renders: with a part, to know when that is.
    let kept = format!("{} --checkpoint s.state --checkpoint-every 5ms", files("signal"));
    let command = render(&format!("--spp 1000000 --threads 1 {kept}"));
    let mut child = desk.command(&command).spawn().expect("it starts");
    while !desk.path().join("s.state").exists() {
        assert!(child.try_wait().expect("it runs").is_none());
    }
    let kill = format!("kill -INT {}", child.id());
    assert!(Command::new("sh").args(["-c", &kill]).status().expect("a shell").success());
    assert_eq!(child.wait().expect("it ends").code(), Some(130));

    let mut differing = 0;
    for name in ["noise", "time", "signal"] {
        for file in [format!("{name}.exr"), format!("{name}.png")] {
            let said = desk.run(&format!("reproduce {file} --quiet"));
            assert!(said.stdout.starts_with("all pixels agree"), "{file}: {}", said.stdout);
            let info = desk.run(&format!("info {file} --json")).succeeds().json();
            differing += usize::from(info["counts"].is_array());
        }
    }
    // That of noise for certain; the others where they were stopped within a pass.
    assert!(differing >= 2, "{differing}");
}

/// Pictures merged over gaps, and of windows with different numbers of samples that cut tiles.
#[test]
fn pictures_of_parts_with_gaps_say_what_they_hold_and_come_out_again() {
    let desk = Desk::new(SCENE);
    let render = |options: &str| {
        desk.run(&format!("render scene.toml --accel native --quiet --spp 57 {options}")).succeeds()
    };
    for (name, options) in [
        ("a", "--samples 0..16"),
        ("c", "--samples 32..57"),
        ("left", "--samples 0..16 --crop 0,0,9,12"),
        ("right", "--samples 16..48 --crop 9,0,16,12"),
    ] {
        render(&format!("-o {name}.part --layers direct,sample_count,variance,depth {options}"));
    }
    let merge = |parts: &str, name: &str| {
        let files = format!("-o {name}.exr -o {name}.png --allow-gaps");
        let told = desk.run(&format!("merge {parts} {files}")).succeeds().stderr;
        for file in [format!("{name}.exr"), format!("{name}.png")] {
            let said = desk.run(&format!("reproduce {file} --quiet"));
            assert!(said.stdout.starts_with("all pixels agree"), "{file}: {}", said.stdout);
        }
        (told, desk.run(&format!("info {name}.exr")).succeeds())
    };
    let (told, info) = merge("c.part a.part", "gap");
    assert!(
        told.contains("wrote gap.exr and gap.png, samples 0..16, 32..57 from 2 parts"),
        "{told}"
    );
    assert_eq!(info.row("samples"), "0..16, 32..57");
    let parts =
        "\nparts:\n    pixels 0,0,16,12: samples 0 to 16\n    pixels 0,0,16,12: samples 32 to 57\n";
    assert!(info.stdout.contains(parts), "{}", info.stdout);
    let (_, info) = merge("left.part right.part", "ragged");
    let parts =
        "\nparts:\n    pixels 0,0,9,12: samples 0 to 16\n    pixels 9,0,16,12: samples 16 to 48\n";
    assert!(info.stdout.contains(parts), "{}", info.stdout);
    // Without a gap nothing is said of parts.
    render("-o b.part --layers direct,sample_count,variance,depth --samples 16..32");
    let (_, info) = merge("a.part b.part c.part", "whole");
    assert_eq!(info.row("samples"), "0..57");
    assert!(!info.stdout.contains("\nparts:"), "{}", info.stdout);
}

#[test]
fn samples_that_are_spread_over_a_number_come_out_again_where_there_are_fewer() {
    let desk = Desk::new(SCENE);
    let options = "--accel native --quiet --sampler stratified --spp 64 --samples 0..32";
    desk.run(&format!("render scene.toml -o a.exr {options}")).succeeds();
    let said = desk.run("reproduce a.exr --quiet");
    assert!(said.stdout.starts_with("all pixels agree"), "{}", said.stdout);
}

#[test]
fn what_differs_is_told_in_standard_errors() {
    let desk = Desk::new(SCENE);
    let picture = "--spp 32 --quiet -o a.exr -o a.png";
    desk.run(&format!("render scene.toml --accel native {picture}")).succeeds();
    // Another intersector is another way to make it, though its bits may well be the same.
    let other = desk.run("reproduce a.exr --accel brute-force --quiet");
    assert!(matches!(other.code, Some(0 | 1)), "{}", other.stderr);
    // A picture of other random numbers that claims to be the first.
    desk.run(&format!("render scene.toml --accel native --seed 4 {picture}")).succeeds();
    for name in ["a.exr", "a.png"] {
        let bytes = match name {
            "a.exr" => with_another_seed(&desk.read(name)),
            _ => png_with_another_seed(&desk.read(name)),
        };
        fs::write(desk.path().join(name), bytes).expect("a file");
        let said = desk.run(&format!("reproduce {name} --quiet"));
        assert_eq!(said.code, Some(1), "{}", said.stderr);
        assert!(said.stdout.contains(&format!("`{name}` differs when rendered again, in ")));
        assert!(said.stdout.contains("no difference is known"), "{}", said.stdout);
        let measure = if name == "a.exr" { "standard errors" } else { "of 255 steps" };
        assert!(said.stdout.contains(measure), "{}", said.stdout);
    }
}

/// A file with the seed 0 in place of 4.
fn with_another_seed(bytes: &[u8]) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    let key = b"\"seed\":4";
    let at = bytes.windows(key.len()).position(|part| part == key).expect("a seed");
    bytes[at + key.len() - 1] = b'0';
    bytes
}

fn png_with_another_seed(file: &[u8]) -> Vec<u8> {
    let another = |text: &str| String::from_utf8(with_another_seed(text.as_bytes())).expect("text");
    png_with(file, "settings", &another)
}

/// A PNG file with another record of this name: a text that is not short is compressed and
/// has a checksum.
fn png_with(file: &[u8], record: &str, change: &dyn Fn(&str) -> String) -> Vec<u8> {
    let mut reader = png::Decoder::new(std::io::Cursor::new(file)).read_info().expect("a picture");
    let mut pixels = vec![0; reader.output_buffer_size().expect("a small picture")];
    reader.next_frame(&mut pixels).expect("its pixels");
    let mut info = reader.info().clone();
    for chunk in &mut info.utf8_text {
        let text = chunk.get_text().expect("text");
        if chunk.keyword == format!("photosphere:{record}") {
            let text = change(&text);
            *chunk = png::text_metadata::ITXtChunk::new(chunk.keyword.clone(), text);
        }
    }
    let mut bytes = Vec::new();
    let encoder = png::Encoder::with_info(&mut bytes, info).expect("what was read");
    let mut writer = encoder.write_header().expect("there is memory");
    writer.write_image_data(&pixels).expect("there is memory");
    writer.finish().expect("there is memory");
    bytes
}

/// Pictures of strangers: a record that no render writes ends at once, and so does one that asks
/// for too much.
#[test]
fn records_that_mislead_are_refused_before_anything_is_rendered() {
    let desk = Desk::new(SCENE);
    desk.run("render scene.toml -o a.png --accel native --quiet").succeeds();
    let good = desk.read("a.png");
    let with = |record: &str, from: &str, to: &str| {
        let bytes = png_with(&good, record, &|text| {
            assert!(text.contains(from), "{text}");
            text.replace(from, to)
        });
        fs::write(desk.path().join("b.png"), bytes).expect("a picture");
    };
    with("settings", "\"width\":16", "\"width\":0");
    let words = "record of how it was made is impossible: `image.width` must be";
    desk.run("reproduce b.png").fails(3, &[words, "it is damaged, or was not written by"]);
    with("settings", "\"width\":16", "\"width\":17");
    desk.run("reproduce b.png --quiet").fails(3, &["`b.png` has 192 pixels, but records 204"]);
    with("settings", "\"crop\":null", "\"crop\":{\"x\":5,\"y\":5,\"width\":0,\"height\":4}");
    desk.run("reproduce b.png").fails(3, &["is impossible: `image.crop` must be"]);
    with("samples", "\"first\":0", "\"first\":4294967280");
    desk.run("reproduce b.png").fails(3, &["4 samples from 4294967280 on are not among 0..4"]);
    with("samples", "\"min_count\":4", "\"min_count\":9");
    desk.run("reproduce b.png").fails(3, &["is impossible: "]);

    // More samples than one wants to wait for, and a picture that no machine holds.
    desk.run("reproduce a.png --max-samples 767")
        .fails(3, &["`a.png` records 768 samples in 192 pixels", "--max-samples 768"]);
    let told = desk.run("reproduce a.png --max-samples 768").succeeds().stderr;
    assert!(told.contains("re-rendering 192 pixels, 768 samples"), "{told}");
    desk.run("reproduce a.png --memory-limit 1KiB").fails(3, &["of memory, more than 1.00 KiB"]);
}

/// The files that a picture's scene names: ordinary ones only, which do not block.
#[cfg(unix)]
#[test]
fn pictures_and_scenes_read_no_pipes() {
    let background = "[background.image]\nfile = \"sky.hdr\"";
    let scene = SCENE.replace("[background]\nradiance = [0.5, 0.6, 0.7]", background);
    let desk = Desk::new(&scene);
    let sky = image::Rgb32FImage::from_pixel(4, 2, image::Rgb([1.0, 0.5, 0.25]));
    sky.save(desk.path().join("sky.hdr")).expect("a picture");
    desk.run("render scene.toml -o a.png --accel native --quiet").succeeds();
    desk.run("reproduce a.png --quiet").succeeds();
    fs::remove_file(desk.path().join("sky.hdr")).expect("it is there");
    let pipe = Command::new("mkfifo").arg(desk.path().join("sky.hdr")).status();
    assert!(pipe.expect("mkfifo runs").success());
    for command in ["reproduce a.png --quiet", "info scene.toml"] {
        desk.run(command).fails(3, &["sky.hdr` as background: it is not a regular file"]);
    }
}

#[test]
fn tables_must_be_there_and_be_the_same() {
    let desk = desk_with_table(0.5);
    desk.run("render scene.toml -o a.png --accel native --quiet").succeeds();
    write_table(&desk, "grains.f32", 0.25);
    let message = "grains.f32` is not what the picture was made of";
    desk.run("reproduce a.png --quiet")
        .fails(3, &[message, "help: name the folder that has the original files: --folder DIR"]);
    fs::remove_file(desk.path().join("grains.f32")).expect("it is there");
    desk.run("reproduce a.png --quiet").fails(4, &["cannot read", "grains.f32`", "--folder DIR"]);
    fs::create_dir(desk.path().join("moved")).expect("a folder");
    write_table(&desk, "moved/grains.f32", 0.5);
    desk.run("reproduce a.png --quiet --folder moved").succeeds();
}

#[test]
fn pictures_that_say_nothing_cannot_be_reproduced() {
    let desk = Desk::new(SCENE);
    image::RgbImage::new(2, 2).save(desk.path().join("foreign.png")).expect("a picture");
    desk.run("reproduce foreign.png").fails(3, &["`foreign.png` has no metadata of photosphere"]);
    desk.run("reproduce missing.exr").fails(4, &["cannot read `missing.exr`"]);
    desk.run("reproduce a.pfm").fails(3, &[".pfm files hold only pixels"]);
    desk.run("render scene.toml -o a.part --accel native --quiet").succeeds();
    let words = ["`a.part` is a part, not a picture", "photosphere merge 'a.part' -o picture.exr"];
    desk.run("reproduce a.part").fails(3, &words);
}
