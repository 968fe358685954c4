//! Renders that stop and go on, in parts and in one: always the same bytes.

use std::fs;
use std::io::{BufRead, BufReader, Write};
use std::process::{Command, Stdio};
use std::time::Duration;

use crate::desk::{Desk, PROGRAM, SCENE, holds_samples, outcome, send, wait_until};

/// The small scene with more samples than a block, and the last block unfinished.
fn desk() -> Desk {
    Desk::new(&SCENE.replace("samples_per_pixel = 4", "samples_per_pixel = 41"))
}

/// Renders the whole picture without a break.
fn whole(desk: &Desk, options: &str) -> Vec<u8> {
    desk.run(&format!("render scene.toml -o whole.exr --no-run-figures {options}")).succeeds();
    desk.read("whole.exr")
}

#[test]
fn parts_add_up_to_the_very_bytes_of_one_render() {
    let desk = desk();
    let whole = whole(&desk, "");
    for (name, options) in [
        ("a", "--samples 0..16"),
        ("b", "--samples 16..41 --crop 0,0,7,12"),
        ("c", "--samples 16..32 --crop 7,0,16,12 --threads 1"),
        ("d", "--samples 32..41 --crop 7,0,16,5"),
        ("e", "--samples 32..41 --crop 7,5,16,12"),
    ] {
        desk.run(&format!("render scene.toml -o {name}.part {options}")).succeeds();
    }
    let told = desk.run("merge d.part a.part e.part c.part b.part -o sum.exr --no-run-figures");
    assert!(told.succeeds().stderr.contains("wrote sum.exr, samples 0..41 from 5 parts"));
    assert!(desk.read("sum.exr") == whole);

    // Parts of parts, in another order.
    desk.run("merge c.part e.part -o ce.part").fails(3, &["samples 32..41", "are missing"]);
    desk.run("merge e.part d.part -o de.part").succeeds();
    desk.run("merge c.part de.part -o cde.part").succeeds();
    desk.run("merge cde.part b.part -o bcde.part").succeeds();
    desk.run("merge bcde.part a.part -o all.part -o again.exr --no-run-figures").succeeds();
    assert!(desk.read("again.exr") == whole);
    desk.run("merge all.part -o once.exr --no-run-figures").succeeds();
    assert!(desk.read("once.exr") == whole);

    let told = desk.run("info b.part").succeeds();
    assert_eq!((told.row("samples"), told.row("crop")), ("16..41", "0,0,7,12"));
    assert!(told.row("command").starts_with("photosphere render"), "{}", told.stdout);
}

