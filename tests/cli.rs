//! The program as its users meet it: what it prints, what it writes, and its exit codes.

#![cfg(unix)]

use std::fs;
use std::io::{BufRead, BufReader};
use std::os::fd::OwnedFd;
use std::os::unix::net::UnixStream;
use std::path::Path;
use std::process::{Child, Command, Stdio};

use tempfile::TempDir;

const PROGRAM: &str = env!("CARGO_BIN_EXE_photosphere");

/// A small scene without mistakes.
const SCENE: &str = r#"format = 1

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

/// A folder with `scene.toml` in it, where the program is run.
struct Desk(TempDir);

/// What the program did.
struct Outcome {
    code: Option<i32>,
    stdout: String,
    stderr: String,
}

impl Desk {
    fn new(scene: &str) -> Self {
        let folder = tempfile::tempdir().expect("a folder for the test");
        fs::write(folder.path().join("scene.toml"), scene).expect("the scene is written");
        Self(folder)
    }

    fn path(&self) -> &Path {
        self.0.path()
    }

    fn read(&self, name: &str) -> Vec<u8> {
        fs::read(self.path().join(name)).expect("the file is there")
    }

    /// The program with the arguments, which are separated by blanks.
    fn command(&self, arguments: &str) -> Command {
        // A test run may itself have been started with signals ignored; the program must not.
        let mut command = Command::new("env");
        command.arg("--default-signal=HUP,INT,TERM").arg(PROGRAM);
        command.args(arguments.split_whitespace()).current_dir(self.path());
        command
    }

    fn run(&self, arguments: &str) -> Outcome {
        outcome(&mut self.command(arguments))
    }

    fn names(&self) -> Vec<String> {
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
    fn succeeds(self) -> Self {
        assert_eq!(self.code, Some(0), "{}", self.stderr);
        self
    }

    /// The exit code and every part of the message.
    #[track_caller]
    fn fails(self, code: i32, parts: &[&str]) -> Self {
        assert_eq!(self.code, Some(code), "{}", self.stderr);
        for part in parts {
            assert!(self.stderr.contains(part), "`{part}` is not in\n{}", self.stderr);
        }
        assert_eq!(self.stdout, "");
        self
    }

    fn json(&self) -> serde_json::Value {
        serde_json::from_str(&self.stdout).expect("the standard output is one JSON value")
    }
}

fn outcome(command: &mut Command) -> Outcome {
    let output = command.output().expect("the program starts");
    Outcome {
        code: output.status.code(),
        stdout: String::from_utf8(output.stdout).expect("text"),
        stderr: String::from_utf8(output.stderr).expect("text"),
    }
}

/// A render of the scene with one piece of it replaced.
#[track_caller]
fn render_with(piece: &str, replacement: &str) -> Outcome {
    assert_eq!(SCENE.matches(piece).count(), 1, "`{piece}` names one place of the scene");
    let desk = Desk::new(&SCENE.replace(piece, replacement));
    let outcome = desk.run("render scene.toml -o out.png --accel native");
    assert_eq!(desk.names(), ["scene.toml"], "nothing is left behind");
    outcome
}

mod pictures {
    use super::*;

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
        let picture = |options: &str| {
            let desk = Desk::new(SCENE);
            desk.run(&format!("render scene.toml -o out.exr --accel native {options}")).succeeds();
            desk.read("out.exr")
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
}

mod mistakes_in_a_scene {
    use super::*;

