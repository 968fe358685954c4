//! A folder with a scene in it, where the program is run, and what it did.

use std::fs;
use std::path::Path;
use std::process::Command;
use std::time::{Duration, Instant};

use photosphere::job::Checkpoint;
use tempfile::TempDir;

pub(crate) const PROGRAM: &str = env!("CARGO_BIN_EXE_photosphere");

/// A small scene without mistakes.
pub(crate) const SCENE: &str = r#"format = 1

[image]
width = 16
height = 12

[camera]
position = [1.0, 2.0, 9.0]
look_at = [0.0, 1.5, 0.0]
up = [0.0, 1.0, 0.0]
vertical_fov_degrees = 36.0

[background]
radiance = [0.5, 0.6, 0.7]

[materials.grass]
type = "diffuse"
albedo = [0.2, 0.6, 0.2]

[[spheres]]
name = "ground"
center = [0.0, -250.0, 0.0]
radius = 250.0
material = "grass"

[[spheres]]
name = "ball"
center = [0.0, 1.0, 0.0]
radius = 1.0
material = "grass"

[render]
integrator = "path"
samples_per_pixel = 4
max_depth = 6
seed = 0
"#;

/// A folder where the program is run, often with `scene.toml` in it.
pub(crate) struct Desk(TempDir);

/// What the program did.
pub(crate) struct Outcome {
    pub(crate) code: Option<i32>,
    pub(crate) stdout: String,
    pub(crate) stderr: String,
}

impl Desk {
    pub(crate) fn empty() -> Self {
        Self(tempfile::tempdir().expect("a folder for the test"))
    }

    pub(crate) fn new(scene: &str) -> Self {
        let desk = Self::empty();
        fs::write(desk.path().join("scene.toml"), scene).expect("the scene is written");
        desk
    }

    /// With a scene of the repository.
    pub(crate) fn of_file(scene: &str) -> Self {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes").join(scene);
        Self::new(&fs::read_to_string(path).expect("our own scene"))
    }

    /// With so many spheres beside the small scene's that brute force needs seconds for a few
    /// samples.
    pub(crate) fn of_many_spheres() -> Self {
        let table = "[[sphere_tables]]\nfile = \"many.f32\"\nmaterial = \"grass\"\n\
                     columns = [\"x\", \"y\", \"z\", \"radius\"]\n[render]";
        let desk = Self::new(&SCENE.replace("[render]", table));
        let row = |i: u32| [i as f32, 3.0, 0.0, 0.3];
        let bytes: Vec<u8> = (0..300_000).flat_map(row).flat_map(f32::to_le_bytes).collect();
        fs::write(desk.path().join("many.f32"), bytes).expect("the table is written");
        desk
    }

    pub(crate) fn path(&self) -> &Path {
        self.0.path()
    }

    pub(crate) fn read(&self, name: &str) -> Vec<u8> {
        fs::read(self.path().join(name)).expect("the file is there")
    }

    /// The program with the arguments, which are separated by blanks.
    pub(crate) fn command(&self, arguments: &str) -> Command {
        let mut command = Command::new(PROGRAM);
        if cfg!(target_os = "linux") {
            // A test run may itself have been started with signals ignored; the program must not.
            command = Command::new("env");
            command.arg("--default-signal=HUP,INT,TERM").arg(PROGRAM);
        }
        command.args(arguments.split_whitespace()).current_dir(self.path());
        command
    }

    pub(crate) fn run(&self, arguments: &str) -> Outcome {
        outcome(&mut self.command(arguments))
    }

    pub(crate) fn names(&self) -> Vec<String> {
        let entries = fs::read_dir(self.path()).expect("the folder can be listed");
        let name = |entry: std::io::Result<fs::DirEntry>| {
            entry.expect("an entry").file_name().into_string().expect("a plain name")
        };
        let mut names: Vec<_> = entries.map(name).collect();
        names.sort();
        names
    }
}

impl Outcome {
    #[track_caller]
    pub(crate) fn succeeds(self) -> Self {
        assert_eq!(self.code, Some(0), "{}", self.stderr);
        self
    }

    /// The exit code and every part of the message.
    #[track_caller]
    pub(crate) fn fails(self, code: i32, parts: &[&str]) -> Self {
        assert_eq!(self.code, Some(code), "{}", self.stderr);
        for part in parts {
            assert!(self.stderr.contains(part), "`{part}` is not in\n{}", self.stderr);
        }
        assert_eq!(self.stdout, "");
        self
    }

    /// What `photosphere info` tells under this name.
    #[track_caller]
    pub(crate) fn row(&self, name: &str) -> &str {
        let is_it = |line: &&str| line.strip_prefix(name).is_some_and(|row| row.starts_with("  "));
        let line = self.stdout.lines().find(is_it);
        let line = line.unwrap_or_else(|| panic!("no row `{name}` in\n{}", self.stdout));
        line[name.len()..].trim_start()
    }

    pub(crate) fn json(&self) -> serde_json::Value {
        serde_json::from_str(&self.stdout).expect("the standard output is one JSON value")
    }
}

pub(crate) fn outcome(command: &mut Command) -> Outcome {
    let output = command.output().expect("the program starts");
    Outcome {
        code: output.status.code(),
        stdout: String::from_utf8(output.stdout).expect("text"),
        stderr: String::from_utf8(output.stderr).expect("text"),
    }
}

/// Waits until something is so. The bound is far above what the busiest machine needs: it only ends
/// a test that would wait for ever.
#[cfg(unix)]
#[track_caller]
pub(crate) fn wait_until(what: &str, mut condition: impl FnMut() -> bool) {
    let deadline = Instant::now() + Duration::from_secs(1800);
    while !condition() {
        assert!(Instant::now() < deadline, "{what}");
        std::thread::sleep(Duration::from_millis(5));
    }
}

/// Returns true once a checkpoint holds samples; the first may be written before there are any.
#[cfg(unix)]
pub(crate) fn holds_samples(checkpoint: &Path) -> bool {
    let film = Checkpoint::open(checkpoint).and_then(Checkpoint::into_film);
    film.is_ok_and(|film| film.sample_count() > 0)
}

/// Sends a signal with the shell's own `kill`: the program of that name is not installed
/// everywhere.
#[cfg(unix)]
#[track_caller]
pub(crate) fn send(signal: &str, process: u32) {
    let kill = format!("kill -{signal} {process}");
    assert!(Command::new("sh").args(["-c", &kill]).status().expect("a shell").success());
}

/// A render of the scene with one piece of it replaced.
#[track_caller]
pub(crate) fn render_with(piece: &str, replacement: &str) -> Outcome {
    assert_eq!(SCENE.matches(piece).count(), 1, "`{piece}` names one place of the scene");
    let desk = Desk::new(&SCENE.replace(piece, replacement));
    let outcome = desk.run("render scene.toml -o out.png --accel native");
    assert_eq!(desk.names(), ["scene.toml"], "nothing is left behind");
    outcome
}