#[test]
fn what_does_not_add_up_is_refused_with_the_reason() {
    let desk = desk();
    desk.run("render scene.toml -o a.part --samples 0..32").succeeds();
    desk.run("render scene.toml -o b.part --samples 16..41").succeeds();
    desk.run("render scene.toml -o c.part --samples 32..41").succeeds();
    desk.run("render scene.toml -o left.part --samples 0..16 --crop 0,0,9,12").succeeds();
    desk.run("render scene.toml -o seed.part --samples 32..41 --seed 5").succeeds();
    desk.run("render scene.toml -o size.part --samples 32..41 --size 16x13").succeeds();
    desk.run("render scene.toml -o accel.part --samples 32..41 --accel native").succeeds();
    desk.run("render scene.toml -o short.part --samples 0..20 --spp 20").succeeds();
    fs::write(desk.path().join("other.toml"), SCENE.replace("0.2, 0.6, 0.2", "0.3, 0.6, 0.2"))
        .expect("written");
    desk.run("render other.toml -o other.part --samples 32..41 --spp 41").succeeds();

    let refused = |parts: &str, words: &[&str]| {
        desk.run(&format!("merge {parts} -o sum.pfm")).fails(3, words);
        assert!(!desk.path().join("sum.pfm").exists(), "{parts}");
    };
    let overlap = "`a.part` and `b.part` both have samples 16..32 of the pixels 0,0,16,12";
    refused("a.part b.part", &[overlap, "leave one of them out"]);
    refused("b.part a.part c.part", &[overlap]);
    refused("a.part a.part", &["both have samples 0..32"]);
    refused("a.part", &["samples 32..41 of the pixels 0,0,16,12 are missing", "--allow-gaps"]);
    refused("b.part", &["samples 0..16 of the pixels 0,0,16,12 are missing"]);
    refused("left.part b.part", &["samples 0..16 of the pixels 9,0,16,12 are missing"]);
    refused(
        "a.part seed.part",
        &["are not parts of the same picture", "`render.seed` is 5, not 0"],
    );
    refused("a.part size.part", &["`image.height` is 13, not 12"]);
    refused("a.part accel.part", &["the intersector is native, not "]);
    let albedo = "`materials.grass.albedo` is [0.3, 0.6, 0.2], not [0.2, 0.6, 0.2]";
    refused("a.part other.part", &[albedo]);
    let within = "`short.part` ends within a block, at sample 20, so `c.part` cannot continue";
    refused("c.part short.part", &[within]);
    desk.run("merge a.part missing.part -o sum.pfm").fails(4, &["cannot read `missing.part`"]);
    desk.run("merge a.part scene.toml -o sum.pfm")
        .fails(4, &["it is neither a checkpoint nor a part"]);

    let error = "the following required arguments were not provided:\n  <PART>";
    desk.run("merge -o sum.pfm").fails(2, &[error]);
    desk.run("merge a.part -o sum.bmp").fails(3, &["does not end in .png, .exr, .hdr or .pfm"]);

    desk.run("merge left.part c.part -o sum.pfm --allow-gaps").succeeds();
    assert_eq!(desk.read("sum.pfm").len(), "PF\n16 12\n-1.0\n".len() + 16 * 12 * 12);
}

#[test]
fn ranges_that_do_not_fit_are_refused() {
    let desk = desk();
    let refused = |range: &str, words: &[&str]| {
        desk.run(&format!("render scene.toml -o a.part --samples {range}")).fails(3, words);
    };
    refused("8..41", &["must start on a multiple of 16", "try 0..41"]);
    refused("0..40", &["must end on a multiple of 16, or at the last sample, 41", "try 0..41"]);
    refused("16..17", &["try 16..32"]);
    refused("32..64", &["exceed the 41 samples per pixel", "per pixel: --spp 64"]);
    let most = "render scene.toml -o a.part --spp 4294967295 --samples 0..4294967290";
    desk.run(most).fails(3, &["try 0..4294967295"]);
    desk.run("render scene.toml -o a.part --samples 9").fails(2, &["such as 0..64"]);
    assert_eq!(desk.names(), ["scene.toml"]);
}

#[test]
fn a_render_goes_on_from_its_checkpoint_and_beyond() {
    let desk = desk();
    let whole = whole(&desk, "--spp 73");
    let figures = "--no-run-figures";
    // Stopped by its own range, so to say: the first samples only.
    desk.run(&format!("render scene.toml -o a.exr {figures} --checkpoint a.state --spp 25"))
        .succeeds();
    let told = desk.run("resume a.state --extend-to 41").succeeds();
    assert!(told.stderr.contains("resuming `a.state`: 25.0 of 41 samples per pixel"));
    desk.run("resume a.state --extend-to 73 -o b.exr").succeeds();
    assert!(desk.read("b.exr") == whole);
    // The same command again finds everything done, and so does `resume`.
    let again =
        format!("render scene.toml -o c.exr {figures} --checkpoint a.state --spp 73 --json");
    let again = desk.run(&again).succeeds();
    assert!(again.stdout.contains("\"samples\": 0"), "{}", again.stdout);
    assert!(desk.read("c.exr") == whole);
    fs::remove_file(desk.path().join("c.exr")).expect("it was there");
    desk.run("resume a.state").succeeds();
    assert!(desk.read("c.exr") == whole);

    // From another folder, to another one, with a part for the file.
    fs::create_dir(desk.path().join("sub")).expect("a folder");
    desk.run(&format!("render scene.toml -o s.part -o s.exr {figures} --samples 0..16 --spp 73"))
        .succeeds();
    fs::rename(desk.path().join("s.part"), desk.path().join("sub/moved.part")).expect("moved");
    let mut resume = desk.command("resume moved.part --extend-to 73 -o here.exr");
    outcome(resume.current_dir(desk.path().join("sub"))).succeeds();
    assert!(desk.read("sub/here.exr") == whole);
}

