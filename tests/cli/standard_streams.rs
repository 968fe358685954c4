//! Scenes from the standard input, and pictures to the standard output or to nowhere.

use std::fs::{self, File};
use std::io::Write;
use std::process::{Command, Output};

use crate::desk::{Desk, PROGRAM, SCENE};

/// The program with the scene as its standard input.
fn piped(desk: &Desk, arguments: &str) -> Output {
    let scene = File::open(desk.path().join("scene.toml")).expect("the scene");
    desk.command(arguments).stdin(scene).output().expect("the program starts")
}

#[test]
fn a_scene_and_its_picture_go_through_pipes_without_a_changed_bit() {
    let desk = Desk::new(SCENE);
    let options = "--accel native --no-run-figures --quiet";
    for format in ["exr", "png", "hdr", "pfm"] {
        desk.run(&format!("render scene.toml -o a.{format} {options}")).succeeds();
        let done = piped(&desk, &format!("render - -o - --format {format} {options}"));
        assert_eq!(done.status.code(), Some(0), "{}", String::from_utf8_lossy(&done.stderr));
        assert!(done.stdout == desk.read(&format!("a.{format}")), "{format}");
    }
    let done = piped(&desk, "render - -o - -o b.png --accel native --no-run-figures");
    assert!(done.stdout == desk.read("a.png") && desk.read("b.png") == desk.read("a.png"));
    let told = String::from_utf8_lossy(&done.stderr).into_owned();
    assert!(told.contains("wrote the standard output and b.png"), "{told}");

    // Mistakes in the scene have their place there.
    let wrong = SCENE.replacen("material = \"grass\"", "material = \"gras\"", 1);
    fs::write(desk.path().join("scene.toml"), wrong).expect("a scene");
    let told = piped(&desk, "render - -o none");
    let told = String::from_utf8_lossy(&told.stderr).into_owned();
    assert!(told.contains("standard input:"), "{told}");
}

#[test]
fn particles_in_place_of_a_scene_are_recognised() {
    let desk = Desk::new("2\n\nO 0 0 0\nH 1 0 0\n");
    let told = piped(&desk, "render - -o none");
    let told = String::from_utf8_lossy(&told.stderr).into_owned();
    assert!(told.contains("name its format: --input-format xyz"), "{told}");
    let size = "--size 16x12 --spp 1 --accel native";
    let done = piped(&desk, &format!("render - --input-format xyz -o none {size}"));
    assert_eq!(done.status.code(), Some(0), "{}", String::from_utf8_lossy(&done.stderr));
}

#[test]
fn a_picture_that_is_discarded_is_rendered_all_the_same() {
    let desk = Desk::new(SCENE);
    let done = desk.run("render scene.toml -o none --json --layers normal --exposure 1").succeeds();
    assert_eq!(done.json()["output"], "nothing");
    assert_eq!(done.json()["samples"], 16 * 12 * 4);
    assert_eq!(desk.names(), ["scene.toml"]);
    desk.run("render scene.toml -o a.part --quiet").succeeds();
    desk.run("merge a.part -o none").succeeds();
    assert_eq!(desk.names(), ["a.part", "scene.toml"]);
}

#[test]
fn streams_that_cannot_be_are_refused() {
    let desk = Desk::new(SCENE);
    let refused = |command: &str, words: &str| {
        desk.run(command).fails(3, &[words]);
    };
    let both = desk.run("render missing.toml -o - --json");
    assert_eq!(both.code, Some(3));
    let message = "`-o -` and `--json` both write to the standard output";
    assert_eq!(both.json()["error"]["message"], message);
    let message = "`--format` is for the standard output, `-o -`";
    refused("render missing.toml -o a.png --format exr", message);
    let message = "`-o none` discards the picture, and there are other files";
    refused("render missing.toml -o none -o a.png", message);
    refused("render missing.toml -o - -o -", "-o - and -o - are the same file");
    refused("render missing.toml -o - --layers normal", "`-` cannot hold the layer `normal`");
    refused("plan scene.toml --shards 2 -o -", "`-o -` names no file");
    refused("plan scene.toml --shards 2 -o none", "`-o none` names no file");
    let message = "a scene on the standard input cannot be read again, to resume its checkpoint";
    refused("render - -o a.png --checkpoint a.state", message);
    assert_eq!(desk.names(), ["scene.toml"]);
}

#[test]
fn no_picture_is_written_to_a_terminal() {
    let desk = Desk::new(SCENE);
    let command = format!("{PROGRAM} render missing.toml -o -");
    let script = Command::new("script")
        .args(["-qec", &command, "/dev/null"])
        .current_dir(desk.path())
        .output();
    let Ok(done) = script else {
        // Past the test harness, which would swallow it: a check left out must be seen.
        writeln!(std::io::stderr(), "SKIPPED: no script, so no terminal was tried").expect("told");
        return;
    };
    let told = String::from_utf8_lossy(&done.stdout).into_owned();
    assert!(told.contains("the standard output is a terminal"), "{told}");
}

/// A part of a scene that is in no file: it can be merged, and resumed by naming the scene.
#[test]
fn a_part_of_a_scene_from_a_pipe_is_resumed_by_naming_the_scene() {
    let desk = Desk::new(SCENE);
    assert_eq!(piped(&desk, "render - -o a.part --spp 16 --quiet").status.code(), Some(0));
    desk.run("merge a.part -o a.pfm").succeeds();
    desk.run("resume a.part --extend-to 32 -o b.pfm")
        .fails(3, &["the scene of `a.part` was not read from a file", "with --scene"]);
    desk.run("resume a.part --extend-to 32 --scene scene.toml -o b.pfm").succeeds();
    desk.run("render scene.toml --spp 32 -o c.pfm --quiet").succeeds();
    assert!(desk.read("b.pfm") == desk.read("c.pfm"));

    // A picture on the standard output is not a place for a later run.
    desk.command("render scene.toml -o - --checkpoint s.state").output().expect("it starts");
    desk.run("resume s.state").fails(3, &["`s.state` does not record where its picture goes"]);
}
