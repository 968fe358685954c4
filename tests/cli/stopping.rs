//! Renders that end at a noise target or at a time, and those who look on.

use std::fs;
use std::io::Read;
use std::net::{TcpListener, TcpStream};
use std::process::{Command, Stdio};
use std::thread;
use std::time::Duration;

use image::GenericImageView;

use crate::desk::{Desk, SCENE, send, wait_until};

#[test]
fn a_noise_target_is_met_and_the_file_says_how() {
    let desk = Desk::new(SCENE);
    let render = "render scene.toml --accel native --noise 15% --no-run-figures --json";
    let layers = "--layers beauty,sample_count";
    let said = desk.run(&format!("{render} -o a.exr {layers} --threads 1")).succeeds().json();
    assert_eq!(said["noise"]["tiles"], 1);
    assert_eq!(said["noise"]["tiles_converged"], 1);
    assert!(said["noise"]["worst_error"].as_f64().is_some_and(|worst| worst <= 0.15), "{said}");
    assert_eq!(said["samples"].as_u64().map(|samples| samples % (64 * 16 * 12)), Some(0));
    desk.run(&format!("{render} -o b.exr {layers} --threads 2")).succeeds();
    assert_eq!(desk.read("a.exr"), desk.read("b.exr"));
    assert_eq!(desk.run("info a.exr").succeeds().row("samples"), "0..64");
}

#[test]
fn a_quality_is_reached_where_a_noise_target_would_go_on() {
    let desk = Desk::new(SCENE);
    let render = "render scene.toml --accel native --json -o a.exr";
    let good = desk.run(&format!("{render} --quality good")).succeeds().json();
    assert_eq!(good["noise"]["tiles_converged"], 1);
    assert!(good["noise"]["display"].is_object(), "{good}");
    let preview = desk.run(&format!("{render} --quality preview")).succeeds().json();
    assert!(preview["samples"].as_u64() <= good["samples"].as_u64());
    let info = desk.run("info a.exr").succeeds();
    assert!(info.row("noise") == "12.0 of 255 shown, for 90 % of the values", "{}", info.stdout);
    for wrong in ["--quality good --noise 1%", "--quality good --spp 4", "--quality best"] {
        desk.run(&format!("render scene.toml -o a.exr {wrong}")).fails(2, &[]);
    }
}

/// Two squares, one of them with less to see.
const WIDE: [(&str, &str); 2] = [("width = 16", "width = 32"), ("height = 12", "height = 16")];

#[test]
fn stopped_squares_go_on_and_add_up_to_the_same_bytes() {
    let scene = WIDE.iter().fold(SCENE.to_owned(), |text, (from, to)| text.replacen(from, to, 1));
    let desk = Desk::new(&scene);
    let render = "render scene.toml --accel native --noise 3.25% --quiet";
    desk.run(&format!("{render} -o whole.exr --no-run-figures --threads 1")).succeeds();
    let said = desk.run("info whole.exr --json").succeeds().json();
    assert_eq!(said["counts"].as_array().map(Vec::len), Some(8), "{said}");
    let parts = [("0,0,16,16", "a.part"), ("16,0,32,16", "b.part")];
    for (crop, part) in parts {
        desk.run(&format!("{render} --crop {crop} -o {part}")).succeeds();
        // Nothing is left to do.
        let again = desk.run(&format!("{render} --crop {crop} -o {part} --json")).succeeds();
        assert_eq!(again.json()["samples"], 0);
    }
    desk.run("merge b.part a.part -o merged.exr --no-run-figures --quiet").succeeds();
    assert_eq!(desk.read("merged.exr"), desk.read("whole.exr"));
}

