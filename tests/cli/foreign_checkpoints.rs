//! Checkpoints of strangers: they say what to render, and never where to write or whom to call.

use std::fs;
use std::net::TcpListener;

use serde_json::{Value, json};

use crate::desk::{Desk, SCENE, outcome};

/// A checkpoint with another header, and its hashes as they must be.
fn with_header(checkpoint: &[u8], change: impl FnOnce(&mut Value)) -> Vec<u8> {
    let length = u32::from_le_bytes(checkpoint[12..16].try_into().expect("four bytes")) as usize;
    let mut header = serde_json::from_slice(&checkpoint[16..16 + length]).expect("JSON");
    change(&mut header);
    let header = header.to_string();
    let mut bytes = checkpoint[..12].to_vec();
    bytes.extend((header.len() as u32).to_le_bytes());
    bytes.extend(header.as_bytes());
    bytes.extend(blake3::hash(&bytes).as_bytes());
    bytes.extend(&checkpoint[16 + length + 32..checkpoint.len() - 32]);
    bytes.extend(blake3::hash(&bytes).as_bytes());
    bytes
}

/// A folder with a finished checkpoint of 16 samples in `kept`.
fn desk() -> Desk {
    let desk = Desk::new(SCENE);
    fs::create_dir(desk.path().join("kept")).expect("a folder");
    let kept = "--checkpoint kept/a.state --preview kept/p.png";
    desk.run(&format!("render scene.toml -o kept/a.pfm --spp 16 --quiet {kept}")).succeeds();
    desk
}

fn mislead(desk: &Desk, change: impl FnOnce(&mut Value)) {
    let path = desk.path().join("kept/a.state");
    let bytes = with_header(&fs::read(&path).expect("a checkpoint"), change);
    fs::write(path, bytes).expect("written");
}

#[test]
fn a_folder_with_a_checkpoint_and_its_pictures_can_be_moved() {
    let desk = desk();
    fs::rename(desk.path().join("kept"), desk.path().join("moved")).expect("renamed");
    for name in ["moved/a.pfm", "moved/p.png"] {
        fs::remove_file(desk.path().join(name)).expect("it was there");
    }
    let told = desk.run("resume moved/a.state --extend-to 32").succeeds().stderr;
    assert!(told.contains("wrote moved/a.pfm"), "{told}");
    assert!(desk.path().join("moved/p.png").exists());
    assert!(!desk.path().join("kept").exists());
}

#[test]
fn a_picture_outside_the_folder_of_its_checkpoint_must_be_named() {
    let desk = Desk::new(SCENE);
    fs::create_dir(desk.path().join("kept")).expect("a folder");
    // The user's own command: repeated, it goes on; `resume` asks.
    let render = "render scene.toml -o a.pfm --quiet --checkpoint kept/a.state";
    desk.run(&format!("{render} --spp 16")).succeeds();
    desk.run(&format!("{render} --spp 32")).succeeds();
    fs::remove_file(desk.path().join("a.pfm")).expect("it was there");
    let folder = desk.path().canonicalize().expect("it is there");
    let file = folder.join("a.pfm").display().to_string();
    let command = format!("photosphere resume 'kept/a.state' -o '{file}'");
    let words = format!("`kept/a.state` names a picture outside its folder: `{file}`");
    desk.run("resume kept/a.state").fails(3, &[&words, &command]);
    assert!(!desk.path().join("a.pfm").exists());
    desk.run(&format!("resume kept/a.state -o {file} --extend-to 48")).succeeds();
    assert!(desk.path().join("a.pfm").exists());
}

