//! Files that cannot be read or written.

use std::fs;

use crate::desk::{Desk, SCENE};

#[test]
fn a_scene_that_cannot_be_read_is_a_file_error() {
    let desk = Desk::new(SCENE);
    let message = "error: cannot read the scene `missing.toml`: No such file or directory";
    let commands = ["render missing.toml -o a.png", "info missing.toml", "bench missing.toml"];
    for command in commands.into_iter().chain(["crosscheck missing.toml"]) {
        desk.run(command).fails(4, &[message]);
    }
    fs::create_dir(desk.path().join("folder.toml")).expect("a folder");
    desk.run("info folder.toml").fails(4, &["cannot read the scene `folder.toml`: it is a folder"]);
    fs::write(desk.path().join("bytes.toml"), [0xff, 0xfe]).expect("a file");
    desk.run("info bytes.toml").fails(4, &["`bytes.toml`: it is not UTF-8 text"]);
}

#[test]
fn the_place_of_the_picture_is_checked_before_anything_else() {
    let desk = Desk::new(SCENE);
    fs::create_dir(desk.path().join("folder")).expect("a folder");
    fs::create_dir(desk.path().join("folder.png")).expect("a folder");
    let refused = |output: &str, code: i32, parts: &[&str]| {
        desk.run(&format!("render missing.toml -o {output}")).fails(code, parts);
    };
    let missing =
        "error: cannot write `no/a.png`: the folder `no` does not exist\n  help: create it";
    refused("no/a.png", 4, &[missing]);
    refused("folder.png", 4, &["error: cannot write `folder.png`: it is a folder"]);
    refused("folder", 4, &["it is a folder", "help: name a file in it", "folder/picture.png"]);
    refused("scene.toml/a.png", 4, &["nothing can be created in `scene.toml` (Not a dir"]);
    refused("out.bmp", 3, &["error: `out.bmp` does not end in .png, .exr, .hdr or .pfm\n"]);
    refused("out", 3, &["does not end in", "help: the extension chooses the format"]);
    if cfg!(target_os = "linux") {
        let message = "cannot write `/proc/a.png`: nothing can be created in `/proc` (No such \
                           file or directory (os error 2))\n";
        refused("/proc/a.png", 4, &[message]);
        refused("/dev/null", 3, &["`/dev/null` does not end in .png"]);
    }
    assert_eq!(desk.names(), ["folder", "folder.png", "scene.toml"]);
}

#[test]
fn a_dump_that_cannot_be_written_is_a_file_error() {
    let desk = Desk::new(SCENE);
    desk.run("crosscheck scene.toml --accel native --rays 30 --dump no/rays.txt")
        .fails(4, &["error: cannot write `no/rays.txt`: No such file or directory"]);
}

#[cfg(unix)]
#[test]
fn pictures_keep_their_permissions_and_protected_ones_are_refused_first() {
    use std::os::unix::fs::PermissionsExt;
    let desk = Desk::new(SCENE);
    let path = desk.path().join("a.png");
    let set = |mode| fs::set_permissions(&path, fs::Permissions::from_mode(mode)).expect("set");
    fs::write(&path, "old").expect("a file");
    set(0o444);
    let words = ["error: cannot write `a.png`: ", "help: make it writable, or name another file"];
    desk.run("render missing.toml -o a.png").fails(4, &words);
    assert_eq!(desk.read("a.png"), b"old");
    set(0o660);
    desk.run("render scene.toml -o a.png --quiet").succeeds();
    let mode = fs::metadata(&path).expect("it is there").permissions().mode() & 0o777;
    assert!(mode == 0o660 && desk.read("a.png") != b"old", "{mode:o}");
}

/// Tables are looked for beside the link first, then beside the file that it leads to.
#[cfg(unix)]
#[test]
fn a_linked_scene_finds_the_tables_of_both_folders() {
    let table = "[[sphere_tables]]\nfile = \"t/a.f32\"\nmaterial = \"grass\"\n\
                 columns = [\"x\", \"y\", \"z\", \"radius\"]\n[render]";
    let desk = Desk::empty();
    let at = |name: &str| desk.path().join(name);
    let write = |name: &str, columns: &[f32]| {
        let row = |&x: &f32| [x, 2.5, 0.0, 0.5].map(f32::to_le_bytes).concat();
        fs::create_dir_all(at(name).parent().expect("a folder")).expect("a folder");
        fs::write(at(name), columns.iter().flat_map(row).collect::<Vec<_>>()).expect("a table");
    };
    write("real/t/a.f32", &[1.5]);
    fs::write(at("real/scene.toml"), SCENE.replace("[render]", table)).expect("a scene");
    fs::create_dir(at("here")).expect("a folder");
    std::os::unix::fs::symlink("../real/scene.toml", at("here/link.toml")).expect("a link");
    let rows = || {
        let info = desk.run("info here/link.toml --json").succeeds().json();
        info["spheres"].as_u64()
    };
    assert_eq!(rows(), Some(3));
    desk.run("render here/link.toml -o real.png --accel native --quiet").succeeds();
    desk.run("reproduce real.png --quiet").succeeds();
    write("here/t/a.f32", &[1.5, 4.0]);
    assert_eq!(rows(), Some(4));
    desk.run("render here/link.toml -o here.png --accel native --quiet").succeeds();
    desk.run("reproduce here.png --quiet").succeeds();
}