#[test]
fn a_render_to_a_noise_target_that_was_stopped_ends_with_the_same_bytes() {
    let changes = [("width = 16", "width = 90"), ("height = 12", "height = 70")];
    let desk =
        Desk::new(&changes.iter().fold(SCENE.to_owned(), |text, (a, b)| text.replacen(a, b, 1)));
    let render = "render scene.toml --accel native --no-run-figures --quiet --noise 0.8%";
    desk.run(&format!("{render} -o whole.exr --layers sample_count")).succeeds();
    let kept = "--checkpoint a.state --checkpoint-every 5ms --threads 1";
    let command = format!("{render} -o a.exr --layers sample_count {kept}");
    let mut child = desk.command(&command).spawn().expect("it starts");
    while !desk.path().join("a.state").exists() {
        assert!(child.try_wait().expect("it runs").is_none(), "it ended before it was stopped");
    }
    let kill = format!("kill -INT {}", child.id());
    assert!(Command::new("sh").args(["-c", &kill]).status().expect("a shell").success());
    assert_eq!(child.wait().expect("it ends").code(), Some(130));
    assert!(desk.read("a.exr") != desk.read("whole.exr"));
    desk.run("resume a.state --quiet").succeeds();
    assert!(desk.read("a.exr") == desk.read("whole.exr"));
}

#[test]
fn a_target_that_is_not_met_is_told_and_the_picture_is_there() {
    let desk = Desk::new(SCENE);
    let outcome =
        desk.run("render scene.toml -o a.pfm --accel native --noise 0.01% --max-spp 64 --quiet");
    outcome.fails(
        1,
        &["warning: the noise target of 0.01 % is not met in 1 of 1 tiles", "an error of"],
    );
    assert_eq!(desk.names(), ["a.pfm", "scene.toml"]);
}

#[test]
fn what_makes_no_sense_together_is_refused() {
    let desk = Desk::new(SCENE);
    let refused = |options: &str, code: i32, words: &str| {
        desk.run(&format!("render scene.toml -o a.png --accel native {options}"))
            .fails(code, &[words]);
    };
    refused("--noise 1% --spp 64", 2, "'--noise <ERROR>' cannot be used with '--spp <N>'");
    refused("--noise 1% --samples 0..64", 2, "cannot be used with");
    refused("--max-spp 64", 2, "--noise <ERROR>");
    refused("--noise 1", 2, "expected a fraction up to 50%, such as 1% or 0.01");
    refused("--noise -1%", 2, "expected a fraction up to 50%, such as 1% or 0.01");
    refused("--confidence 90%", 2, "--noise <ERROR>");
    refused("--noise 1% --confidence -5%", 2, "expected a fraction from 50% to 99.99%");
    refused("--time -3s", 2, "expected a time, such as 30s, 5m or 1h");
    refused("--preview-every -3s", 2, "expected a time, such as 30s, 5m or 1h");
    refused("--checkpoint-every -3s", 2, "expected a time, such as 30s, 5m or 1h");
    refused("--noise 1% --max-spp 63", 2, "63 is not in 64..");
    refused("--time soon", 2, "expected a time, such as 30s, 5m or 1h");
    let counted =
        "a noise target decides when to stop, but stratified sampling needs the number of samples";
    refused("--noise 1% --sampler stratified", 3, counted);
    refused("--time 1s --sampler stratified", 3, "a time limit decides when to stop");
    let cells = "3 x 3 sub-pixels do not fit into its blocks of 16 samples";
    refused("--time 1s --integrator paper --set render.paper.subpixels=3", 3, cells);
    refused("--preview a.jpg", 3, "the preview `a.jpg` is not a .png file");
    refused("--preview nowhere/a.png", 4, "nowhere` does not exist");
    refused("--tev 127.0.0.1", 3, "cannot reach tev at `127.0.0.1`");
    assert_eq!(desk.names(), ["scene.toml"]);
}