#[test]
fn what_is_not_this_render_is_not_gone_on_with() {
    let desk = desk();
    let render = "render scene.toml -o a.pfm --checkpoint a.state";
    desk.run(render).succeeds();
    let kept = desk.read("a.state");
    let refused = |command: &str, words: &[&str]| {
        desk.run(command).fails(3, words);
        assert!(desk.read("a.state") == kept, "{command}");
    };
    let other = |options: &str, words: &str| {
        let words = ["cannot resume `a.state`", words];
        refused(&format!("{render} {options}"), &words);
    };
    other("--seed 3", "it belongs to another render: `render.seed` is 0, not 3");
    other("--max-depth 3", "`render.max_depth` is 6, not 3");
    other("--crop 0,0,5,5", "its crop is 0,0,16,12, not 0,0,5,5");
    other("--samples 16..41", "its samples start at 0, not at 16");
    other("--spp 32", "it has samples up to 41, more than the 32 that are requested");
    other("--spp 64 --sampler stratified", "`render.sampler` is \"sobol\", not \"stratified\"");

    let stratified = "render scene.toml -o a.pfm --checkpoint s.state --sampler stratified";
    desk.run(stratified).succeeds();
    desk.run("resume s.state --extend-to 64")
        .fails(3, &["the number of samples per pixel differs"]);

    let at = |name: &str, bytes: &[u8]| fs::write(desk.path().join(name), bytes).expect("written");
    at("cut.state", &kept[..kept.len() / 2]);
    desk.run("resume cut.state").fails(4, &["cannot read `cut.state`: it is truncated after"]);
    let mut damaged = kept.clone();
    let middle = kept.len() - 100;
    damaged[middle] ^= 4;
    at("damaged.state", &damaged);
    desk.run("resume damaged.state").fails(4, &["it is damaged"]);
    let newer = [&kept[..8], &9u32.to_le_bytes(), &kept[12..]].concat();
    at("newer.state", &newer);
    let words = ["its format has version 9", "use the photosphere that wrote it"];
    desk.run("resume newer.state").fails(4, &words);
    desk.run("resume scene.toml").fails(4, &["it is neither a checkpoint nor a part"]);
    desk.run("render scene.toml -o a.pfm --checkpoint scene.toml")
        .fails(4, &["it is neither a checkpoint nor a part"]);

    fs::write(desk.path().join("scene.toml"), SCENE.replace("0.2, 0.6", "0.3, 0.6"))
        .expect("written");
    refused(
        "resume a.state",
        &["`materials.grass.albedo` is [0.2, 0.6, 0.2], not [0.3, 0.6, 0.2]"],
    );
}

#[test]
fn a_merged_part_is_gone_on_with_by_naming_it() {
    let desk = desk();
    let whole = whole(&desk, "--spp 73");
    for range in ["0..16", "16..32"] {
        desk.run(&format!("render scene.toml -o {range}.part --samples {range}")).succeeds();
    }
    desk.run("merge 0..16.part 16..32.part -o both.part").succeeds();
    let words = ["`both.part` does not record where its picture goes", "-o picture.exr"];
    desk.run("resume both.part").fails(3, &words);
    let options = "--checkpoint both.part --spp 73 --no-run-figures";
    desk.run(&format!("render scene.toml -o a.exr {options}")).succeeds();
    assert!(desk.read("a.exr") == whole);
}

