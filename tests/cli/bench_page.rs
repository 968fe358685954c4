//! `photosphere bench` as a drawing and as a page.

use std::fs;

use serde_json::Value;

use crate::desk::{Desk, Outcome};

fn is_positive(value: &Value) -> bool {
    value.as_f64().is_some_and(|value| value > 0.0)
}

#[test]
fn a_scene_is_drawn_and_the_suite_makes_a_page() {
    let desk = Desk::empty();
    let read = |name: &str| fs::read_to_string(desk.path().join(name)).expect("the file is there");
    desk.run("generate gas -n 300 -o t.f32 --scene s.toml").succeeds();
    let few = "--accel native --accel brute-force --rounds 1";
    let small = "--set image.width=32 --set image.height=24";
    desk.run(&format!("bench s.toml {small} {few} --svg bars.svg")).succeeds();
    let svg = read("bars.svg");
    for text in ["s.toml", "camera rays, closest hit", "native", "brute-force", "M rays/s"] {
        assert!(svg.contains(text), "{text}");
    }
    let suite = desk.run(&format!("bench --suite page.html --largest 100 {few} --json"));
    let suite = suite.succeeds().json();
    // Four arrangements of 3 and of 100 spheres.
    assert_eq!(suite.as_array().map(Vec::len), Some(8));
    assert_eq!(suite[7]["arrangement"], "lattice");
    assert_eq!(suite[7]["measured"]["spheres"], 100);
    let page = read("page.html");
    for text in ["<h2>gas</h2>", "<h2>clusters</h2>", "second bounce rays, occluded", "<svg"] {
        assert!(page.contains(text), "{text}");
    }
}

#[test]
fn batches_threads_and_whole_renders_are_compared() {
    let desk = Desk::empty();
    desk.run("generate packed -n 500 -o t.f32 --scene s.toml").succeeds();
    let bench = "bench s.toml --set image.width=16 --set image.height=12 --threads 2 --rounds 1 \
                 --set render.samples_per_pixel=2 --accel native --accel brute-force --builds 2 \
                 --batch 64,1 --scaling --render --stages";
    let text = desk.run(bench).succeeds().stdout;
    let parts = ["64 rays a call", "1 ray a call", "1 thread;", "2 threads;", "pure arithmetic"];
    for part in parts.into_iter().chain(["sorting by surface", "by the scalar code"]) {
        assert!(text.contains(part), "{part}: {text}");
    }
    let found = desk.run(&format!("{bench} --json")).succeeds().json();
    let settings = |key: &str, which: &str| -> Vec<u64> {
        let all = found[key].as_array().expect("a list");
        all.iter().filter_map(|one| one[which].as_u64()).collect()
    };
    assert_eq!(settings("batches", "batch"), [64, 1]);
    assert_eq!(settings("scaling", "threads"), [1, 2]);
    let swept = &found["scaling"][1];
    for accel in ["native", "brute-force"] {
        assert!(is_positive(&swept["second_bounce"][accel]["occluded"]["rays_per_s"]), "{swept}");
    }
    assert!(is_positive(&swept["arithmetic_passes_per_s"]), "{swept}");
    for render in found["renders"].as_array().expect("a list") {
        assert_eq!(render["samples"], 16 * 12 * 2);
        assert_eq!(render["differing_pixels"], 0);
        assert!(is_positive(&render["seconds"]), "{render}");
        assert!(render["intersector_fraction"].as_f64().is_some_and(|f| f < 1.0), "{render}");
    }
    for stages in found["stages"].as_array().expect("a list") {
        assert!(is_positive(&stages["ns_per_vertex"]["closest_hits"]), "{stages}");
        assert!(is_positive(&stages["ns_per_vertex_outside_intersector"]), "{stages}");
        assert!(stages["vertices"].as_u64().is_some_and(|count| count > 0), "{stages}");
        assert_eq!(stages["scalar_vertices"], 0);
    }
}

#[test]
fn nothing_is_left_where_something_is_missing() {
    let desk = Desk::empty();
    for words in ["bench missing.toml --svg a.svg", "bench --suite no/such/page.html --largest 3"] {
        let Outcome { code, stderr, .. } = desk.run(words);
        assert!(code != Some(0) && stderr.starts_with("error:"), "{words}: {stderr}");
        assert!(desk.names().is_empty(), "{words}");
    }
    for (words, ending) in [("bench s.toml --svg a.png", "svg"), ("bench --suite a.svg", "html")] {
        let Outcome { code, stderr, .. } = desk.run(words);
        assert_eq!(code, Some(3), "{words}: {stderr}");
        assert!(stderr.contains(&format!("does not end in .{ending}")), "{words}: {stderr}");
    }
    desk.run("bench --suite page.html --largest 100 --memory-limit 1MB").succeeds();
    let page = fs::read_to_string(desk.path().join("page.html")).expect("an empty page");
    assert!(!page.contains("<svg"), "nothing fits into a megabyte");
}

#[test]
fn bench_wants_a_scene_or_the_suite_and_not_both() {
    let desk = Desk::empty();
    for words in [
        "bench",
        "bench s.toml --suite p.html",
        "bench s.toml --largest 5",
        "bench s.toml --batch 0",
        "bench s.toml --batch 1,many",
        "bench --suite p.html --svg a.svg",
        "bench --suite p.html --render",
        "bench s.toml --stages",
    ] {
        assert_eq!(desk.run(words).code, Some(2), "{words}");
    }
}
