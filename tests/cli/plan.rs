//! Renders that are shared out by a plan: what it prints is run to the end, and gives the bytes of
//! one render.

use std::fs;
use std::process::Command;

use crate::desk::{Desk, Outcome, PROGRAM, SCENE, outcome};
use crate::python::python;

/// Five squares of 16 x 16 pixels and three blocks of samples, the last of each unfinished.
fn scene() -> String {
    let changes = [
        ("samples_per_pixel = 4", "samples_per_pixel = 41"),
        ("width = 16", "width = 70"),
        ("height = 12", "height = 14"),
    ];
    changes.iter().fold(SCENE.to_owned(), |scene, (from, to)| scene.replace(from, to))
}

/// Runs the script in the file to its end, with this program.
fn shell(desk: &Desk, file: &str) -> Outcome {
    let mut sh = Command::new("sh");
    outcome(sh.arg(file).env("PHOTOSPHERE", PROGRAM).current_dir(desk.path()))
}

/// Writes what a plan prints to a file.
#[track_caller]
fn plan(desk: &Desk, options: &str, file: &str) -> String {
    let script = desk.run(&format!("plan scene.toml {options}")).succeeds().stdout;
    fs::write(desk.path().join(file), &script).expect("written");
    script
}

fn modified(desk: &Desk, name: &str) -> std::time::SystemTime {
    let data = fs::metadata(desk.path().join(name)).expect("it is there");
    data.modified().expect("a time")
}

/// Plans with these options give the bytes of one render with these.
#[track_caller]
fn adds_up(desk: &Desk, options: &str, shards: u32, by: &str) {
    let options = format!("{options} --no-run-figures");
    desk.run(&format!("render scene.toml -o whole.exr {options} --quiet")).succeeds();
    let script = plan(desk, &format!("-o sum.exr {options} --shards {shards} {by}"), "plan.sh");
    assert_eq!(script.matches(" render ").count(), shards as usize, "{script}");
    shell(desk, "plan.sh").succeeds();
    assert!(desk.read("sum.exr") == desk.read("whole.exr"), "{script}");
}

#[test]
fn a_shell_script_gives_the_bytes_of_one_render() {
    let desk = Desk::new(&scene());
    for (options, shards, by) in [
        ("", 1, ""),
        ("--seed 2", 3, ""),
        ("--seed 3", 4, "--by crop"),
        ("--seed 4 --crop 3,1,60,13", 3, "--by crop"),
        ("--seed 5 --crop 3,1,60,13", 2, "--by samples"),
        ("--seed 6 --layers normal,variance,sphere_id,crypto_material", 2, ""),
        ("--seed 7 --sampler stratified --integrator direct --accel brute-force", 2, ""),
        ("--noise 9% --confidence 90%", 3, ""),
    ] {
        for name in desk.names().iter().filter(|name| name.ends_with(".part")) {
            fs::remove_file(desk.path().join(name)).expect("it is there");
        }
        adds_up(&desk, options, shards, by);
    }
}

#[test]
fn shards_may_run_again_and_go_on_from_where_they_were() {
    let desk = Desk::new(&scene());
    desk.run("render scene.toml -o whole.png --no-run-figures").succeeds();
    plan(&desk, "-o sum.png --no-run-figures --shards 3", "plan.sh");
    shell(&desk, "plan.sh").succeeds();
    let names = ["sum.samples-0..16.part", "sum.samples-16..32.part", "sum.samples-32..41.part"];
    let before = names.map(|name| modified(&desk, name));
    fs::remove_file(desk.path().join(names[1])).expect("it is there");
    fs::remove_file(desk.path().join("sum.png")).expect("it is there");
    shell(&desk, "plan.sh").succeeds();
    assert!(desk.read("sum.png") == desk.read("whole.png"));
    // The film of a finished shard is as it was, though its file may be written again.
    assert!(modified(&desk, names[1]) > before[1]);

    // A shard that was stopped: its file holds the first samples only.
    let part = "-o sum.samples-0..16.part --accel brute-force --quiet";
    fs::remove_file(desk.path().join(names[0])).expect("it is there");
    desk.run(&format!("render scene.toml {part} --samples 0..7 --spp 7")).succeeds();
    let script = fs::read_to_string(desk.path().join("plan.sh")).expect("a script");
    let first = script.lines().find(|line| line.contains("0..16")).expect("a shard");
    let command = first.replace(" --quiet", "");
    let mut sh = Command::new("sh");
    sh.args(["-c", &command]).env("PHOTOSPHERE", PROGRAM).current_dir(desk.path());
    let told = outcome(&mut sh).succeeds().stderr;
    assert!(told.contains("resuming `sum.samples-0..16.part`: 7.0 of 16"), "{told}");
    shell(&desk, "plan.sh").succeeds();
    assert!(desk.read("sum.png") == desk.read("whole.png"));

    // A scene that has changed since is not mixed in.
    fs::write(desk.path().join("scene.toml"), scene().replace("0.2, 0.6", "0.3, 0.6"))
        .expect("written");
    shell(&desk, "plan.sh").fails(3, &["cannot resume `sum.samples-0..16.part`"]);
}