#[test]
fn resume_keeps_the_options_of_the_command_and_says_what_it_cannot_do() {
    let desk = desk();
    let options = "--checkpoint a.state --spp 25 --json --quiet --threads 1";
    desk.run(&format!("render scene.toml -o a.exr {options}")).succeeds();
    // What it tells is up to each command; what it renders and how, up to the first.
    let again = desk.run("resume a.state --extend-to 41 --json --quiet").succeeds();
    assert_eq!(again.stderr, "");
    assert_eq!(again.json()["threads"], 1);
    let words =
        ["`b.part` is a part, but the samples are saved in `a.state`", "cp 'a.state' 'b.part'"];
    desk.run("resume a.state -o b.part").fails(3, &words);
    let told = desk.run("info a.state").succeeds();
    let way_on = told.row("resume");
    assert!(way_on.contains("scene.toml to a.exr, up to 41 samples"), "{way_on}");
    assert!(!told.stdout.contains('{'), "{}", told.stdout);
}

/// Who looked on may have gone; a relative name means the folder where the first command was run.
#[test]
fn a_render_goes_on_without_those_who_looked_on() {
    let desk = desk();
    fs::create_dir(desk.path().join("seen")).expect("a folder");
    fs::create_dir(desk.path().join("sub")).expect("a folder");
    let kept = "--checkpoint a.state --preview seen/p.png --quiet";
    desk.run(&format!("render scene.toml -o a.exr --spp 16 {kept}")).succeeds();
    let resume = |samples: u32| {
        let mut command = desk.command(&format!("resume ../a.state --extend-to {samples} --quiet"));
        outcome(command.current_dir(desk.path().join("sub"))).succeeds().stderr
    };
    fs::remove_file(desk.path().join("seen/p.png")).expect("it was there");
    assert_eq!(resume(32), "");
    assert!(desk.path().join("seen/p.png").exists());
    fs::remove_dir_all(desk.path().join("seen")).expect("it was there");
    let told = resume(48);
    assert!(told.starts_with("warning: cannot write `") && told.contains("seen` does not exist"));
    assert!(told.contains("; continuing without it"), "{told}");
    assert!(desk.path().join("a.exr").exists());
}

#[test]
fn one_place_is_for_one_file() {
    let desk = desk();
    fs::create_dir(desk.path().join("sub")).expect("a folder");
    let refused = |options: &str, words: &str| {
        desk.run(&format!("render scene.toml {options}")).fails(3, &[words]);
    };
    refused("-o a.exr --checkpoint a.exr", "-o a.exr and --checkpoint a.exr are the same file");
    refused("-o a.png -o ./a.png", "-o a.png and -o ./a.png are the same file");
    refused("-o a.png -o sub/../a.png", "are the same file");
    refused("-o a.png --preview a.png", "-o a.png and --preview a.png are the same file");
    desk.run("plan scene.toml --shards 1 -o a.exr -o a.exr").fails(3, &["are the same file"]);
    desk.run("render scene.toml -o a.part --checkpoint a.part --quiet").succeeds();
    desk.run("merge a.part -o a.exr -o ./a.exr").fails(3, &["are the same file"]);
    assert_eq!(desk.names(), ["a.part", "scene.toml", "sub"]);
}

/// A render that is far from its end when it has begun to render, and its first words.
fn begun(desk: &Desk, options: &str) -> std::process::Child {
    let command = format!("render scene.toml --spp 100000000 {options}");
    let child = desk.command(&command).stderr(Stdio::piped()).spawn().expect("it starts");
    let state = desk.path().join("a.state");
    wait_until("a checkpoint", || holds_samples(&state));
    child
}

