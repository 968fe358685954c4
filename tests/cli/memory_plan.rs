//! The memory plan: as it is told, as it is kept, and what is refused by it.

use photosphere::accel::Backend;
use serde_json::Value;

use crate::desk::Desk;

/// A folder with `s.toml`, a generated scene.
fn desk(recipe: &str) -> Desk {
    let desk = Desk::empty();
    desk.run(&format!("generate {recipe} -o t.f32 --scene s.toml")).succeeds();
    desk
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
        let size = "--set image.width=16 --set image.height=16";
        let info = desk.run(&format!("info s.toml {size} --json --threads 2")).succeeds().json();
        for accel in Backend::AVAILABLE.iter().filter(|&&accel| accel != Backend::BruteForce) {
            let accel = accel.name();
            let render = "render s.toml -o x.png --size 16x16 --spp 1 --json --quiet --threads 2";
            let render = desk.run(&format!("{render} --accel {accel}")).succeeds().json();
            let measured = render["peak_rss_bytes"].as_f64().expect("Linux says it");
            let ratio = planned(&info, accel) / measured;
            assert!((0.9..1.1).contains(&ratio), "{recipe}, {accel}: {ratio} of {measured}");
        }
    }
}

#[test]
fn what_is_larger_than_the_limit_is_refused_with_the_cheaper_choice() {
    let desk = desk("gas -n 2e5 --colors");
    let info = desk.run("info s.toml --json").succeeds().json();
    let peak = planned(&info, "native") as u64;
    let refused = |limit: u64| {
        let render =
            format!("render s.toml -o x.png --accel native --memory-limit {limit}B --quiet");
        let outcome = desk.run(&render);
        assert_eq!(outcome.code, Some(3));
        assert!(!desk.path().join("x.png").exists());
        outcome.stderr
    };
    let told = refused(peak - 1);
    assert!(told.contains("this needs ") && told.contains("more than the limit of"), "{told}");
    assert!(told.contains("help: --set sphere_tables.0.colors=packed needs "), "{told}");
    let told = refused(1 << 20);
    assert!(told.contains("no option makes it fit"), "{told}");
    // The cheaper choice is really taken.
    let packed = format!("--set sphere_tables.0.colors=packed --memory-limit {}B", peak - 1);
    let words = "render s.toml -o x.png --accel native --size 16x16 --spp 1 --quiet";
    desk.run(&format!("{words} {packed}")).succeeds();
}

#[test]
fn info_tells_the_plan_before_it_refuses() {
    let desk = desk("lattice -n 8e3");
    let outcome = desk.run("info s.toml --memory-limit 1MiB");
    assert_eq!(outcome.code, Some(3));
    let told = outcome.stdout;
    assert!(told.starts_with("memory plan of a render\n"), "{told}");
    assert!(!told.contains("giants"), "the scene was not loaded: {told}");
    assert_eq!(desk.run("bench s.toml --memory-limit 1MiB").code, Some(3));
}