    #[test]
    fn all_of_them_are_shown_with_place_excerpt_and_caret() {
        let scene = SCENE.replace("radius = 1.0", "radius = nan").replace("width", "widht");
        let shown = Desk::new(&scene).run("render scene.toml -o out.png").fails(3, &[]);
        let radius = r#"
error: `spheres.ball.radius` must be a number from 1e-15 to 1e15, not nan
    ,-[scene.toml:29:10]
 28 | center = [0.0, 1.0, 0.0]
 29 | radius = nan
    :          ^^^
 30 | material = "grass"
    `----
"#;
        let width = r"
error: `image.widht` is not a key of a scene
   ,-[scene.toml:4:1]
 3 | [image]
 4 | widht = 16
   : ^^|^^
   :   `-- unknown key
 5 | height = 12
   `----
  help: did you mean `width`?
";
        for expected in [radius.trim_start(), width.trim_start()] {
            assert!(shown.stderr.contains(expected), "{}", shown.stderr);
        }
    }

    #[test]
    fn sizes_numbers_and_names_are_checked() {
        let cases = [
            ("width = 16", "width = 0", "`image.width` must be a whole number from 1"),
            ("width = 16", "width = 1e3", "`image.width` must be"),
            ("radius = 1.0", "radius = nan", "`spheres.ball.radius` must be"),
            ("radius = 1.0", "radius = -1.0", "`spheres.ball.radius` must be"),
            ("[0.0, 1.0, 0.0]\nradius", "[0.0, inf, 0.0]\nradius", "`spheres.ball.center"),
            ("albedo", "albdeo", "did you mean `albedo`"),
            ("\"path\"", "\"pth\"", "did you mean `path`"),
            ("\"diffuse\"", "\"difuse\"", "did you mean `diffuse`"),
            ("format = 1", "format = 2", "format"),
            ("samples_per_pixel = 4", "samples_per_pixel = 0", "`render.samples_per_pixel` must"),
            ("[render]", "[render", "[scene.toml:32:8]"),
        ];
        for (piece, replacement, message) in cases {
            render_with(piece, replacement).fails(3, &["error: ", "[scene.toml:", message]);
        }
    }

    #[test]
    fn a_scene_without_spheres_is_refused() {
        let start = SCENE.find("[[spheres]]").expect("spheres");
        let end = SCENE.find("[render]").expect("render");
        let scene = [&SCENE[..start], &SCENE[end..]].concat();
        Desk::new(&scene).run("render scene.toml -o out.png").fails(3, &["no spheres"]);
    }

    #[test]
    fn samples_must_suit_the_sub_pixels_of_the_paper() {
        let desk = Desk::new(SCENE);
        let paper = "render scene.toml -o out.png --integrator paper";
        desk.run(&format!("{paper} --spp 6"))
            .fails(3, &["--spp 6", "a multiple of the 2 x 2 sub-pixels, not 6"]);
    }
}

mod tables {
    use super::*;

    const TABLE: &str = r#"
[[sphere_tables]]
file = "grains.f32"
columns = ["x", "y", "z", "radius"]
material = "grass"

[render]"#;

    fn desk(rows: &[f32], spare_bytes: usize) -> Desk {
        let desk = Desk::new(&SCENE.replace("[render]", TABLE));
        let mut bytes: Vec<u8> = rows.iter().flat_map(|value| value.to_le_bytes()).collect();
        bytes.extend(vec![0; spare_bytes]);
        fs::write(desk.path().join("grains.f32"), bytes).expect("the table is written");
        desk
    }

    #[test]
    fn a_table_adds_its_spheres() {
        let desk = desk(&[0.0, 3.0, 0.0, 0.5, 2.0, 3.0, 0.0, 0.5], 0);
        assert_eq!(desk.run("info scene.toml --json").succeeds().json()["spheres"], 4);
    }

    #[test]
    fn a_table_that_is_no_whole_number_of_rows_is_refused() {
        let parts = &["error: ", "grains.f32", "21 bytes", "1 row of 16 bytes"];
        desk(&[0.0, 3.0, 0.0, 0.5], 5).run("info scene.toml").fails(3, parts);
    }

    #[test]
    fn a_table_with_bad_numbers_is_refused() {
        for bad in [f32::NAN, 0.0, -1.0] {
            let desk = desk(&[0.0, 3.0, 0.0, 0.5, 2.0, 3.0, 0.0, bad], 0);
            desk.run("info scene.toml").fails(3, &["error: ", "grains.f32", "radius"]);
        }
    }

