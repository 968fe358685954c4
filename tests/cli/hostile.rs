//! Files, names and surroundings that mean no good: each ends in a message, and never in a hang, a
//! panic or a command to the terminal.

use std::fs;
use std::process::Command;

use crate::desk::{Desk, Outcome, PROGRAM, SCENE, outcome};

/// Fails if a terminal would do more than show what was printed.
#[track_caller]
fn is_inert(told: &Outcome) {
    for text in [&told.stdout, &told.stderr] {
        let is_active = |c: char| c.is_control() && c != '\n' || c == '\u{202e}';
        assert!(!text.contains(is_active), "{text:?}");
    }
}

/// Runs the program with a limit of the shell's `ulimit`, and with these variables.
fn limited(desk: &Desk, limit: &str, variables: &[(&str, &str)], arguments: &str) -> Outcome {
    let line = format!("ulimit {limit} && exec '{PROGRAM}' {arguments}");
    let mut command = Command::new("sh");
    command.args(["-c", &line]).current_dir(desk.path()).envs(variables.iter().copied());
    outcome(&mut command)
}

#[test]
fn of_a_line_without_end_the_part_with_the_mistake_is_shown() {
    let desk = Desk::new(&format!("a = \"{}\" b\n{SCENE}", "x".repeat(100_000)));
    let told = desk.run("info scene.toml").fails(3, &["[scene.toml:1:100", "xxx\" b\n", "...xxx"]);
    assert!(told.stderr.lines().all(|line| line.len() < 1100), "{}", told.stderr);
    let desk = Desk::new(&format!("{} = 1\n{SCENE}", "x".repeat(100_000)));
    let told = desk.run("info scene.toml").fails(3, &["unknown key `xxx", "xxx...\n"]);
    assert!(told.stderr.lines().all(|line| line.len() < 1100), "{}", told.stderr);
}

#[test]
fn deeply_nested_scenes_are_refused_with_the_bound() {
    for (open, close) in [("[", "]"), ("{a=", "}"), ("[", "")] {
        let nested = format!("{}{}", open.repeat(200_000), close.repeat(200_000));
        let desk = Desk::new(&format!("{SCENE}deep = {nested}\n"));
        let bound = "error: tables and lists are nested more than 64 deep";
        let told = desk.run("info scene.toml").fails(3, &[bound, "help: "]);
        assert!(told.stderr.lines().all(|line| line.len() < 200), "{}", told.stderr);
    }
    let desk = Desk::new(SCENE);
    let value = "[".repeat(70);
    desk.run(&format!("info scene.toml --set render.seed={value}")).fails(3, &["nested more"]);
    let key = "a.".repeat(1000);
    desk.run(&format!("info scene.toml --set {key}a=1")).fails(3, &["more than 64 parts"]);
}

#[test]
fn control_characters_of_files_and_names_do_not_reach_the_terminal() {
    let desk = Desk::new(&SCENE.replace("\"ball\"", "\"ball\\u001b[2J\\u009b\""));
    let name = "a\u{1b}[31m\u{202e}\u{9b}.png";
    let shown = r"a\u{1b}[31m\u{202e}\u{9b}.png";
    let told = desk.run(&format!("render scene.toml -o {name}")).succeeds();
    is_inert(&told);
    assert!(told.stderr.contains(&format!("wrote {shown}")), "{}", told.stderr);
    // The metadata hold the command and the scene.
    let told = desk.run(&format!("info {name}")).succeeds();
    is_inert(&told);
    assert!(told.row("command").contains(shown), "{}", told.stdout);
    let told = desk.run(&format!("info {name} --json")).succeeds();
    is_inert(&told);
    assert!(told.json()["command"].as_str().is_some_and(|command| command.contains(name)));
    // Messages quote names and excerpts.
    let failing = [
        format!("info {name}.toml"),
        format!("compare {name} none\u{7f}.png --json"),
        "info scene.toml --set spheres.ball\u{1b}[2J.radius=1".to_owned(),
        "info --\u{1b}[2J".to_owned(),
        format!("plan scene.toml --shards 2 -o {name}.exr"),
    ];
    for arguments in failing {
        let told = desk.run(&arguments);
        assert!(matches!(told.code, Some(2..=4)), "{arguments}: {}", told.stderr);
        is_inert(&told);
    }
    fs::write(desk.path().join("b.toml"), "a = \"\u{1b}[2J\u{9b}\u{202e}\"\r\n").expect("written");
    let told = desk.run("info b.toml").fails(3, &[r"\u{1b}[2J"]);
    is_inert(&told);
}

