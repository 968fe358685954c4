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
fn emission_and_f64_are_part_of_the_plan() {
    let desk = desk("gas -n 1000");
    let scene = std::fs::read_to_string(desk.path().join("s.toml")).expect("generated");
    let planned = |columns: &str, row_bytes: usize| {
        let row = [&[0u8; 12][..], &1f32.to_le_bytes(), &vec![0; row_bytes - 16]].concat();
        std::fs::write(desk.path().join("t.f32"), row.repeat(1000)).expect("a table");
        let is_columns = |line: &str| line.starts_with("columns");
        let lines = scene.lines().map(|line| if is_columns(line) { columns } else { line });
        let text = lines.collect::<Vec<_>>().join("\n");
        std::fs::write(desk.path().join("s.toml"), text).expect("a scene");
        let info = desk.run("info s.toml --json").succeeds().json();
        let plan = &info["memory_plan"][0];
        ["sphere_bytes", "emission_bytes", "emitter_bytes"].map(|key| plan[key].as_u64())
    };
    let plain = planned("columns = ['x', 'y', 'z', 'radius']", 16);
    let [Some(spheres), Some(0), Some(emitters)] = plain else { panic!("{plain:?}") };
    let light = planned("columns = ['x', 'y', 'z', 'radius', 'emission']", 20);
    assert_eq!(light, [spheres, 12_000, emitters + 288_000].map(Some));
    let wide = planned("columns = ['x', 'y', 'z', 'radius', '_', '_:f64']", 28);
    assert_eq!(wide, plain);
    let wide = planned("columns = ['x:f32', '_:f64', 'radius', 'y', 'z:f64']", 28);
    assert_eq!(wide, [spheres + 16_000, 0, emitters].map(Some));
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
