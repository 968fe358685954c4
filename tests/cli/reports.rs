//! `info`, `doctor`, `crosscheck` and `bench`.

use photosphere::accel::KernelIsa;

use crate::desk::{Desk, SCENE};

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
    for part in
        ["spheres     2\n", "grass (diffuse)", "2 x 2 sub-pixels", "16 x 12 pixels", "1 to 250\n"]
    {
        assert!(text.contains(part), "{text}");
    }
}

/// A closed room of a classic highlight, 0.3 + 0.7 x 2 pi / 4 of the light at each bounce.
const ROOM: &str = r#"
format = 1
[image]
width = 4
height = 4
[camera]
position = [0, 0, 0.5]
look_at = [0, 0, 0]
[materials.wall]
type = "phong"
albedo = [0.3, 0.3, 0.3]
specular = [0.7, 0.7, 0.7]
exponent = 3
normalized = false
emission = [1, 1, 1]
[[spheres]]
center = [0, 0, 0]
radius = 1.0
material = "wall"
"#;

#[test]
fn a_material_that_makes_light_is_told_and_blamed() {
    let desk = Desk::new(ROOM);
    let told = desk.run("info scene.toml").succeeds().stdout;
    let note = "adds energy wall (reflects more than it receives: up to 1.40 of it)\n";
    assert!(told.contains(note), "{told}");
    assert_eq!(
        desk.run("info scene.toml --json").succeeds().json()["creates_energy"][0]["name"],
        "wall"
    );
    let fair = desk.run("info scene.toml --set materials.wall.normalized=true").succeeds().stdout;
    assert!(!fair.contains("adds energy"), "{fair}");
    let endless = desk.run("render scene.toml -o a.png --spp 64");
    endless.fails(3, &["a material may create energy", "photosphere info", "`max_depth`"]);
    desk.run("render scene.toml -o a.png --spp 16 --max-depth 4").succeeds();
}

#[test]
fn info_warns_of_a_camera_inside_an_opaque_sphere() {
    let expected = "warning: the camera is inside the opaque sphere `ball` and sees nothing else";
    let told = |scene: &str| {
        let told = Desk::new(scene).run("info scene.toml").succeeds();
        (told.stdout.contains("inside the opaque sphere `ball`"), told.stderr.contains(expected))
    };
    let ball = |center: &str, radius: &str| {
        SCENE.replace("[0.0, 1.0, 0.0]\nradius = 1.0", &format!("{center}\nradius = {radius}"))
    };
    assert_eq!(told(SCENE), (false, false));
    assert_eq!(told(&ball("[1.0, 2.0, 9.0]", "1.5")), (true, true), "nothing else is in there");
    assert_eq!(told(&ball("[0.0, 1.0, 0.0]", "100.0")), (true, false), "a room with a floor");
    let dome = "[[spheres]]\ncenter = [0, 0, 0]\nradius = 1000\nmaterial = \"grass\"\n";
    let under_a_dome = format!("{}\n{dome}", ball("[1.0, 2.0, 9.0]", "1.5"));
    assert_eq!(told(&under_a_dome), (true, true), "what is around it does not reach in");
}

#[test]
fn json_has_the_warnings_of_spheres_too() {
    let twin = &SCENE[SCENE.find("[[spheres]]\nname = \"ball\"").expect("the ball")..];
    let twin = &twin[..twin.find("[render]").expect("its end")];
    let desk = Desk::new(&format!("{SCENE}\n{}", twin.replace("ball", "twin")));
    let done = desk.run("render scene.toml -o a.png --accel native --json").succeeds();
    let warning = "1 sphere left out: an earlier row is the same sphere";
    assert!(done.stderr.contains(&format!("warning: {warning}\n")), "{}", done.stderr);
    assert_eq!(done.json()["warnings"], serde_json::json!([warning]));
}

#[test]
fn doctor_finds_this_build_healthy() {
    let done = Desk::new(SCENE).run("doctor").succeeds();
    assert_eq!(done.row("vectors"), KernelIsa::best().name());
    let text = done.stdout;
    let lacks_avx512 = cfg!(all(target_arch = "x86_64", not(has_avx512)));
    assert_eq!(text.contains("not in this build: AVX-512"), lacks_avx512, "{text}");
    for part in ["photosphere ", "threads ", "embree ", "--accel native ", "works\n"] {
        assert!(text.contains(part), "{text}");
    }
    for name in ["oidn", "ffmpeg", "python"] {
        assert!(text.lines().any(|line| line.starts_with(name)), "{name}: {text}");
    }
    if cfg!(not(has_embree)) {
        assert!(text.contains("apt-get install libembree-dev libclang-dev"), "{text}");
    }
}

#[test]
fn crosscheck_finds_every_intersector_right() {
    let desk = Desk::new(SCENE);
    let told = desk.run("crosscheck scene.toml --rays 3000 --dump rays.txt").succeeds();
    assert!(told.stdout.lines().all(|line| line.len() <= 80), "{}", told.stdout);
    let headings = ["passed over", "sides"];
    let parts = ["native ", "brute-force ", "every answer is within the stated tolerance"];
    for part in parts.into_iter().chain(headings) {
        assert!(told.stdout.contains(part), "{}", told.stdout);
    }
    let dump = String::from_utf8(desk.read("rays.txt")).expect("text");
    assert_eq!(dump.lines().count(), 1, "only the heading: {dump}");
    assert!(dump.starts_with("# rays relative to 0.0 0.0 0.0; "), "{dump}");
}

#[test]
fn crosscheck_is_right_at_the_limits_of_size() {
    let scene = SCENE.replace("radius = 250.0", "radius = 1e15");
    let scene = scene.replace("[0.0, -250.0, 0.0]", "[0.0, -1e15, 0.0]");
    Desk::new(&scene).run("crosscheck scene.toml --rays 3000").succeeds();
    let near =
        scene.replace("vertical_fov_degrees = 36.0", "vertical_fov_degrees = 170.0\nnear = 1e15");
    let refused = "puts the start of some camera rays out of reach";
    Desk::new(&near).run("crosscheck scene.toml --rays 3000").fails(3, &[refused]);
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
    let rate = &json["backends"][0]["rays"]["second_bounce"]["closest"]["rays_per_s"];
    assert!(rate.as_f64().is_some_and(|rate| rate > 1.0), "{json}");
}