/// The random dimensions of paths that end at once wrap, also where arithmetic is checked.
#[test]
fn a_lens_before_a_lone_emitter_is_no_overflow() {
    let desk = Desk::new(
        "format = 1\nimage = { width = 1, height = 1 }\n\
         camera = { position = [0, 0, 0], look_at = [0, 0, -1], vertical_fov_degrees = 30, \
         aperture_radius = 0.3, focus_distance = 4 }\n\
         materials.lamp = { type = \"diffuse\", albedo = [0, 0, 0], emission = [5, 5, 5] }\n\
         spheres = [{ center = [0, 0, -8], radius = 0.8, material = \"lamp\" }]\n",
    );
    for intersector in ["native", "brute-force"] {
        let render = format!("render scene.toml -o a.pfm --spp 64 --accel {intersector} --quiet");
        assert_eq!(desk.run(&render).succeeds().stderr, "");
    }
}

#[test]
fn pictures_are_read_from_ordinary_files_only() {
    let scene = SCENE.replace("radiance = [0.5, 0.6, 0.7]", "image = { file = \"e.hdr\" }");
    let desk = Desk::new(&scene);
    for name in ["a.pfm", "a.exr", "a.png", "e.hdr", "a.part"] {
        let pipe = desk.path().join(name);
        assert!(Command::new("mkfifo").arg(&pipe).status().expect("mkfifo runs").success());
    }
    std::os::unix::fs::symlink("/dev/zero", desk.path().join("zero.pfm")).expect("a link");
    for (command, code) in [
        ("compare a.pfm a.pfm", 4),
        ("compare zero.pfm zero.pfm", 4),
        ("info a.exr", 4),
        ("info a.png", 4),
        ("reproduce a.png", 4),
        ("merge a.part -o sum.png", 4),
        ("render scene.toml -o b.png", 3),
    ] {
        desk.run(command).fails(code, &["not a regular file"]);
    }
}

#[test]
fn a_name_that_is_too_long_is_found_before_the_render() {
    let desk = Desk::new(SCENE);
    let long = format!("{}.png", "a".repeat(260));
    for output in [format!("-o {long}"), format!("-o a.png --checkpoint {long}")] {
        desk.run(&format!("render missing.toml {output}")).fails(4, &["File name too long"]);
    }
    assert_eq!(desk.names(), ["scene.toml"]);
}

#[test]
fn threads_that_cannot_start_are_an_error() {
    let desk = Desk::new(SCENE);
    desk.run("render scene.toml -o a.pfm --quiet").succeeds();
    let commands =
        ["render scene.toml -o b.png", "compare a.pfm a.pfm", "info scene.toml", "doctor"];
    for command in commands {
        let told = outcome(desk.command(command).env("RAYON_NUM_THREADS", "1000000"));
        let words = "RAYON_NUM_THREADS asks for 1000000 threads, more than 4096";
        told.fails(3, &[words, "help: set it to a smaller number"]);
    }
    assert_eq!(desk.names(), ["a.pfm", "scene.toml"]);
}

/// The program run by a user who may have so many processes and threads at a time, and may touch
/// the files of this one: root has no limit.
#[cfg(target_os = "linux")]
fn with_few_threads(desk: &Desk, threads: usize, arguments: &str) -> Outcome {
    // No other process of the system has this user; threads are counted by user.
    let user = (1_987_000_000 + std::process::id()).to_string();
    let mut command = Command::new("prlimit");
    command.arg(format!("--nproc={threads}")).args(["setpriv", "--clear-groups"]);
    command.args(["--reuid", &user, "--regid", &user, "--bounding-set=-all,+dac_override"]);
    command.args(["--inh-caps=+dac_override", "--ambient-caps=+dac_override", PROGRAM]);
    outcome(command.args(arguments.split_whitespace()).current_dir(desk.path()))
}

