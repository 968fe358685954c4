//! Closed pipes, full disks and Ctrl-C.

use std::fs;
use std::io::{BufRead, BufReader};
use std::os::fd::OwnedFd;
use std::os::unix::net::UnixStream;
use std::process::{Child, Command, Stdio};

use crate::desk::{Desk, SCENE, outcome, send, wait_until};

#[test]
fn a_reader_that_has_gone_is_no_failure() {
    for arguments in ["man", "info scene.toml", "doctor", "--help"] {
        let (ours, theirs) = UnixStream::pair().expect("two sockets");
        drop(theirs);
        let desk = Desk::new(SCENE);
        let done = outcome(desk.command(arguments).stdout(OwnedFd::from(ours)));
        assert_eq!((done.code, done.stderr.as_str()), (Some(0), ""), "{arguments}");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_under_the_standard_output_is_a_file_error() {
    let full = fs::OpenOptions::new().write(true).open("/dev/full").expect("Linux has it");
    let desk = Desk::new(SCENE);
    outcome(desk.command("info scene.toml").stdout(full))
        .fails(4, &["error: cannot write `standard output`: No space left on device"]);
}

/// Starts a render that would take years, and returns once it has told of finished samples, however
/// long that takes.
fn endless_render(desk: &Desk, options: &str) -> (Child, impl Iterator<Item = String> + use<>) {
    let arguments = format!("render scene.toml --spp 4294967292 {options}");
    let mut child =
        desk.command(&arguments).stderr(Stdio::piped()).spawn().expect("the program starts");
    let stderr = child.stderr.take().expect("it was asked for");
    let mut lines = BufReader::new(stderr).lines().map(|line| line.expect("text"));
    // Where nothing is finished yet, the time that is left is not known.
    let is_of_progress = |line: &String| line.contains("samples/s") && line.ends_with(" left");
    assert!(lines.any(|line| is_of_progress(&line)), "a line of progress");
    (child, lines)
}

fn interrupt(child: &Child) {
    send("INT", child.id());
}

/// The scene is a pipe that never ends, so the program is sure to be reading it.
#[test]
fn an_interrupt_before_the_render_ends_the_program_at_once() {
    let commands = ["render scene.pipe -o out.pfm", "bench scene.pipe", "crosscheck scene.pipe"];
    for command in commands {
        let desk = Desk::new(SCENE);
        let pipe = desk.path().join("scene.pipe");
        assert!(Command::new("mkfifo").arg(&pipe).status().expect("mkfifo runs").success());
        let mut child = desk.command(command);
        let child = child.stdout(Stdio::piped()).stderr(Stdio::piped());
        let child = child.spawn().expect("the program starts");
        // Returns once the program has opened the other end.
        let _writer = fs::OpenOptions::new().write(true).open(&pipe).expect("a reader");
        interrupt(&child);
        let output = child.wait_with_output().expect("it ends");
        assert_eq!(output.status.code(), Some(130), "{command}");
        let told = String::from_utf8(output.stderr).expect("text");
        assert_eq!(told, "stopped; nothing was written\n");
        assert_eq!(desk.names(), ["scene.pipe", "scene.toml"]);
    }
}

#[test]
fn the_first_interrupt_writes_the_picture_so_far() {
    let desk = Desk::new(SCENE);
    let (mut child, lines) = endless_render(&desk, "-o out.pfm --accel native --threads 1");
    interrupt(&child);
    let words: Vec<_> = lines.collect();
    assert_eq!(child.wait().expect("it ends").code(), Some(130), "{words:?}");
    let has = |start: &str| words.iter().any(|line| line.starts_with(start));
    assert!(has("stopping; press Ctrl-C again"), "{words:?}");
    assert!(has("wrote out.pfm, stopped after"), "{words:?}");
    let picture = desk.read("out.pfm");
    assert_eq!(picture.len(), "PF\n16 12\n-1.0\n".len() + 16 * 12 * 12);
    assert_eq!(desk.names(), ["out.pfm", "scene.toml"]);
}

/// A picture of two megapixels with layers that is stopped while its checkpoint is being written:
/// picture and checkpoint are whole and hold the same samples.
#[test]
fn a_large_picture_that_is_stopped_equals_its_checkpoint() {
    let desk = Desk::new(SCENE);
    let options = "--size 1920x1080 --layers direct,indirect,albedo,normal,depth -o a.exr -o a.png \
                   --checkpoint a.state --checkpoint-every 100ms --integrator direct --quiet \
                   --accel native --threads 2 --spp 1000000";
    let mut child =
        desk.command(&format!("render scene.toml {options}")).spawn().expect("it starts");
    wait_until("a checkpoint", || {
        assert!(child.try_wait().expect("it runs").is_none(), "it ended too soon");
        desk.path().join("a.state").exists()
    });
    interrupt(&child);
    assert_eq!(child.wait().expect("it ends").code(), Some(130));
    assert_eq!(desk.names(), ["a.exr", "a.png", "a.state", "scene.toml"]);
    // Stopped amid a pass, pixels differ in their number of samples.
    desk.run("merge a.state -o again.exr --allow-gaps --quiet").succeeds();
    desk.run("compare a.exr again.exr --max-rmse 0").succeeds();
}

/// The picture is so large that writing it takes hundreds of times the work that this test has to
/// do between the two interrupts, however that is shared out.
#[test]
fn the_second_interrupt_ends_the_program_at_once_and_cleanly() {
    let desk = Desk::new(SCENE);
    fs::write(desk.path().join("out.exr"), "old").expect("an older picture");
    let options = "-o out.exr --size 1920x1080 --layers direct,indirect,albedo,normal,depth \
                   --accel native --threads 1";
    let (mut child, mut lines) = endless_render(&desk, options);
    interrupt(&child);
    let stopping = lines.find(|line| line.starts_with("stopping;"));
    assert!(stopping.is_some());
    interrupt(&child);
    assert_eq!(child.wait().expect("it ends").code(), Some(130));
    assert_eq!(lines.count(), 0, "it has nothing more to say");
    assert_eq!(desk.names(), ["out.exr", "scene.toml"]);
    assert_eq!(desk.read("out.exr"), b"old");
}