    #[test]
    fn a_missing_table_is_missed_where_the_scene_names_it() {
        let desk = desk(&[], 0);
        fs::remove_file(desk.path().join("grains.f32")).expect("it was there");
        desk.run("info scene.toml").fails(3, &["[scene.toml:34:8]", "grains.f32", "No such file"]);
    }
}

mod files {
    use super::*;

    #[test]
    fn a_scene_that_cannot_be_read_is_a_file_error() {
        let desk = Desk::new(SCENE);
        let message = "error: cannot read the scene `missing.toml`: No such file or directory";
        let commands = ["render missing.toml -o a.png", "info missing.toml", "bench missing.toml"];
        for command in commands.into_iter().chain(["crosscheck missing.toml"]) {
            desk.run(command).fails(4, &[message]);
        }
        fs::create_dir(desk.path().join("folder.toml")).expect("a folder");
        desk.run("info folder.toml")
            .fails(4, &["cannot read the scene `folder.toml`: it is a folder"]);
        fs::write(desk.path().join("bytes.toml"), [0xff, 0xfe]).expect("a file");
        desk.run("info bytes.toml").fails(4, &["`bytes.toml`: it is not UTF-8 text"]);
    }

    #[test]
    fn the_place_of_the_picture_is_checked_before_anything_else() {
        let desk = Desk::new(SCENE);
        fs::create_dir(desk.path().join("folder")).expect("a folder");
        fs::create_dir(desk.path().join("folder.png")).expect("a folder");
        let refused = |output: &str, code: i32, parts: &[&str]| {
            desk.run(&format!("render missing.toml -o {output}")).fails(code, parts);
        };
        let missing =
            "error: cannot write `no/a.png`: the folder `no` does not exist\n  help: create it";
        refused("no/a.png", 4, &[missing]);
        refused("folder.png", 4, &["error: cannot write `folder.png`: it is a folder"]);
        refused("folder", 4, &["it is a folder", "help: name a file in it", "folder/picture.png"]);
        refused("scene.toml/a.png", 4, &["nothing can be created in `scene.toml` (Not a dir"]);
        refused("out.bmp", 3, &["error: `out.bmp` does not end in .png, .exr, .hdr or .pfm\n"]);
        refused("out", 3, &["does not end in", "help: the ending chooses the format"]);
        if cfg!(target_os = "linux") {
            let message = "cannot write `/proc/a.png`: nothing can be created in `/proc` (No such \
                           file or directory (os error 2))\n";
            refused("/proc/a.png", 4, &[message]);
            refused("/dev/null", 3, &["`/dev/null` does not end in .png"]);
        }
        assert_eq!(desk.names(), ["folder", "folder.png", "scene.toml"]);
    }

    #[test]
    fn a_dump_that_cannot_be_written_is_a_file_error() {
        let desk = Desk::new(SCENE);
        desk.run("crosscheck scene.toml --accel native --rays 30 --dump no/rays.txt")
            .fails(4, &["error: cannot write `no/rays.txt`: No such file or directory"]);
    }
}

mod command_line {
    use super::*;

    #[test]
    fn wrong_usage_has_its_own_exit_code() {
        let desk = Desk::new(SCENE);
        let cases = [
            ("", "Usage: photosphere <COMMAND>"),
            ("rendr", "unrecognized subcommand 'rendr'"),
            ("render scene.toml", "--output <FILE>"),
            ("render -o a.png", "<SCENE>"),
            ("render scene.toml -o a.png --sp 4", "unexpected argument '--sp'"),
            ("render scene.toml -o a.png --spp many", "invalid value 'many' for '--spp <N>'"),
            ("render scene.toml -o a.png --size 640", "it must be WIDTHxHEIGHT, as in 640x480"),
            ("render scene.toml -o a.png --size 0x-3", "it must be WIDTHxHEIGHT"),
            ("render scene.toml -o a.png --set seed", "it must be KEY=VALUE, as in render.seed=7"),
            ("render scene.toml -o a.png --accel embre", "invalid value 'embre' for '--accel"),
            ("render scene.toml -o a.png --threads 0", "0 is not in 1..=4096"),
            ("render scene.toml -o a.png --threads -1", "-1 is not in 1..=4096"),
            ("crosscheck scene.toml --rays 0", "0 is not in 3..=10000000"),
            ("crosscheck scene.toml --rays -5", "-5 is not in 3..=10000000"),
            ("crosscheck scene.toml --seed -1", "-1 is not in 0..=9223372036854775807"),
            ("completions dosh", "invalid value 'dosh'"),
        ];
        for (arguments, message) in cases {
            desk.run(arguments).fails(2, &[message]);
        }
    }

