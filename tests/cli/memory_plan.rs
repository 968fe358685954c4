//! The memory plan: as it is told, as it is kept, and what is refused by it.

use std::path::Path;
use std::process::{Command, Output};

use photosphere::accel::Backend;
use serde_json::Value;
use tempfile::TempDir;

fn photosphere(folder: &Path, words: &str) -> Output {
    let program = env!("CARGO_BIN_EXE_photosphere");
    let run = Command::new(program).args(words.split_whitespace()).current_dir(folder).output();
    run.expect("the program starts")
}

fn json(folder: &Path, words: &str) -> Value {
    let output = photosphere(folder, words);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).expect("one JSON object")
}

/// A folder with `s.toml`, a generated scene.
fn desk(recipe: &str) -> TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    let made = photosphere(folder.path(), &format!("generate {recipe} -o t.f32 --scene s.toml"));
    assert!(made.status.success(), "{}", String::from_utf8_lossy(&made.stderr));
    folder
}

fn planned(info: &Value, accel: &str) -> f64 {
    let plans = info["memory_plan"].as_array().expect("a list");
    let plan = plans.iter().find(|plan| plan["accel"] == accel).expect("every intersector");
    plan["peak_bytes"].as_f64().expect("a number")
}

/// A million spheres: fewer would show the program's own memory more than the plan's.
#[test]
fn a_render_takes_what_was_planned_within_ten_percent() {
    for recipe in ["gas -n 1e6 --colors", "clusters -n 1e6"] {
        let desk = desk(recipe);
        let info = json(
            desk.path(),
            "info s.toml --set image.width=16 --set image.height=16 --json --threads 2",
        );
        for accel in Backend::AVAILABLE.iter().filter(|&&accel| accel != Backend::BruteForce) {
            let accel = accel.name();
            let render = "render s.toml -o x.png --size 16x16 --spp 1 --json --quiet --threads 2";
            let render = json(desk.path(), &format!("{render} --accel {accel}"));
            let measured = render["peak_rss_bytes"].as_f64().expect("Linux says it");
            let ratio = planned(&info, accel) / measured;
            assert!((0.9..1.1).contains(&ratio), "{recipe}, {accel}: {ratio} of {measured}");
        }
    }
}

#[test]
fn what_is_larger_than_the_limit_is_refused_with_the_cheaper_choice() {
    let desk = desk("gas -n 2e5 --colors");
    let info = json(desk.path(), "info s.toml --json");
    let peak = planned(&info, "native") as u64;
    let refused = |limit: u64| {
        let render =
            format!("render s.toml -o x.png --accel native --memory-limit {limit}B --quiet");
        let output = photosphere(desk.path(), &render);
        assert_eq!(output.status.code(), Some(3));
        assert!(!desk.path().join("x.png").exists());
        String::from_utf8_lossy(&output.stderr).into_owned()
    };
    let told = refused(peak - 1);
    assert!(told.contains("this would need ") && told.contains("more than the limit of"), "{told}");
    assert!(told.contains("help: --set sphere_tables.0.colors=packed would need "), "{told}");
    let told = refused(1 << 20);
    assert!(told.contains("nothing cheaper fits"), "{told}");
    // The cheaper choice is really taken.
    let packed = format!("--set sphere_tables.0.colors=packed --memory-limit {}B", peak - 1);
    let words = "render s.toml -o x.png --accel native --size 16x16 --spp 1 --quiet";
    let output = photosphere(desk.path(), &format!("{words} {packed}"));
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

#[test]
fn info_tells_the_plan_before_it_refuses() {
    let desk = desk("lattice -n 8e3");
    let output = photosphere(desk.path(), "info s.toml --memory-limit 1MiB");
    assert_eq!(output.status.code(), Some(3));
    let told = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(told.starts_with("memory plan of a render\n"), "{told}");
    assert!(!told.contains("giants"), "the scene was not loaded: {told}");
    let bench = photosphere(desk.path(), "bench s.toml --memory-limit 1MiB");
    assert_eq!(bench.status.code(), Some(3));
}