/// As under `nohup`, or in the background of a script: what is ignored stays so, the rest is
/// heeded.
#[cfg(target_os = "linux")]
#[test]
fn signals_are_heeded_where_others_are_ignored() {
    let desk = desk();
    let render = "render scene.toml --spp 100000000 -o a.exr --checkpoint a.state \
                  --checkpoint-every 10ms --quiet";
    let script = format!("trap '' HUP INT; exec '{}' {render}", env!("CARGO_BIN_EXE_photosphere"));
    let mut child =
        Command::new("sh").args(["-c", &script]).current_dir(desk.path()).spawn().expect("a shell");
    wait_until("a checkpoint", || holds_samples(&desk.path().join("a.state")));
    let kill = format!("kill -HUP {0}; kill -INT {0}", child.id());
    assert!(Command::new("sh").args(["-c", &kill]).status().expect("a shell").success());
    std::thread::sleep(Duration::from_millis(100));
    assert!(child.try_wait().expect("it can be asked").is_none(), "an ignored signal ended it");
    let kill = format!("kill -TERM {}", child.id());
    assert!(Command::new("sh").args(["-c", &kill]).status().expect("a shell").success());
    assert_eq!(child.wait().expect("it ends").code(), Some(130));
    assert_eq!(desk.names(), ["a.exr", "a.state", "scene.toml"]);
}

#[test]
fn every_signal_to_end_leaves_a_checkpoint_and_a_picture() {
    for signal in ["INT", "TERM", "HUP"] {
        let desk = desk();
        let options = "-o a.exr --no-run-figures --checkpoint a.state --checkpoint-every 10ms";
        let child = begun(&desk, options);
        let kill = format!("kill -{signal} {}", child.id());
        assert!(Command::new("sh").args(["-c", &kill]).status().expect("a shell").success());
        let output = child.wait_with_output().expect("it ends");
        let told = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(130), "{told}");
        assert!(told.contains("resume it with: photosphere resume 'a.state'"), "{told}");
        // What was kept is what is shown.
        let shown = desk.read("a.exr");
        desk.run("merge a.state -o b.exr --no-run-figures --allow-gaps").succeeds();
        assert!(desk.read("b.exr") == shown);
        assert_eq!(desk.names(), ["a.exr", "a.state", "b.exr", "scene.toml"]);
    }
}

#[test]
fn a_folder_that_vanishes_does_not_end_a_render() {
    let desk = desk();
    fs::create_dir(desk.path().join("kept")).expect("a folder");
    let state = desk.path().join("kept/a.state");
    let options = "-o a.pfm --checkpoint kept/a.state --checkpoint-every 20ms";
    let command = format!("render scene.toml --spp 100000000 {options}");
    let mut child = desk.command(&command).stderr(Stdio::piped()).spawn().expect("it starts");
    let mut lines = BufReader::new(child.stderr.take().expect("it is piped")).lines();
    wait_until("a checkpoint", || holds_samples(&state));
    // While it is being removed, a new file may come into it.
    while fs::remove_dir_all(desk.path().join("kept")).is_err() {}
    let mut told = |words: &str| lines.any(|line| line.expect("text").contains(words));
    assert!(told("the render continues and retries `kept/a.state`"));
    fs::create_dir(desk.path().join("kept")).expect("a folder again");
    assert!(told("warning: writing `kept/a.state` works again"));
    assert!(state.exists());
    send("INT", child.id());
    assert!(told("wrote a.pfm, stopped after"));
    assert_eq!(child.wait().expect("it ends").code(), Some(130));
}