#[test]
fn names_with_blanks_and_quotes_survive_the_shell() {
    let desk = Desk::new(&scene());
    let folder = desk.path().join("it's \"$HOME\" `id`; a b");
    fs::create_dir(&folder).expect("a folder");
    let name = "x 'y' (1) & $z.toml";
    fs::copy(desk.path().join("scene.toml"), folder.join(name)).expect("copied");
    let mut command = Command::new(PROGRAM);
    command.arg("plan").arg(folder.join(name)).args(["--shards", "2", "--no-run-figures"]);
    command.args(["--set", "materials.grass.albedo=[0.5, 0.4, 0.3]", "-o"]);
    let script = outcome(command.arg(folder.join("a'b.exr"))).succeeds().stdout;
    fs::write(desk.path().join("plan.sh"), script).expect("written");
    shell(&desk, "plan.sh").succeeds();
    let whole = "render scene.toml -o whole.exr --no-run-figures --set";
    let mut command = desk.command(whole);
    outcome(command.arg("materials.grass.albedo=[0.5, 0.4, 0.3]")).succeeds();
    assert!(fs::read(folder.join("a'b.exr")).expect("a picture") == desk.read("whole.exr"));
}

#[test]
fn a_noise_target_that_is_missed_ends_no_shard_but_the_merge_says_so() {
    let desk = Desk::new(&scene());
    let options = "--noise 0.1% --max-spp 64 --no-run-figures --quiet";
    desk.run(&format!("render scene.toml -o whole.exr {options}")).fails(1, &["is not met in"]);
    let options = options.replace(" --quiet", "");
    plan(&desk, &format!("-o sum.exr {options} --shards 2"), "plan.sh");
    let words = "warning: `sum.crop-0,0,32,14.part`: the noise target of 0.10 % is not met in";
    shell(&desk, "plan.sh").fails(1, &[words, "`sum.crop-32,0,70,14.part`"]);
    assert!(desk.read("sum.exr") == desk.read("whole.exr"));
    // A part of parts still says so.
    desk.run("merge sum.crop-0,0,32,14.part sum.crop-32,0,70,14.part -o all.part --quiet")
        .fails(1, &[words]);
    desk.run("merge all.part -o again.exr --no-run-figures --quiet").fails(1, &["`all.part`: the"]);
    assert!(desk.read("again.exr") == desk.read("whole.exr"));
}