#[test]
fn a_render_ends_with_its_time_and_has_whole_blocks() {
    let desk = Desk::new(SCENE);
    let said =
        desk.run("render scene.toml -o a.png --accel native --time 200ms --json").succeeds().json();
    let samples = said["samples"].as_u64().expect("a number");
    assert!(samples >= 16 * 16 * 12 && samples % 16 == 0, "{samples}");
    assert_eq!(said["complete"], true);
    // What a number of samples ends first has no need of the time.
    let said =
        desk.run("render scene.toml -o a.png --accel native --time 1h --spp 3 --json").succeeds();
    assert_eq!(said.json()["samples"], 3 * 16 * 12);
}

#[test]
fn a_render_that_goes_on_has_what_is_left_of_its_time() {
    let desk = Desk::new(SCENE);
    let render = "render scene.toml -o a.png --accel native --checkpoint a.state --json --quiet";
    let said = desk.run(&format!("{render} --time 150ms")).succeeds().json();
    let samples = said["samples"].as_u64().expect("a number");
    // All of it was taken, so nothing is left to do.
    for again in ["resume a.state --json --quiet", &format!("{render} --time 100ms")] {
        let said = desk.run(again).succeeds().json();
        let [new, all] = ["samples", "samples_in_all"].map(|name| said[name].as_u64());
        assert_eq!((new, all), (Some(0), Some(samples)), "{again}");
        assert_eq!(said["complete"], true);
    }
    // Of a longer time, most is left: it renders until it is stopped.
    let command = format!("{render} --time 24h --checkpoint-every 5ms");
    let child = desk.command(&command).stdout(Stdio::piped()).spawn().expect("it starts");
    let before = desk.read("a.state");
    wait_until("more samples", || desk.read("a.state") != before);
    send("INT", child.id());
    let output = child.wait_with_output().expect("it ends");
    assert_eq!(output.status.code(), Some(130));
    let said: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
    assert!(said["samples"].as_u64().is_some_and(|more| more > 0), "{said}");
    // A number of samples takes the place of the time.
    let most = said["samples_in_all"].as_u64().expect("a number") / (16 * 12) + 32;
    let said = desk.run(&format!("resume a.state --extend-to {most} --json")).succeeds().json();
    assert_eq!(said["samples_in_all"].as_u64(), Some(most * 16 * 12));
}

#[test]
fn samples_are_added_to_a_picture_that_met_its_noise_target() {
    let scene = WIDE.iter().fold(SCENE.to_owned(), |text, (from, to)| text.replacen(from, to, 1));
    let desk = Desk::new(&scene);
    let render = "render scene.toml --accel native --no-run-figures --quiet";
    desk.run(&format!("{render} --noise 3.25% -o a.exr --checkpoint a.state")).succeeds();
    let said = desk.run("info a.exr --json").succeeds().json();
    assert!(said["counts"].is_array(), "{said}");
    desk.run("resume a.state --extend-to 16").fails(3, &["more than the 16 that are requested"]);
    desk.run("resume a.state --extend-to 1040").succeeds();
    desk.run(&format!("{render} --spp 1040 -o b.exr")).succeeds();
    assert!(desk.read("a.exr") == desk.read("b.exr"));
}

#[test]
fn a_preview_is_a_whole_picture_at_any_time_and_the_last_one_is_the_picture() {
    let desk = Desk::new(SCENE);
    // Depth needs alpha summed, which the picture does not show.
    let render = "render scene.toml -o a.png -o a.exr --layers depth --accel native \
                  --preview p.png --preview-every 1ms";
    let mut child =
        desk.command(&format!("{render} --spp 100000000 --quiet")).spawn().expect("it starts");
    let mut seen = Vec::new();
    wait_until("three previews", || {
        assert!(child.try_wait().expect("it runs").is_none(), "it ended by itself");
        let Ok(bytes) = fs::read(desk.path().join("p.png")) else { return false };
        let picture = image::load_from_memory(&bytes).expect("never half a picture");
        assert_eq!(picture.dimensions(), (16, 12));
        assert_eq!(picture.color(), image::ColorType::Rgb8);
        if !seen.contains(&bytes) {
            seen.push(bytes);
        }
        seen.len() == 3
    });
    send("INT", child.id());
    assert_eq!(child.wait().expect("it ends").code(), Some(130));
    let pixels =
        |name: &str| image::load_from_memory(&desk.read(name)).expect("a picture").into_rgb8();
    assert_eq!(pixels("p.png"), pixels("a.png"));
    assert_eq!(desk.names(), ["a.exr", "a.png", "p.png", "scene.toml"]);
}