/// Whichever thread cannot start, the program says so, or renders without that thread.
#[cfg(target_os = "linux")]
#[test]
fn threads_that_the_system_denies_are_an_error_or_a_warning() {
    use std::io::{self, Write};
    use std::os::unix::fs::MetadataExt;
    let desk = Desk::new(SCENE);
    let installed = |program| Command::new(program).arg("--version").output().is_ok();
    let is_root = desk.path().metadata().is_ok_and(|folder| folder.uid() == 0);
    if !is_root || !installed("prlimit") || !installed("setpriv") {
        // Past the test harness, which would swallow it: a check left out must be seen.
        writeln!(io::stderr(), "SKIPPED: threads that cannot start need root, prlimit and setpriv")
            .expect("told");
        return;
    }
    let render = "render scene.toml -o a.png --threads 4 --checkpoint a.part --accel native";
    let mut codes = Vec::new();
    for threads in (1..14).chain([40]) {
        let told = with_few_threads(&desk, threads, render);
        let words = if told.code == Some(0) { "wrote a.png" } else { "error: cannot start " };
        assert!(told.stderr.contains(words), "{threads} threads: {}", told.stderr);
        assert!(!told.stderr.contains("panic"), "{threads} threads: {}", told.stderr);
        codes.push(told.code);
        for name in ["a.png", "a.part"] {
            let _ = fs::remove_file(desk.path().join(name));
        }
    }
    // With one thread nothing works, with 40 all does. In between, threads that are ending count.
    assert!(codes.iter().all(|code| matches!(code, Some(0 | 3))), "{codes:?}");
    assert_eq!((codes[0], codes[13]), (Some(3), Some(0)), "{codes:?}");
    if cfg!(has_embree) {
        // There is room for the render's threads, but not for as many of Embree's.
        let embree = "render scene.toml -o b.png --threads 16 --accel embree";
        with_few_threads(&desk, 26, embree).fails(3, &["error: cannot start ", "help: "]);
    }
}

/// Runs the program where its control group has this quota of processor time: $1 is the version of
/// control groups, and the rest is the program.
#[cfg(target_os = "linux")]
const WITH_ONE_CORE: &str = "
    set -e
    groups=/sys/fs/cgroup
    mount -t tmpfs none $groups
    case $1 in
    1)  mkdir -p $groups/cpu/job
        echo 100000 >$groups/cpu/job/cpu.cfs_quota_us
        echo 100000 >$groups/cpu/job/cpu.cfs_period_us
        echo 3:cpu:/job >$groups/own ;;
    2)  mkdir $groups/job
        echo 100000 100000 >$groups/job/cpu.max
        echo cpu | tee $groups/cgroup.controllers >$groups/job/cgroup.controllers
        echo 0::/job >$groups/own ;;
    esac
    mount --bind $groups/own /proc/$$/cgroup
    shift
    exec \"$@\"";

/// Containers and batch systems limit processor time by control groups, of version 1 or 2.
#[cfg(target_os = "linux")]
#[test]
fn there_are_no_more_threads_than_a_control_group_has_processor_time_for() {
    use std::io::{self, Write};
    let desk = Desk::new(SCENE);
    let unshared = |version: &str| {
        let mut command = Command::new("unshare");
        command.args(["--mount", "sh", "-c", WITH_ONE_CORE, "sh", version]);
        command.current_dir(desk.path());
        command
    };
    if !unshared("1").arg("true").output().is_ok_and(|done| done.status.success()) {
        writeln!(io::stderr(), "SKIPPED: a control group's quota needs root and unshare")
            .expect("told");
        return;
    }
    for version in ["1", "2"] {
        let doctor = outcome(unshared(version).args([PROGRAM, "doctor"])).succeeds();
        assert_eq!(doctor.row("threads"), "1", "{}", doctor.stdout);
        let render = "render scene.toml -o a.png --json";
        let render = outcome(unshared(version).arg(PROGRAM).args(render.split(' '))).succeeds();
        assert_eq!(render.json()["threads"], 1, "version {version}: {}", render.stdout);
    }
}