#[test]
fn a_checkpoint_cannot_choose_what_is_written() {
    let outside = |file: &str| {
        let desk = desk();
        let name = file.replace("FOLDER", &desk.path().display().to_string());
        mislead(&desk, |header| header["output"]["files"] = json!([name]));
        desk.run("resume kept/a.state --extend-to 32").fails(3, &["names a picture outside"]);
        assert!(!desk.path().join("b.pfm").exists(), "{file}");
        // What the user names is written.
        desk.run("resume kept/a.state --extend-to 32 -o c.pfm --quiet").succeeds();
        assert!(desk.path().join("c.pfm").exists() && !desk.path().join("b.pfm").exists());
    };
    outside("FOLDER/b.pfm");
    outside("../b.pfm");
    outside("../kept/../b.pfm");
    outside("missing/../../b.pfm");

    // Through a link in its folder, and for the preview, which is left out.
    let desk = desk();
    std::os::unix::fs::symlink("..", desk.path().join("kept/up")).expect("a link");
    mislead(&desk, |header| header["output"]["files"] = json!(["up/b.pfm"]));
    desk.run("resume kept/a.state --extend-to 32").fails(3, &["names a picture outside"]);
    mislead(&desk, |header| {
        header["output"]["files"] = json!(["a.pfm"]);
        header["output"]["preview"] = json!("../q.png");
    });
    let told = desk.run("resume kept/a.state --extend-to 32").succeeds().stderr;
    assert!(told.contains("q.png` is outside the checkpoint's folder"), "{told}");
    assert!(!desk.path().join("q.png").exists());
    desk.run("resume kept/a.state --extend-to 48 --quiet --preview q.png").succeeds();
    assert!(desk.path().join("q.png").exists());
}

#[test]
fn a_checkpoint_calls_nobody_and_reads_ordinary_files() {
    let desk = desk();
    let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
    listener.set_nonblocking(true).expect("it can be asked");
    let viewer = listener.local_addr().expect("an address").to_string();
    mislead(&desk, |header| {
        header["output"]["tev"] = json!(viewer);
        header["job"]["threads"] = json!(1_000_000_000);
    });
    let told = desk.run("resume kept/a.state --extend-to 32").succeeds().stderr;
    assert!(told.contains(&format!("name it: --tev '{viewer}'")), "{told}");
    let called = listener.accept().map(|_| ()).map_err(|e| e.kind());
    assert_eq!(called, Err(std::io::ErrorKind::WouldBlock));

    mislead(&desk, |header| header["source"]["file"] = json!("/dev/zero"));
    let words = ["cannot read the scene `/dev/zero`: it is not a regular file", "--scene FILE"];
    desk.run("resume kept/a.state").fails(4, &words);
}

#[test]
fn a_scene_that_has_moved_is_named_and_must_be_the_same() {
    let desk = desk();
    fs::create_dir(desk.path().join("new")).expect("a folder");
    fs::rename(desk.path().join("scene.toml"), desk.path().join("new/moved.toml")).expect("moved");
    let words = ["scene.toml`: No such file", "if it is elsewhere: --scene FILE"];
    desk.run("resume kept/a.state").fails(4, &words);
    desk.run("resume kept/a.state --extend-to 32 --scene new/moved.toml").succeeds();
    // From now on it is known there, from any folder.
    let mut again = desk.command("resume a.state --extend-to 48");
    outcome(again.current_dir(desk.path().join("kept"))).succeeds();
    let other = SCENE.replace("0.2, 0.6, 0.2", "0.3, 0.6, 0.2");
    fs::write(desk.path().join("other.toml"), other).expect("a scene");
    desk.run("resume kept/a.state --extend-to 64 --scene other.toml")
        .fails(3, &["it belongs to another render: `materials.grass.albedo` is"]);
}

#[cfg(unix)]
#[test]
fn the_scene_that_a_part_names_is_a_regular_file() {
    let desk = desk();
    mislead(&desk, |header| header["source"]["file"] = json!("/dev/zero"));
    let merge = "merge kept/a.state -o a.exr --layers sphere_id";
    desk.run(merge).fails(4, &["cannot read the scene `/dev/zero`: it is not a regular file"]);
}