    #[test]
    fn values_that_the_scene_refuses_are_shown_in_the_option() {
        let desk = Desk::new(SCENE);
        let cases = [
            ("--spp -1", ["must be a whole number from 1 to 4294967295, not -1", "--spp -1"]),
            ("--seed -1", ["must be a whole number from 0 to 2^63 - 1, not -1", "--seed -1"]),
            ("--seed 99999999999999999999", ["from 0 to 2^63 - 1, not 99999999999999999999", ""]),
            ("--max-depth -1", ["must be a whole number from 1", "not -1"]),
            ("--spp 0", ["`render.samples_per_pixel` must be", "[command line:1:7]"]),
            ("--size 0x48", ["`image.width` must be", " 1 | --size 0x48"]),
            ("--integrator pth", ["\"pth\"", "did you mean `path`"]),
            ("--sampler sobl", ["\"sobl\"", "did you mean `sobol`"]),
            ("--set imge.width=3", ["`imge` is not a key", "did you mean `image`"]),
            ("--set materials.gras.albedo=[1,1,1]", ["no material \"gras\"", "`grass`"]),
            ("--set render.seed=[1", ["the value is not TOML", " 1 | --set render.seed=[1"]),
            ("--max-depth 0", ["`render.max_depth` must be", "--max-depth 0"]),
        ];
        for (option, parts) in cases {
            desk.run(&format!("render scene.toml -o out.png {option}")).fails(3, &parts);
        }
        assert_eq!(desk.names(), ["scene.toml"]);
    }

    #[cfg(not(feature = "embree"))]
    #[test]
    fn embree_is_missed_with_advice() {
        let parts = &["error: this build has no `embree` intersector", "help: "];
        Desk::new(SCENE).run("render scene.toml -o out.png --accel embree").fails(5, parts);
    }

    #[test]
    fn help_teaches_with_examples_and_lists_the_exit_codes() {
        let desk = Desk::new(SCENE);
        let help = desk.run("--help").succeeds().stdout;
        for part in ["Examples:", "photosphere render", "Exit codes:", "130  stopped by Ctrl-C"] {
            assert!(help.contains(part), "{help}");
        }
        for command in ["render", "crosscheck", "bench", "info", "doctor", "completions", "man"] {
            let help = desk.run(&format!("{command} --help")).succeeds().stdout;
            assert!(help.contains(&format!("Examples:\n  photosphere {command}")), "{help}");
        }
        let version = desk.run("--version").succeeds().stdout;
        assert_eq!(version, format!("photosphere {}\n", env!("CARGO_PKG_VERSION")));
    }

    #[test]
    fn completions_and_manual_pages_name_the_commands() {
        let desk = Desk::new(SCENE);
        for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
            let script = desk.run(&format!("completions {shell}")).succeeds().stdout;
            assert!(script.contains("render") && script.contains("crosscheck"), "{shell}");
        }
        let page = desk.run("man").succeeds().stdout;
        for part in [".TH photosphere 1", "photosphere\\-render", "130  stopped by"] {
            assert!(page.contains(part), "{page}");
        }
        let page = desk.run("man render").succeeds().stdout;
        assert!(page.contains("photosphere\\-render") && page.contains("\\-\\-output"), "{page}");
        desk.run("man rendr").fails(3, &["error: there is no command `rendr`\n  help: "]);
    }
}

mod reports {
    use super::*;

