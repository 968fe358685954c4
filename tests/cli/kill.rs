//! The proof that long renders survive: hundreds of times the program is killed without warning, at
//! random instants, and goes on. What comes out in the end has the bytes of a render without a
//! break.

use std::fs;
use std::path::Path;
use std::process::{Child, Stdio};
use std::time::{Duration, Instant};

use photosphere::job::Checkpoint;
use rand::{RngExt, SeedableRng, rngs::StdRng};

use crate::desk::Desk;

const SCENE: &str = include_str!("kill.toml");

/// What is rendered, and how often it is killed: a number of samples, and a target of noise.
const TRIALS: [(&str, usize); 2] = [("--spp 263", 240), ("--noise 4%", 60)];

fn start(desk: &Desk, command: &str) -> Child {
    desk.command(command).stderr(Stdio::null()).spawn().expect("the program starts")
}

/// Lets the program run for so long and kills it; whether it had ended by itself. `from` is the
/// moment when it starts, or when it next writes what it keeps.
fn kill_after(mut child: Child, delay: Duration, from: &From<'_>) -> bool {
    if let From::NextCheckpoint(folder) = from {
        let written = || fs::metadata(folder.join("a.part")).and_then(|file| file.modified()).ok();
        let before = written();
        while written() == before && child.try_wait().expect("it can be asked").is_none() {
            std::thread::sleep(Duration::from_micros(200));
        }
    }
    std::thread::sleep(delay);
    // Also where it has just ended, there is a process until it is waited for.
    child.kill().expect("it can be killed");
    child.wait().expect("it ends").success()
}

/// From when on the time to a kill is counted.
enum From<'a> {
    Start,
    NextCheckpoint(&'a Path),
}

/// The samples that are kept. The file must be whole whenever the program was killed.
fn kept(folder: &Path) -> u64 {
    let path = folder.join("a.part");
    if !path.exists() {
        return 0;
    }
    Checkpoint::open(&path)
        .and_then(Checkpoint::into_film)
        .unwrap_or_else(|e| panic!("{e}"))
        .sample_count()
}

#[test]
fn killed_hundreds_of_times_a_render_gives_the_same_bytes() {
    let desk = Desk::new(SCENE);
    TRIALS.iter().for_each(|(goal, kills)| survives(&desk, goal, *kills));
}

/// Kills the render of a goal so often, and at least until it was finished once.
fn survives(desk: &Desk, goal: &str, most_kills: usize) {
    let folder = desk.path();
    let render = format!(
        "render scene.toml --accel native --no-run-figures --quiet -o a.exr {goal} \
         --checkpoint a.part --checkpoint-every 4ms"
    );
    let render = render.as_str();
    let began = Instant::now();
    assert!(start(desk, render).wait().expect("it ends").success());
    let whole_run = began.elapsed();
    let whole = desk.read("a.exr");
    let all = kept(folder);

    let mut rng = StdRng::seed_from_u64(2026);
    let (mut kills, mut in_the_middle, mut finished) = (0, 0, 0);
    while kills < most_kills || finished == 0 {
        for name in ["a.exr", "a.part"] {
            fs::remove_file(folder.join(name)).expect("it was there");
        }
        let mut before = 0;
        loop {
            // The same command again goes on, and so does `resume`.
            let goes_on = folder.join("a.part").exists() && rng.random();
            let child = start(desk, if goes_on { "resume a.part --quiet" } else { render });
            if kills >= most_kills {
                assert!(child.wait_with_output().expect("it ends").status.success());
                break;
            }
            // Half of the kills may come at any time, also while the program loads; the others meet
            // it at work, however long loading takes on a busy machine.
            let (from, longest) = match rng.random() {
                true => (From::Start, 0.4),
                false => (From::NextCheckpoint(folder), 0.1),
            };
            if kill_after(child, whole_run.mul_f64(rng.random_range(0.0..longest)), &from) {
                break;
            }
            kills += 1;
            let now = kept(folder);
            assert!(now >= before, "samples were lost: {now} of {before}");
            in_the_middle += usize::from(now > 0 && now < all);
            before = now;
        }
        finished += 1;
        assert!(desk.read("a.exr") == whole, "{goal}: {kills} kills");
        assert_eq!(kept(folder), all);
    }
    let met = format!("{goal}: {in_the_middle} of {kills} kills met a render at work");
    assert!(in_the_middle > most_kills / 5, "{met}");
    for name in ["a.exr", "a.part"] {
        fs::remove_file(folder.join(name)).expect("it was there");
    }
}