/// What tev is told: the name and the pixels of one picture.
#[derive(Default)]
struct Shown {
    name: String,
    size: [usize; 2],
    pixels: Vec<f32>,
    updates: usize,
}

/// Takes what a program sends to tev, until it goes away. Names and numbers are those of tev's own
/// protocol: a packet is its length, its kind, and then its fields, all little-endian.
fn tev(stream: &mut TcpStream) -> Shown {
    let mut shown = Shown::default();
    let mut length = [0; 4];
    while stream.read_exact(&mut length).is_ok() {
        let mut bytes = vec![0; u32::from_le_bytes(length) as usize - 4];
        stream.read_exact(&mut bytes).expect("a whole packet");
        let mut packet = Packet(&bytes);
        match (packet.byte(), packet.byte()) {
            (4, 1) => {
                shown.name = packet.text();
                shown.size = [packet.number(), packet.number()];
                shown.pixels = vec![0.0; 3 * shown.size[0] * shown.size[1]];
                let channels: Vec<String> = (0..packet.number()).map(|_| packet.text()).collect();
                assert_eq!(channels, ["R", "G", "B"]);
            }
            (6, 0) => {
                assert_eq!((packet.text(), packet.number()), (shown.name.clone(), 3));
                (0..3).for_each(|_| drop(packet.text()));
                let [x, y, width, height] = std::array::from_fn(|_| packet.number());
                let layout: [u64; 6] = std::array::from_fn(|_| packet.wide());
                assert_eq!((x, width, layout), (0, shown.size[0], [0, 1, 2, 3, 3, 3]));
                let rows = 3 * width * y..3 * width * (y + height);
                shown.pixels[rows].fill_with(|| f32::from_bits(packet.number() as u32));
                shown.updates += 1;
            }
            other => panic!("tev knows no {other:?}"),
        }
        assert!(packet.0.is_empty());
    }
    shown
}

struct Packet<'a>(&'a [u8]);

impl Packet<'_> {
    fn take<const N: usize>(&mut self) -> [u8; N] {
        let (taken, rest) = self.0.split_first_chunk().expect("as much as was announced");
        self.0 = rest;
        *taken
    }

    fn byte(&mut self) -> u8 {
        self.take::<1>()[0]
    }

    fn number(&mut self) -> usize {
        u32::from_le_bytes(self.take()) as usize
    }

    fn wide(&mut self) -> u64 {
        u64::from_le_bytes(self.take())
    }

    fn text(&mut self) -> String {
        let bytes: Vec<u8> =
            std::iter::from_fn(|| Some(self.byte()).filter(|byte| *byte != 0)).collect();
        String::from_utf8(bytes).expect("text")
    }
}

/// Times of renders, in order: on a busy machine, nothing may happen in a short one.
const TIMES: [&str; 4] = ["500ms", "5s", "60s", "600s"];