    #[test]
    fn info_counts_what_is_in_the_scene() {
        let desk = Desk::new(SCENE);
        let info = desk.run("info scene.toml --json").succeeds().json();
        assert_eq!((&info["spheres"], &info["duplicates"]), (&2.into(), &0.into()));
        assert_eq!((&info["width"], &info["integrator"]), (&16.into(), &"path".into()));
        assert_eq!(info["bounds"]["high"], serde_json::json!([250.0, 2.0, 250.0]));
        assert_eq!(info["radius"], serde_json::json!({ "smallest": 1.0, "largest": 250.0 }));
        assert_eq!(info["tables"], 0);
        let text = desk.run("info scene.toml --set render.integrator=paper").succeeds().stdout;
        for part in [
            "spheres     2\n",
            "grass (diffuse)",
            "2 x 2 sub-pixels",
            "16 x 12 pixels",
            "1 to 250\n",
        ] {
            assert!(text.contains(part), "{text}");
        }
    }

    #[test]
    fn info_warns_of_spheres_that_rounding_moved() {
        let far = SCENE
            .replace("[0.0, 1.0, 0.0]\nradius = 1.0", "[1000000010.3, 0.3, 0.0]\nradius = 0.1");
        let told = Desk::new(&far).run("info scene.toml").succeeds();
        let told_all = format!("{}{}", told.stdout, told.stderr);
        let expected = "warning: rounding to f32 moved 1 sphere by more than 1 % of the radius";
        assert!(told.stderr.contains(expected), "{told_all}");
        assert!(told.stdout.contains("coarse      1 "), "{told_all}");
    }

    #[test]
    fn json_has_the_warnings_of_spheres_too() {
        let twin = &SCENE[SCENE.find("[[spheres]]\nname = \"ball\"").expect("the ball")..];
        let twin = &twin[..twin.find("[render]").expect("its end")];
        let desk = Desk::new(&format!("{SCENE}\n{}", twin.replace("ball", "twin")));
        let done = desk.run("render scene.toml -o a.png --accel native --json").succeeds();
        let warning = "1 sphere left out: an earlier row is the same sphere after rounding to f32";
        assert!(done.stderr.contains(&format!("warning: {warning}\n")), "{}", done.stderr);
        assert_eq!(done.json()["warnings"], serde_json::json!([warning]));
    }

    #[test]
    fn doctor_finds_this_build_healthy() {
        let text = Desk::new(SCENE).run("doctor").succeeds().stdout;
        for part in ["photosphere ", "threads ", "embree ", "--accel native ", "works\n"] {
            assert!(text.contains(part), "{text}");
        }
        if cfg!(not(feature = "embree")) {
            assert!(text.contains("apt-get install libembree-dev libclang-dev"), "{text}");
        }
    }

    #[test]
    fn crosscheck_finds_every_intersector_right() {
        let desk = Desk::new(SCENE);
        let told = desk.run("crosscheck scene.toml --rays 3000 --dump rays.txt").succeeds();
        let headings = ["passed over", "sides"];
        let parts = ["native ", "brute-force ", "every answer is within the stated tolerance"];
        for part in parts.into_iter().chain(headings) {
            assert!(told.stdout.contains(part), "{}", told.stdout);
        }
        let dump = String::from_utf8(desk.read("rays.txt")).expect("text");
        assert_eq!(dump.lines().count(), 1, "only the heading: {dump}");
        assert!(dump.starts_with("# rays relative to 0.0 -250.0 0.0; "), "{dump}");
    }

    #[test]
    fn crosscheck_is_right_at_the_limits_of_size() {
        let scene = SCENE.replace("radius = 250.0", "radius = 1e15");
        let scene = scene.replace("[0.0, -250.0, 0.0]", "[0.0, -1e15, 0.0]");
        Desk::new(&scene).run("crosscheck scene.toml --rays 3000").succeeds();
        let near = scene
            .replace("vertical_fov_degrees = 36.0", "vertical_fov_degrees = 170.0\nnear = 1e15");
        let refused = "puts the start of some camera rays out of reach";
        Desk::new(&near).run("crosscheck scene.toml --rays 3000").fails(3, &[refused]);
    }