/// A limit on the size of files stands for a full disk: it needs no rights, and can be lifted.
#[test]
fn a_full_disk_does_not_end_a_render() {
    if Command::new("prlimit").arg("--version").output().is_err() {
        // Past the test harness, which would swallow it: a check left out must be seen.
        writeln!(std::io::stderr(), "SKIPPED: no prlimit, so a full disk was not tried")
            .expect("told");
        return;
    }
    let desk = desk();
    let options = "-o a.pfm --checkpoint a.state --checkpoint-every 20ms --spp 100000000";
    // Too small for the checkpoint; the signal that tells so does not end the program.
    let limited =
        format!("ulimit -S -f 4; exec {PROGRAM} render scene.toml --size 160x120 {options}");
    let mut child = Command::new("env")
        .args(["--default-signal=HUP,INT,TERM", "sh", "-c", &limited])
        .current_dir(desk.path())
        .stderr(Stdio::piped())
        .spawn()
        .expect("it starts");
    let mut lines = BufReader::new(child.stderr.take().expect("it is piped")).lines();
    let mut told = |start: &str| {
        let line = lines.find(|line| line.as_ref().is_ok_and(|line| line.starts_with(start)));
        line.unwrap_or_else(|| panic!("{start}")).expect("text")
    };
    let warning = told("warning: cannot write `a.state`: ");
    assert!(warning.ends_with("the render continues and retries `a.state`"), "{warning}");
    assert!(!desk.path().join("a.state").exists());
    let limit = ["--pid", &child.id().to_string(), "--fsize=unlimited:"].map(str::to_owned);
    assert!(Command::new("prlimit").args(limit).status().expect("it runs").success());
    told("warning: writing `a.state` works again");
    let kill = format!("kill -INT {}", child.id());
    assert!(Command::new("sh").args(["-c", &kill]).status().expect("a shell").success());
    told("wrote a.pfm, stopped after");
    assert_eq!(child.wait().expect("it ends").code(), Some(130));
    assert_eq!(desk.names(), ["a.pfm", "a.state", "scene.toml"]);
}

/// Returns true once a process has a handler for this signal.
fn is_heeded(process: u32, signal: u32) -> bool {
    let status = fs::read_to_string(format!("/proc/{process}/status")).unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigCgt:"));
    let caught = mask.and_then(|hex| u64::from_str_radix(hex.trim(), 16).ok()).unwrap_or(0);
    caught >> (signal - 1) & 1 == 1
}

/// What batch systems send before they end a job.
#[cfg(target_os = "linux")]
#[test]
fn signals_of_batch_systems_save_and_stop_or_go_on() {
    for signal in ["USR2", "XCPU"] {
        let desk = desk();
        let options = "--spp 100000000 -o a.pfm --checkpoint a.state --checkpoint-every 1h";
        let mut command = desk.command(&format!("render scene.toml {options}"));
        let child = command.stderr(Stdio::piped()).spawn().expect("it starts");
        wait_until("SIGUSR1 is heeded", || is_heeded(child.id(), 10));
        wait_until("a checkpoint", || {
            send("USR1", child.id());
            holds_samples(&desk.path().join("a.state"))
        });
        send(signal, child.id());
        let output = child.wait_with_output().expect("it ends");
        let told = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(130), "{told}");
        assert!(told.contains("wrote a.pfm, stopped after"), "{told}");
        assert_eq!(desk.names(), ["a.pfm", "a.state", "scene.toml"]);
    }
}

/// Names that are no text are kept in checkpoints and pictures.
#[cfg(target_os = "linux")]
#[test]
fn names_that_are_not_utf8_lose_nothing() {
    use std::os::unix::ffi::OsStrExt;
    let desk = desk();
    let name = |bytes: &[u8]| desk.path().join(std::ffi::OsStr::from_bytes(bytes));
    let [folder, scene, picture, kept] =
        [&b"bad\xff"[..], b"bad\xff/scene\xfe.toml", b"bad\xff/a\xfd.exr", b"bad\xff/k\xfc.part"]
            .map(name);
    fs::create_dir(&folder).expect("a folder");
    fs::copy(desk.path().join("scene.toml"), &scene).expect("a scene");
    let photosphere = |arguments: &[&std::ffi::OsStr]| {
        let output = Command::new(PROGRAM).args(arguments).output().expect("it runs");
        let told = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(0), "{told}");
        (String::from_utf8_lossy(&output.stdout).into_owned(), told)
    };
    let os = std::ffi::OsStr::new;
    let render: Vec<&std::ffi::OsStr> =
        [os("render"), scene.as_os_str(), os("-o"), picture.as_os_str()]
            .into_iter()
            .chain([os("--checkpoint"), kept.as_os_str()])
            .chain(["--checkpoint-every", "1ms", "--spp", "64"].map(os))
            .collect();
    let (_, told) = photosphere(&render);
    assert!(!told.contains("warning"), "{told}");
    photosphere(&[os("resume"), kept.as_os_str(), os("--extend-to"), os("128")]);
    photosphere(&[os("info"), kept.as_os_str()]);
    let (told, _) = photosphere(&[os("reproduce"), picture.as_os_str()]);
    assert!(told.contains("all pixels agree to the bit"), "{told}");
}