#[test]
fn advice_for_names_that_start_with_a_dash_works() {
    let desk = Desk::new(SCENE);
    let words = ["unexpected argument '-d' found", "write './-dash.png'"];
    desk.run("render scene.toml -o -dash.png").fails(2, &words);
    desk.run("render scene.toml -o ./-dash.png --quiet").succeeds();
    desk.run("render scene.toml -o --dash.png").fails(2, &["write './--dash.png'"]);
    desk.run("info -dash.png").fails(2, &["write './-dash.png'"]);
    desk.run("info ./-dash.png").succeeds();
    let told = desk.run("render scene.toml -o ./-a.part --quiet").succeeds();
    assert_eq!(told.stderr, "");
    desk.run("reproduce ./-a.part").fails(3, &["photosphere merge './-a.part' -o"]);
}

#[test]
fn a_missing_folder_for_temporary_files_is_blamed_itself() {
    let desk = Desk::new(SCENE);
    desk.run("render scene.toml -o a.png --quiet").succeeds();
    let told = outcome(desk.command("reproduce a.png").env("TMPDIR", "/nowhere"));
    let words = "error: cannot create a temporary folder in `/nowhere`: No such file or directory";
    let told = told.fails(4, &[words, "TMPDIR"]);
    assert!(!told.stderr.contains("a.png"), "{}", told.stderr);
}

#[test]
fn with_json_a_failure_is_one_json_value_and_keeps_its_exit_code() {
    let desk = Desk::new(SCENE);
    fs::write(desk.path().join("bad.toml"), SCENE.replace("width", "widht")).expect("written");
    for (arguments, code, category) in [
        ("render missing.toml -o a.png", 4, "file"),
        ("info bad.toml", 3, "input"),
        ("trace scene.toml --pixel 99,0", 3, "input"),
        ("compare a.bmp b.bmp", 3, "input"),
        ("verify --only no-check-has-this-name", 3, "input"),
        ("info --frobnicate", 2, "usage"),
        ("render scene.toml", 2, "usage"),
    ] {
        let told = desk.run(&format!("{arguments} --json"));
        assert_eq!(told.code, Some(code), "{arguments}: {}", told.stderr);
        let json = told.json();
        let error = &json["error"];
        assert_eq!(error["exit_code"], code, "{arguments}: {json}");
        assert_eq!(error["category"], category, "{json}");
        // People are told all the same.
        let message = error["message"].as_str().expect("a text").lines().next().expect("a line");
        let words = message.rsplit(": ").next().expect("a text");
        assert!(words.len() > 4 && told.stderr.contains(words), "{words}: {}", told.stderr);
        assert_eq!(desk.run(arguments).stdout, "");
    }
    let told = desk.run("info bad.toml --json").json();
    let mistake = &told["error"]["diagnostics"][0];
    assert_eq!(mistake["file"], "bad.toml");
    assert_eq!((&mistake["line"], &mistake["column"]), (&4.into(), &1.into()));
    assert_eq!(mistake["help"], "did you mean `width`?");
}

/// The limit is less than the picture needs, and more than the program itself does.
#[cfg(target_os = "linux")]
#[test]
fn a_limit_of_the_address_space_is_seen_before_anything_is_loaded() {
    let desk = Desk::new(SCENE);
    let render = "render scene.toml -o a.png --accel native --threads 1 --size 20000x20000";
    let words = ["this needs ", "but the limit of the address space (ulimit -v) leaves only "];
    limited(&desk, "-v 2000000", &[], render).fails(3, &words);
    assert_eq!(desk.names(), ["scene.toml"]);
}