    #[cfg(feature = "embree")]
    #[test]
    fn crosscheck_warns_of_spheres_too_small_for_their_distance() {
        let far = SCENE.replace("[1.0, 2.0, 9.0]", "[1e6, 2.0, 9e6]").replace("36.0", "1e-5");
        let told = Desk::new(&far).run("crosscheck scene.toml --rays 3000").succeeds();
        assert!(told.stderr.contains("% of the answers of `embree` to rays of"), "{}", told.stderr);
        assert!(!told.stderr.contains("answers of `native`"), "{}", told.stderr);
    }

    #[test]
    fn bench_measures_the_intersectors_asked_for() {
        let desk = Desk::new(SCENE);
        let bench = "bench scene.toml --accel native --accel brute-force";
        let text = desk.run(bench).succeeds().stdout;
        for part in ["native ", "brute-force ", "closest", "occluded"] {
            assert!(text.contains(part), "{text}");
        }
        let json = desk.run(&format!("{bench} --json")).succeeds().json();
        assert_eq!(json["backends"].as_array().map(Vec::len), Some(2));
        let rate = &json["backends"][0]["bounced"]["closest_rays_per_s"];
        assert!(rate.as_f64().is_some_and(|rate| rate > 1.0), "{json}");
    }
}

mod streams_and_signals {
    use super::*;

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

    /// Starts a render that would take years, and returns once it has told of finished samples.
    fn endless_render(desk: &Desk, options: &str) -> (Child, impl Iterator<Item = String> + use<>) {
        let arguments = format!("render scene.toml -o out.pfm --spp 4294967292 {options}");
        let mut child =
            desk.command(&arguments).stderr(Stdio::piped()).spawn().expect("the program starts");
        let stderr = child.stderr.take().expect("it was asked for");
        let mut lines = BufReader::new(stderr).lines().map(|line| line.expect("text"));
        let first = lines.next().expect("a line of progress");
        assert!(first.contains("samples/s") && first.ends_with(" left"), "{first}");
        (child, lines)
    }

    fn interrupt(child: &Child) {
        // The shell's own `kill`: the program of that name is not installed everywhere.
        let kill = format!("kill -INT {}", child.id());
        let status = Command::new("sh").args(["-c", &kill]).status().expect("a shell");
        assert!(status.success());
    }

    /// The scene is a pipe that never ends, so the program is sure to be reading it.
    #[test]
    fn an_interrupt_before_the_render_ends_the_program_at_once() {
        let commands =
            ["render scene.pipe -o out.pfm", "bench scene.pipe", "crosscheck scene.pipe"];
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
        let (mut child, lines) = endless_render(&desk, "--accel native --threads 1");
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

    #[test]
    fn the_second_interrupt_ends_the_program_at_once_and_cleanly() {
        let table = "[[sphere_tables]]\nfile = \"many.f32\"\nmaterial = \"grass\"\n\
                     columns = [\"x\", \"y\", \"z\", \"radius\"]\n[render]";
        let desk = Desk::new(&SCENE.replace("[render]", table));
        // So many spheres that the oracle needs seconds for the samples in flight.
        let row = |i: u32| [i as f32, 3.0, 0.0, 0.3];
        let bytes: Vec<u8> = (0..300_000).flat_map(row).flat_map(f32::to_le_bytes).collect();
        fs::write(desk.path().join("many.f32"), bytes).expect("the table is written");
        fs::write(desk.path().join("out.pfm"), "old").expect("an older picture");
        let (mut child, mut lines) = endless_render(&desk, "--accel brute-force --threads 1");
        interrupt(&child);
        let stopping = lines.find(|line| line.starts_with("stopping;"));
        assert!(stopping.is_some());
        interrupt(&child);
        assert_eq!(child.wait().expect("it ends").code(), Some(130));
        assert_eq!(lines.count(), 0, "it has nothing more to say");
        assert_eq!(desk.names(), ["many.f32", "out.pfm", "scene.toml"]);
        assert_eq!(desk.read("out.pfm"), b"old");
    }
}
