//! What `render` writes, and what it says of it.

use std::process::Command;

use crate::desk::{Desk, PROGRAM, SCENE, outcome};

#[test]
fn every_format_is_written_and_nothing_else() {
    for name in ["out.png", "out.exr", "out.hdr", "out.pfm", "OUT.PNG"] {
        let desk = Desk::new(SCENE);
        let done = desk.run(&format!("render scene.toml -o {name}")).succeeds();
        assert_eq!(done.stdout, "");
        assert!(done.stderr.contains(&format!("wrote {name}\n")), "{}", done.stderr);
        for figure in ["load ", "build ", "render ", "samples/s", "rays/s", "peak memory"] {
            assert!(done.stderr.contains(figure), "{}", done.stderr);
        }
        let mut expected = [name, "scene.toml"];
        expected.sort_unstable();
        assert_eq!(desk.names(), expected);
    }
}

#[test]
fn json_has_the_figures_and_quiet_says_nothing() {
    let desk = Desk::new(SCENE);
    let done = desk
        .run("render scene.toml -o out.exr --accel native --json --quiet --size 8x6 --spp 2")
        .succeeds();
    assert_eq!(done.stderr, "");
    let figures = done.json();
    for key in ["load_s", "build_s", "render_s", "samples_per_s", "rays_per_s"] {
        assert!(figures[key].as_f64().is_some_and(|x| x > 0.0), "{key}: {figures}");
    }
    assert!(figures["peak_rss_bytes"].as_u64().is_some_and(|x| x > 1 << 16), "{figures}");
    assert_eq!(figures["accel"], "native");
    assert_eq!(figures["spheres"], 2);
    assert_eq!(figures["samples"], 8 * 6 * 2);
    assert_eq!(figures["complete"], true);
    assert_eq!(figures["output"], "out.exr");
}

#[test]
fn the_mean_in_json_is_that_of_the_picture() {
    let desk = Desk::new(SCENE);
    let done = desk.run("render scene.toml -o out.pfm --accel native --json").succeeds();
    let bytes = desk.read("out.pfm");
    let values = bytes[b"PF\n16 12\n-1.0\n".len()..]
        .chunks_exact(4)
        .map(|b| f64::from(f32::from_le_bytes([b[0], b[1], b[2], b[3]])));
    let means = done.json()["mean_rgb"].as_array().cloned().expect("a list");
    assert_eq!(means.len(), 3);
    for (axis, mean) in means.iter().enumerate() {
        let sum: f64 = values.clone().skip(axis).step_by(3).sum();
        let difference = mean.as_f64().expect("a number") - sum / (16.0 * 12.0);
        assert!(sum > 0.0 && difference.abs() <= 1e-9 * sum, "{mean}");
    }
}

#[test]
fn options_change_the_scene_and_threads_do_not_change_the_picture() {
    // Files of this format hold pixels alone.
    let picture = |options: &str| {
        let desk = Desk::new(SCENE);
        desk.run(&format!("render scene.toml -o out.pfm --accel native {options}")).succeeds();
        desk.read("out.pfm")
    };
    let plain = picture("");
    assert_eq!(plain, picture("--threads 1"));
    assert_eq!(plain, picture("--threads 3 --set render.seed=0 --integrator path"));
    let changes = [
        "--spp 8",
        "--size 12x16",
        "--seed 1",
        "--max-depth 1",
        "--integrator paper",
        "--set background.radiance=[1,0,0]",
    ];
    for change in changes {
        assert_ne!(plain, picture(change), "{change}");
    }
}

#[test]
fn an_older_picture_is_replaced_and_a_failed_write_keeps_it() {
    let desk = Desk::new(SCENE);
    desk.run("render scene.toml -o out.pfm --accel native").succeeds();
    let old = desk.read("out.pfm");

    // A limit on the size of files stands in for a full disk.
    let limited = format!(
        "trap '' XFSZ; ulimit -f 8; exec {PROGRAM} render scene.toml -o out.pfm --accel native \
             --size 100x100"
    );
    outcome(Command::new("sh").args(["-c", &limited]).current_dir(desk.path()))
        .fails(4, &["error: cannot write `out.pfm`: File too large"]);
    assert_eq!(desk.read("out.pfm"), old);
    assert_eq!(desk.names(), ["out.pfm", "scene.toml"]);

    desk.run("render scene.toml -o out.pfm --accel native --size 8x8").succeeds();
    assert!(desk.read("out.pfm").starts_with(b"PF\n8 8\n"));
}