#[test]
fn tev_sees_the_picture_grow_and_in_the_end_all_of_it() {
    let desk = Desk::new(SCENE);
    let shown = |time: &str| {
        let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
        let port = listener.local_addr().expect("an address").port();
        let viewer = thread::spawn(move || tev(&mut listener.accept().expect("a program").0));
        let options = format!("--preview-every 1ms --time {time} --quiet");
        desk.run(&format!(
            "render scene.toml -o a.pfm --accel native --tev 127.0.0.1:{port} {options}"
        ))
        .succeeds();
        viewer.join().expect("it understood all packets")
    };
    let shown = TIMES.into_iter().map(shown).find(|shown| shown.updates > 1);
    let shown = shown.expect("more than the last picture");
    assert_eq!((shown.name.as_str(), shown.size), ("a.pfm", [16, 12]));
    // The last one is the picture; PFM begins with the lowest row.
    let file = desk.read("a.pfm");
    let floats = file[file.len() - 4 * 3 * 16 * 12..].chunks_exact(4);
    let rows: Vec<f32> =
        floats.map(|bytes| f32::from_le_bytes(bytes.try_into().expect("four"))).collect();
    let expected: Vec<f32> = rows.chunks(3 * 16).rev().flatten().copied().collect();
    assert_eq!(shown.pixels, expected);
}

#[test]
fn a_tev_that_goes_away_is_told_of_once_and_changes_nothing() {
    let desk = Desk::new(SCENE);
    let warnings = |time: &str| {
        let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
        let port = listener.local_addr().expect("an address").port();
        let viewer = thread::spawn(move || drop(listener.accept()));
        let options = format!("--preview-every 1ms --time {time} --tev 127.0.0.1:{port} --quiet");
        let render = format!("render scene.toml -o a.pfm --accel native {options}");
        let done = desk.run(&render).succeeds();
        viewer.join().expect("it went away");
        done.stderr.matches("warning: tev no longer accepts the picture").count()
    };
    // What is sent first may still reach the buffers of the system.
    assert_eq!(TIMES.into_iter().map(warnings).find(|warnings| *warnings > 0), Some(1));
    assert_eq!(desk.names(), ["a.pfm", "scene.toml"]);
}

#[test]
fn a_render_goes_on_without_a_tev_that_is_gone() {
    let desk = Desk::new(SCENE);
    let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
    let port = listener.local_addr().expect("an address").port();
    let viewer = thread::spawn(move || tev(&mut listener.accept().expect("a program").0));
    let kept = format!("--checkpoint a.state --tev 127.0.0.1:{port} --quiet");
    desk.run(&format!("render scene.toml -o a.pfm --accel native {kept}")).succeeds();
    viewer.join().expect("it understood all packets");
    // A checkpoint does not say whom to call.
    assert_eq!(desk.run("resume a.state --extend-to 16 --quiet").succeeds().stderr, "");
    let again = desk.run(&format!("resume a.state --extend-to 32 --tev 127.0.0.1:{port}"));
    let again = again.succeeds();
    let warning = format!("warning: cannot reach tev at `127.0.0.1:{port}`");
    assert!(again.stderr.starts_with(&warning), "{}", again.stderr);
    assert!(again.stderr.contains("; continuing without it"), "{}", again.stderr);
    // The command itself still means what it says.
    let words = ["cannot reach tev", "help: start tev first"];
    desk.run(&format!("render scene.toml -o b.pfm --tev 127.0.0.1:{port}")).fails(3, &words);
}

/// A viewer that takes nothing any more: the picture is saved before it is waited for, and the
/// program ends all the same.
#[test]
fn a_tev_that_hangs_keeps_nothing_from_being_saved() {
    let large = SCENE.replace("width = 16", "width = 1600").replace("height = 12", "height = 1200");
    let desk = Desk::new(&large);
    let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
    let port = listener.local_addr().expect("an address").port();
    // More than sockets buffer: the last packet cannot have been sent.
    let options = format!("--spp 1 --integrator normals --tev 127.0.0.1:{port} --quiet");
    let mut child = desk
        .command(&format!("render scene.toml -o a.pfm --accel native {options}"))
        .stderr(Stdio::piped())
        .spawn()
        .expect("it starts");
    let viewer = listener.accept().expect("a program");
    while !desk.path().join("a.pfm").exists() {
        assert!(child.try_wait().expect("it runs").is_none(), "it ended without a picture");
        thread::sleep(Duration::from_millis(5));
    }
    let output = child.wait_with_output().expect("it ends");
    let told = String::from_utf8_lossy(&output.stderr);
    assert!(told.contains("warning: tev no longer accepts the picture"), "{told}");
    assert_eq!(output.status.code(), Some(0));
    drop(viewer);
}