/// A checkpoint holds the job: what the scene file says of it meanwhile does not matter.
#[test]
fn a_render_is_resumed_with_the_job_of_its_checkpoint() {
    let desk = desk();
    let scene = fs::read_to_string(desk.path().join("scene.toml")).expect("a scene");
    let seed = |seed: u32| {
        let text = scene.replace("seed = 0", &format!("seed = {seed}"));
        assert!(text != scene, "the scene says a seed");
        fs::write(desk.path().join("scene.toml"), text).expect("a scene");
    };
    seed(3);
    desk.run("render scene.toml -o whole.pfm --spp 128 --size 30x20 -q").succeeds();
    desk.run("render scene.toml -o a.pfm --spp 64 --size 30x20 --checkpoint a.state -q").succeeds();
    seed(4);
    desk.run("resume a.state --extend-to 128 -q").succeeds();
    assert!(desk.read("a.pfm") == desk.read("whole.pfm"), "another seed, or another size");
}

#[test]
fn merged_parts_that_begin_later_are_resumed() {
    let desk = desk();
    for range in ["16..32", "32..48"] {
        let name = range.replace("..", "-");
        desk.run(&format!("render scene.toml -o {name}.part --spp 64 --samples {range} -q"))
            .succeeds();
    }
    desk.run("merge 16-32.part 32-48.part -o n.part -q").succeeds();
    desk.run("resume n.part -q")
        .fails(3, &["does not record where its picture goes", "-o picture.exr"]);
    desk.run("resume n.part -o z.pfm -q").succeeds();
    desk.run("render scene.toml -o one.pfm --spp 64 --samples 16..48 -q").succeeds();
    assert!(desk.read("z.pfm") == desk.read("one.pfm"), "other samples");
}

/// Ctrl-C alone, twice, may end the program before it has saved what it has.
#[test]
fn signals_while_the_last_files_are_written_let_them_be_finished() {
    let desk = desk();
    let options = "--size 1280x960 --layers direct,indirect,albedo,normal --time 1s -o a.exr \
                   --checkpoint a.state --checkpoint-every 50ms --accel native --quiet";
    let mut child = desk.command(&format!("render scene.toml {options}")).spawn().expect("starts");
    // The checkpoint comes while it renders; after that the picture is written only at the end.
    let is_there = |start: &str| desk.names().iter().any(|name| name.starts_with(start));
    for start in ["a.state", ".a.exr."] {
        while !is_there(start) && child.try_wait().expect("it can be asked").is_none() {
            std::thread::sleep(Duration::from_millis(1));
        }
    }
    let kill = format!("for s in TERM HUP TERM; do kill -$s {}; sleep 0.01; done", child.id());
    let _ = Command::new("sh").args(["-c", &kill]).status().expect("a shell");
    assert_eq!(child.wait().expect("it ends").code(), Some(0));
    assert_eq!(desk.names(), ["a.exr", "a.state", "scene.toml"]);
}