#[test]
fn what_cannot_be_shared_out_is_refused() {
    let desk = Desk::new(&scene());
    let refused = |options: &str, code: i32, words: &[&str]| {
        desk.run(&format!("plan scene.toml {options}")).fails(code, words);
    };
    refused("", 2, &["--shards <N>"]);
    refused("--shards 0", 2, &["0 is not in 1..=10000"]);
    refused("--shards -1", 2, &["-1 is not in 1..=10000"]);
    refused("--shards many", 2, &["invalid digit"]);
    let few = "41 samples per pixel are 3 blocks of 16, too few for 4 shards";
    refused("--shards 4", 3, &[few, "fewer shards, more samples (--spp)", "--by crop"]);
    let few = "the picture has 5 tiles of 16 x 16 pixels, too few for 6 shards";
    refused("--shards 6 --by crop", 3, &[few, "--by samples"]);
    refused("--shards 6 --noise 1%", 3, &["too few for 6 shards", "use fewer shards"]);
    let whole = "--noise and --quality decide from all samples of a tile";
    refused("--shards 2 --noise 1% --by samples", 3, &[whole, "--by crop"]);
    refused("--shards 2 --time 5m", 3, &["the picture cannot be reproduced", "--spp N or --noise"]);
    refused(
        "--shards 2 --noise 1% --sampler stratified",
        3,
        &["a noise target decides when to stop"],
    );
    refused("--shards 2 --noise 1% --spp 64", 2, &["cannot be used with"]);
    refused("--shards 2 --format pbs", 2, &["[possible values: shell, slurm, openjd]"]);
    refused("--shards 2 -o a.jpg", 3, &["does not end in .png, .exr, .hdr or .pfm"]);
    refused("--shards 2 -o a.png --layers normal", 3, &["`a.png` cannot hold the layer"]);
    refused("--shards 2 -o nowhere/a.png", 4, &["nowhere` does not exist"]);
    refused("--shards 2 --spp 0", 3, &["--spp 0"]);
    refused("--shards 1025 --spp 65536 --format openjd", 3, &["at most 1024 tasks"]);
    desk.run("plan missing.toml --shards 2").fails(4, &["cannot read the scene `missing.toml`"]);
    assert_eq!(desk.names(), ["scene.toml"]);
}

#[test]
fn merged_windows_are_those_that_are_asked_for() {
    let desk = Desk::new(&scene());
    for (name, crop) in [("a", "0,0,16,14"), ("b", "16,0,32,14")] {
        desk.run(&format!("render scene.toml -o {name}.part --crop {crop} --quiet")).succeeds();
    }
    desk.run("merge a.part b.part -o c.pfm").fails(3, &["the pixels 32,0,70,14 are missing"]);
    desk.run("merge a.part b.part -o c.pfm --crop 0,0,33,14").fails(3, &["32,0,33,14 are missing"]);
    let words = [
        "the parts cover the pixels 0,0,32,14, which reach outside the crop 1,0,32,14",
        "inside the crop",
    ];
    desk.run("merge a.part b.part -o c.pfm --crop 1,0,32,14").fails(3, &words);
    desk.run("merge a.part b.part -o c.pfm --crop 5").fails(2, &["such as 0,0,320,240"]);
    desk.run("merge a.part b.part -o c.pfm --crop 0,0,32,14").succeeds();
    desk.run("render scene.toml -o whole.pfm --crop 0,0,32,14 --quiet").succeeds();
    assert!(desk.read("c.pfm") == desk.read("whole.pfm"));
}

#[test]
fn the_reference_openjd_checks_templates_and_runs_them_to_the_end() {
    let Some(python) = python("openjd-cli", &["-m", "openjd", "--version"]) else { return };
    let desk = Desk::new(&scene());
    fs::create_dir(desk.path().join("elsewhere")).expect("a folder");
    let openjd = |arguments: &[&str]| {
        let mut command = Command::new(&python);
        command.args(["-m", "openjd"]).args(arguments);
        // From another folder: names are relative to the template.
        let done = outcome(command.current_dir(desk.path().join("elsewhere")));
        assert_eq!(done.code, Some(0), "{}\n{}", done.stdout, done.stderr);
    };
    for (name, options) in [("a", "--shards 3"), ("b", "--shards 2 --noise 9% --seed 1")] {
        let picture = options.split_once(' ').and_then(|(_, rest)| rest.split_once(' '));
        let picture = picture.map_or("", |(_, options)| options);
        let figures = "--no-run-figures";
        desk.run(&format!("render scene.toml -o whole.exr {figures} {picture}")).succeeds();
        let file = format!("{name}.json");
        plan(&desk, &format!("-o {name}.exr {figures} {options} --format openjd"), &file);
        let file = format!("../{file}");
        openjd(&["check", &file]);
        let program = format!("Program={PROGRAM}");
        // Twice: what is finished stays.
        for _ in 0..2 {
            openjd(&["run", &file, "--job-param", &program]);
            assert!(desk.read(&format!("{name}.exr")) == desk.read("whole.exr"), "{name}");
        }
    }
}
