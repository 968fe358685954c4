//! Options that change nothing are named, and words that are nearly right are found.

use crate::desk::Desk;

/// What a command prints on the standard error for a small version of figure 2.
fn stderr(desk: &Desk, options: &str) -> String {
    let small = "--size 4x3 --spp 4 --quiet -o none";
    desk.run(&format!("render scene.toml {small} {options}")).stderr
}

#[test]
fn options_that_change_nothing_are_named() {
    let desk = Desk::of_file("paper/fig2.toml");
    for (options, named, why) in [
        ("--integrator paper --estimator light", "--estimator light", "the integrator `paper`"),
        ("--integrator paper --caustics chance", "--caustics chance", "the integrator `paper`"),
        ("--integrator normals --max-depth 3", "--max-depth 3", "the integrator `normals`"),
        (
            "--integrator direct --set render.clamp_indirect=2",
            "--set render.clamp_indirect=2",
            "the integrator `direct`",
        ),
        ("--estimator bsdf --caustics chance", "--caustics chance", "samples no lights"),
        (
            "--set render.paper.subpixels=3",
            "--set render.paper.subpixels=3",
            "the integrator `path`",
        ),
        ("--accel brute-force --build fast", "--build fast", "the intersector is `brute-force`"),
        ("--checkpoint-every 5m", "--checkpoint-every 300s", "add --checkpoint FILE"),
    ] {
        let told = stderr(&desk, options);
        let warning = format!("warning: `{named}` has no effect: ");
        assert!(told.contains(&warning) && told.contains(why), "{options}: {told}");
        assert_eq!(told.matches("warning").count(), 1, "{options}: {told}");
    }
    for options in ["--estimator light", "--integrator paper --max-depth 4", "--seed 3"] {
        assert_eq!(stderr(&desk, options), "", "{options}");
    }
    let checkpoint = "--checkpoint a.checkpoint --checkpoint-every 5m";
    assert_eq!(stderr(&desk, checkpoint), "", "there is a checkpoint");
    for options in ["--confidence 90%", "--preview-every 2s"] {
        assert!(stderr(&desk, options).contains("were not provided"), "{options}");
    }
    let trace = desk.run("trace scene.toml --pixel 1,1 --integrator paper --estimator light");
    assert!(trace.stderr.contains("`--estimator light` has no effect"), "{}", trace.stderr);
    let curves = "--size 4x3 --spp 4,8 --seeds 2 --integrator paper,path --estimator light,mis";
    let converge = desk.run(&format!("converge scene.toml {curves} -o a.svg"));
    let count = converge.stderr.matches("has no effect").count();
    assert_eq!(count, 2, "once for each: {}", converge.stderr);
}

#[test]
fn words_that_are_nearly_right_are_found() {
    let desk = Desk::of_file("paper/fig2.toml");
    for (options, help) in [
        ("--sampler indep", "did you mean `independent`?"),
        ("--integrator mis", "here it is called path, with estimator = \"mis\""),
        ("--estimator nee", "here it is called light"),
        (
            "--integrator paper --set render.paper.hemisphere=uniform",
            "did you mean `uniform-solid-angle` or `uniform-angle`?",
        ),
        ("--integrator paper --set render.paper.stop=thresh", "did you mean `threshold`?"),
    ] {
        let told = stderr(&desk, options);
        assert!(told.contains(help), "{options}: {told}");
    }
}

#[test]
fn a_missing_scene_has_neighbours() {
    let desk = Desk::of_file("paper/fig2.toml");
    std::fs::create_dir(desk.path().join("paper")).expect("a folder");
    std::fs::write(desk.path().join("paper/fig5.toml"), "").expect("a file");
    for (name, help) in [
        ("scen.toml", "did you mean `scene.toml`?"),
        ("fig5.toml", "did you mean `paper/fig5.toml`?"),
        ("other.toml", "the scenes there are `scene.toml`"),
        ("papers/fig5.toml", "there is no folder `papers`"),
    ] {
        let outcome = desk.run(&format!("info {name}"));
        assert!(outcome.stderr.contains(help), "{name}: {}", outcome.stderr);
    }
}