/// Everything goes with its folder; the message says where the samples are and what makes the
/// picture again.
#[test]
fn what_cannot_be_saved_at_the_end_is_elsewhere_and_goes_on_from_there() {
    let desk = desk();
    fs::create_dir(desk.path().join("kept")).expect("a folder");
    let options = "--spp 100000000 -o a.pfm -o kept/b.pfm --checkpoint kept/a.state \
                   --checkpoint-every 20ms";
    let mut command = desk.command(&format!("render scene.toml {options}"));
    let child = command.stderr(Stdio::piped()).spawn().expect("it starts");
    wait_until("a checkpoint", || holds_samples(&desk.path().join("kept/a.state")));
    while fs::remove_dir_all(desk.path().join("kept")).is_err() {}
    send("TERM", child.id());
    let output = child.wait_with_output().expect("it ends");
    let told = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(4), "{told}");
    let names = desk.names();
    let [picture, rescued, _] = names.as_slice() else { panic!("{names:?}") };
    assert_eq!(picture, "a.pfm");
    assert!(rescued.starts_with("rescued-") && rescued.ends_with("-a.state"), "{rescued}");
    let rescued = desk.path().join(rescued).canonicalize().expect("it is there");
    let rescued = rescued.display();
    for words in [
        "error: cannot write `kept/a.state`: the folder `kept` does not exist".to_owned(),
        format!("`kept/a.state` is in `{rescued}` instead; "),
        format!("photosphere resume '{rescued}' writes `kept/b.pfm`; written: `a.pfm`\n"),
    ] {
        assert!(told.contains(&words), "{words}: {told}");
    }
    desk.run(&format!("merge {rescued} -o b.pfm --allow-gaps --quiet")).succeeds();
    assert!(desk.read("a.pfm") == desk.read("b.pfm"));
}

/// No file can be written anywhere, and no message says that one is there.
#[test]
fn on_a_full_disk_what_is_lost_is_called_lost() {
    let desk = desk();
    let limited = format!(
        "ulimit -f 4; exec {PROGRAM} render scene.toml --size 160x120 --spp 100000000 -o a.pfm \
         --checkpoint a.state --checkpoint-every 20ms"
    );
    let mut child = Command::new("env")
        .args(["--default-signal=HUP,INT,TERM", "sh", "-c", &limited])
        .current_dir(desk.path())
        .env("TMPDIR", desk.path())
        .stderr(Stdio::piped())
        .spawn()
        .expect("it starts");
    let mut lines = BufReader::new(child.stderr.take().expect("it is piped")).lines();
    let mut line = |start: &str| {
        let line = lines.find(|line| line.as_ref().is_ok_and(|line| line.contains(start)));
        line.unwrap_or_else(|| panic!("{start}")).expect("text")
    };
    line("the render continues and retries `a.state`");
    // Where nothing is finished yet, the time that is left is not known.
    line(" left");
    send("INT", child.id());
    line("error: cannot write `a.state`: ");
    let help = line("  help: ");
    assert_eq!(child.wait().expect("it ends").code(), Some(4));
    for name in ["a.state", "a.pfm"] {
        assert!(help.contains(&format!("the content of `{name}` is lost: it could not")), "{help}");
    }
    for word in ["instead", "safe", "resume", "older", "written: "] {
        assert!(!help.contains(word), "{help}");
    }
    assert_eq!(desk.names(), ["scene.toml"]);
}

#[test]
fn info_and_merge_tell_what_is_missing_or_damaged() {
    let desk = desk();
    desk.run("render scene.toml -o a.part --samples 0..16").succeeds();
    desk.run("render scene.toml -o b.part --samples 16..32 --crop 0,0,9,12").succeeds();
    let told = desk.run("merge a.part b.part -o c.png --allow-gaps").succeeds().stderr;
    let words = "0..32 (some pixels have fewer)";
    assert!(told.contains(words), "{told}");
    assert!(desk.run("info c.png").succeeds().stdout.contains(words));
    // A part of which a part has gaps is none, whatever else is asked for.
    desk.run("merge a.part -o whole.part -o whole.png --allow-gaps").succeeds();
    desk.run("render scene.toml -o far.part --samples 32..41").succeeds();
    let options = "-o both.part -o both.png --allow-gaps";
    desk.run(&format!("merge a.part far.part {options}")).fails(3, &["gaps"]);

    let mut damaged = desk.read("a.part");
    let last = damaged.len() - 40;
    damaged[last] ^= 4;
    fs::write(desk.path().join("a.part"), damaged).expect("a disk");
    desk.run("info a.part").fails(4, &["`a.part`: it is damaged"]);
    fs::write(desk.path().join("empty.part"), "").expect("a disk");
    desk.run("info empty.part").fails(4, &["`empty.part`"]);
    desk.run("info none.part").fails(4, &["`none.part`"]);
}
