//! `photosphere bench` as a drawing and as a page.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

fn photosphere(folder: &Path, words: &str) -> Output {
    let program = env!("CARGO_BIN_EXE_photosphere");
    let run = Command::new(program).args(words.split_whitespace()).current_dir(folder).output();
    run.expect("the program starts")
}

fn succeed(folder: &Path, words: &str) {
    let output = photosphere(folder, words);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

#[test]
fn a_scene_is_drawn_and_the_suite_makes_a_page() {
    let desk = tempfile::tempdir().expect("a folder");
    let read = |name: &str| fs::read_to_string(desk.path().join(name)).expect("the file is there");
    succeed(desk.path(), "generate gas -n 300 -o t.f32 --scene s.toml");
    let few = "--accel native --accel brute-force --rounds 1";
    let small = "--set image.width=32 --set image.height=24";
    succeed(desk.path(), &format!("bench s.toml {small} {few} --svg bars.svg"));
    let svg = read("bars.svg");
    for text in ["s.toml", "camera rays, closest hit", "native", "brute-force", "M rays/s"] {
        assert!(svg.contains(text), "{text}");
    }
    succeed(desk.path(), &format!("bench --suite page.html --largest 100 {few}"));
    let page = read("page.html");
    for text in ["<h2>gas</h2>", "<h2>clusters</h2>", "second bounce rays, occluded", "<svg"] {
        assert!(page.contains(text), "{text}");
    }
}

#[test]
fn bench_wants_a_scene_or_the_suite_and_not_both() {
    let desk = tempfile::tempdir().expect("a folder");
    for words in ["bench", "bench s.toml --suite p.html", "bench s.toml --largest 5"] {
        assert_eq!(photosphere(desk.path(), words).status.code(), Some(2), "{words}");
    }
}