#[test]
fn another_noise_target_is_not_gone_on_with_unless_it_asks_for_more() {
    let desk = Desk::new(SCENE);
    let render = |noise: &str, file: &str, keep: &str| {
        format!(
            "render scene.toml --accel native --no-run-figures --quiet -o {file} {keep} {noise}"
        )
    };
    let kept = "--checkpoint kept.state";
    desk.run(&render("--noise 3%", "a.exr", kept)).succeeds();
    let words = ["cannot resume `kept.state`: its noise target was 0.03", "more samples than 0.2"];
    desk.run(&render("--noise 20%", "a.exr", kept)).fails(3, &words);
    desk.run(&render("--noise 2%", "a.exr", kept)).succeeds();
    desk.run(&render("--noise 2%", "b.exr", "")).succeeds();
    assert!(desk.read("a.exr") == desk.read("b.exr"));
}

#[test]
fn parts_with_noise_targets_must_be_of_one_kind_and_of_whole_squares() {
    let scene = WIDE.iter().fold(SCENE.to_owned(), |text, (from, to)| text.replacen(from, to, 1));
    let desk = Desk::new(&scene);
    let render = |options: &str| {
        desk.run(&format!("render scene.toml --accel native --quiet {options}")).succeeds();
    };
    render("--noise 15% --crop 0,0,16,16 -o a.part");
    render("--noise 25% --crop 16,0,32,16 -o b.part");
    let words =
        ["are not parts of the same picture", "the noise target is 0.15 for 0.95", "not 0.25"];
    desk.run("merge a.part b.part -o sum.exr").fails(3, &words);
    render("--noise 15% --crop 0,0,24,16 -o c.part");
    render("--noise 15% --crop 24,0,32,16 -o d.part");
    let words =
        ["`c.part` has a noise target, and its window 0,0,24,16 cuts tiles of 16 x 16 pixels"];
    desk.run("merge c.part d.part -o sum.exr").fails(3, &words);
}

#[test]
fn a_part_that_ended_early_cannot_be_followed() {
    let desk = Desk::new(SCENE);
    let render = "render scene.toml --accel native --quiet --spp 100000032";
    desk.run(&format!("{render} --samples 0..100000000 --time 50ms -o a.part")).succeeds();
    desk.run(&format!("{render} --samples 100000000..100000032 -o b.part")).succeeds();
    let words = ["`a.part` ended at sample", "of 100000000, so `b.part` cannot continue it"];
    desk.run("merge a.part b.part -o sum.exr").fails(3, &words);
    desk.run("merge b.part a.part -o sum.part --allow-gaps").fails(3, &words);
    assert_eq!(desk.names(), ["a.part", "b.part", "scene.toml"]);
}

/// Also where the threads that render are so slow to stop that they are left behind.
#[test]
fn a_time_that_is_up_before_the_noise_target_is_met_is_told() {
    let desk = Desk::of_many_spheres();
    let command = "render scene.toml --accel brute-force --threads 1 --noise 0.01% --time 100ms \
                   -o a.png --checkpoint a.state --preview b.png --json --quiet";
    let done = desk.run(command);
    assert_eq!(done.code, Some(1), "{}", done.stderr);
    assert!(done.stderr.contains("is not met in 1 of 1 tiles"), "{}", done.stderr);
    assert_eq!(done.json()["complete"], true);
    assert_eq!(desk.names(), ["a.png", "a.state", "b.png", "many.f32", "scene.toml"]);
    let said = desk.run("info a.state --json").succeeds().json();
    assert_eq!(said["ended"], true);
    assert!(said["missed"].as_str().is_some_and(|missed| missed.contains("not met")), "{said}");
}
