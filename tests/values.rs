//! Scenes and renders as values: what a program fills in is what a scene file says, arrays in memory
//! are the spheres that they hold, and a session can be looked at, stopped, resumed and extended.

use std::path::Path;
use std::time::Duration;

use photosphere::Error;
use photosphere::accel::{Backend, Choice};
use photosphere::color::Rgb;
use photosphere::film::{KINDS, Kind, Picture};
use photosphere::geometry::Sphere;
use photosphere::job::{Checkpoint, End, Job, Opening, Outcome, Reached, Session, run};
use photosphere::material::Metal;
use photosphere::math::DVec3;
use photosphere::output::WholeFile;
use photosphere::scene::data::{Shared, Strided, Values};
use photosphere::scene::description::{
    Description, Dome, Lens, NamedMaterial, Projection, SphereRow, Sun, Surface,
};
use photosphere::scene::settings::{FilterKind, Image, Render, SamplerKind};
use photosphere::scene::{Builder, Scene, Settings, SphereArrays, read_text};

/// A job for these settings on two threads.
fn job(settings: Settings, kinds: &[Kind]) -> Job {
    Job { threads: 2, accel: Choice::Only(Backend::Native), ..Job::of(settings) }.layers(kinds)
}

// A scene as text and as values.

const TEXT: &str = r#"
format = 1
[image]
width = 40
height = 30
filter = "gaussian"
[camera]
position = [0.0, 1.5, 8.0]
look_at = [0.0, 1.0, 0.0]
vertical_fov_degrees = 40.0
aperture_radius = 0.05
focus_distance = 7.5
near = 0.5
[background.gradient]
zenith = [0.2, 0.3, 0.6]
horizon = [0.7, 0.7, 0.8]
nadir = [0.1, 0.1, 0.1]
[background.sun]
direction = [1.0, 2.0, 1.0]
angular_diameter_degrees = 4.0
irradiance = [2.0, 1.9, 1.7]
[materials.ground]
type = "diffuse"
albedo = [0.5, 0.4, 0.3]
[materials.gold]
type = "conductor"
metal = "gold"
roughness = 0.3
[materials.glass]
type = "dielectric"
ior = 1.5
[materials.lamp]
type = "diffuse"
albedo = [0.0, 0.0, 0.0]
emission = [5.0, 4.0, 3.0]
[materials.veil]
type = "diffuse"
albedo = [0.9, 0.2, 0.2]
roughness = 0.5
opacity = 0.5
[[spheres]]
name = "ground"
center = [0.0, -100.0, 0.0]
radius = 100.0
material = "ground"
[[spheres]]
center = [-1.5, 1.0, 0.0]
radius = 1.0
material = "gold"
[[spheres]]
center = [1.5, 1.0, 0.0]
radius = 1.0
material = "glass"
[[spheres]]
center = [0.0, 3.0, -1.0]
radius = 0.5
material = "lamp"
[[spheres]]
center = [0.0, 0.6, 1.5]
radius = 0.6
material = "veil"
[render]
samples_per_pixel = 20
max_depth = 8
seed = 7
"#;

fn scene_of_values() -> Builder {
    let mut scene = Builder::new();
    scene.camera([0.0, 1.5, 8.0], [0.0, 1.0, 0.0]).sun([1.0, 2.0, 1.0], 4.0, [2.0, 1.9, 1.7]);
    let lens = Lens { radius: 0.05, focus_distance: 7.5, blades: 0, rotation_degrees: 0.0 };
    let camera = &mut scene.description.camera;
    camera.projection = Projection::Perspective { vertical_fov_degrees: 40.0, lens: Some(lens) };
    camera.near = 0.5;
    let [zenith, horizon, nadir] = [[0.2, 0.3, 0.6], [0.7, 0.7, 0.8], [0.1; 3]].map(Into::into);
    scene.description.background.dome = Dome::Gradient { zenith, horizon, nadir };

    let ground = scene.diffuse([0.5, 0.4, 0.3]);
    let gold = scene.metal(Metal::NAMED[0].1, 0.3);
    let glass = scene.glass(1.5);
    let lamp = scene.lamp([5.0, 4.0, 3.0]);
    let surface = Surface::Diffuse { albedo: [0.9, 0.2, 0.2].into(), roughness: 0.5 };
    let veil = scene.material(NamedMaterial { surface, opacity: 0.5, ..Default::default() });
    scene
        .sphere(ground, [0.0, -100.0, 0.0], 100.0)
        .sphere(gold, [-1.5, 1.0, 0.0], 1.0)
        .sphere(glass, [1.5, 1.0, 0.0], 1.0)
        .sphere(lamp, [0.0, 3.0, -1.0], 0.5)
        .sphere(veil, [0.0, 0.6, 1.5], 0.6);
    for (material, name) in
        scene.description.materials.iter_mut().zip(["ground", "gold", "glass", "lamp", "veil"])
    {
        material.name = name.to_owned();
    }
    scene.description.spheres[0].name = Some("ground".to_owned());
    scene
}

fn settings_of_values() -> Settings {
    let filter = FilterKind::Gaussian;
    let filter_radius = Image::usual_radius(filter);
    let image = Image { width: 40, height: 30, filter, filter_radius, ..Image::default() };
    let render = Render { samples_per_pixel: 20, max_depth: Some(8), seed: 7, ..Render::default() };
    Settings { image, render }
}

/// The file of a picture with all layers, but for what only this run took.
fn file_of(scene: &Scene, settings: Settings) -> Vec<u8> {
    let kinds = KINDS.map(|row| row.kind);
    let mut outcome = run(scene, &job(settings, &kinds), &()).expect("renders");
    assert_eq!(outcome.end, End::Finished);
    outcome.metadata.run = None;
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("a.exr");
    outcome.write(&file).expect("written");
    std::fs::read(file).expect("read")
}

#[test]
fn a_scene_of_values_has_the_file_of_the_same_scene_from_text() {
    let read = read_text("test.toml", TEXT, Path::new(""), &[]).expect("a good scene");
    let (scene, settings) = read.build().expect("a good scene");
    let values = scene_of_values();
    assert_eq!(*scene.description(), values.description);
    assert_eq!(settings, settings_of_values());
    let built = values.build().expect("a good scene");
    assert_eq!(built.identity(), scene.identity());
    let (of_text, of_values) = (file_of(&scene, settings), file_of(&built, settings_of_values()));
    assert!(of_text == of_values, "the same bytes");
}

// Arrays.

/// Numbers that f32 can hold, or not.
fn balls(is_f64: bool) -> Vec<Sphere> {
    let more = if is_f64 { 1e-9 } else { 0.0 };
    let ball = |i: u32| {
        let at = |step: u32, range: u32| f64::from(i * step % range) / 16.0 + more;
        let center = DVec3::new(at(29, 101) - 3.0, at(17, 67) - 2.0, at(13, 43) - 3.0);
        Sphere { center, radius: f64::from(1 + i % 5) / 16.0 + more }
    };
    (0..60).map(ball).collect()
}

fn color_of(row: usize) -> [f32; 3] {
    [row % 4, row % 3, row % 5].map(|part| part as f32 / 8.0 + 0.25)
}

fn id_of(row: usize) -> u32 {
    1000 - 7 * row as u32
}

fn view() -> Builder {
    let mut scene = Builder::new();
    scene.camera([0.0, 0.0, 12.0], [0.0; 3]).background([0.9, 1.0, 1.1]);
    scene
}

fn one_by_one(balls: &[Sphere], colors: bool) -> Scene {
    let mut scene = view();
    let grey = scene.diffuse([0.5; 3]);
    for (row, ball) in balls.iter().enumerate() {
        let material = if colors { scene.diffuse(color_of(row)) } else { grey };
        scene.sphere(material, ball.center, ball.radius);
    }
    scene.build().expect("good spheres")
}

fn of_arrays(arrays: SphereArrays) -> Result<Scene, Error> {
    let mut scene = view();
    let grey = scene.diffuse([0.5; 3]);
    scene.spheres(grey, arrays).build()
}

fn picture(scene: &Scene) -> Picture {
    let mut settings = Settings::default();
    (settings.image.width, settings.image.height) = (32, 24);
    settings.render.samples_per_pixel = 4;
    let kinds = [Kind::SphereId, Kind::Variance];
    run(scene, &job(settings, &kinds), &()).expect("renders").picture
}

fn sphere_ids(picture: &Picture) -> &[u32] {
    let plane = picture.planes.iter().find(|plane| plane.name == "sphere_id").expect("asked for");
    match &plane.values {
        photosphere::film::Values::Whole(ids) => ids,
        other => panic!("{other:?}"),
    }
}

/// Fails unless both are the same spheres in the same order, and look the same.
fn must_be_same(name: &str, a: &Scene, b: &Scene) {
    let (of_a, of_b) = (a.spheres(), b.spheres());
    assert_eq!(of_a.origin(), of_b.origin(), "{name}");
    assert_eq!(of_a.particles(), of_b.particles(), "{name}");
    assert_eq!(of_a.giants(), of_b.giants(), "{name}");
    assert_eq!(of_a.rows(), of_b.rows(), "{name}");
    assert!(picture(a) == picture(b), "{name}: pictures");
}

/// An array with a first number, a stride and a length.
fn strided(values: Values, first: usize, stride: isize, len: usize) -> Strided {
    Strided { values, first, stride, len }
}

fn f32s(values: Vec<f32>) -> Values {
    Values::F32(Shared::new(values))
}

fn f64s(values: Vec<f64>) -> Values {
    Values::F64(Shared::new(values))
}

/// The numbers of each sphere: x, y, z and the radius.
fn rows(balls: &[Sphere]) -> Vec<[f64; 4]> {
    balls.iter().map(|ball| [ball.center.x, ball.center.y, ball.center.z, ball.radius]).collect()
}

fn narrow<const N: usize>(rows: &[[f64; N]]) -> Vec<[f32; N]> {
    rows.iter().map(|row| row.map(|number| number as f32)).collect()
}

/// The arrays of four numbers of each sphere.
fn arrays([x, y, z, radius]: [Strided; 4]) -> SphereArrays {
    SphereArrays { center: [x, y, z], radius, ..SphereArrays::default() }
}

/// A scene's numbers in one array of rows with something between them, from the last row to the first.
fn backwards(rows: &[[f64; 4]], array: impl Fn(Vec<f64>) -> Values) -> SphereArrays {
    let padded = rows.iter().rev().flat_map(|row| [&row[..], &[f64::NAN, -1.0]].concat());
    let (values, len) = (array(padded.collect()), rows.len());
    arrays(std::array::from_fn(|column| strided(values.clone(), column + 6 * (len - 1), -6, len)))
}

fn columns(rows: &[[f64; 4]], array: impl Fn(Vec<f64>) -> Values) -> SphereArrays {
    let column = |column: usize| rows.iter().map(|row| row[column]).collect::<Vec<f64>>();
    arrays(std::array::from_fn(|at| strided(array(column(at)), 0, 1, rows.len())))
}

fn to_f32s(values: Vec<f64>) -> Values {
    f32s(values.into_iter().map(|value| value as f32).collect())
}

/// The same spheres in every layout that arrays may have.
fn layouts(balls: &[Sphere], is_f64: bool) -> Vec<(&'static str, SphereArrays)> {
    let rows = rows(balls);
    let centers: Vec<[f64; 3]> = balls.iter().map(|ball| ball.center.to_array()).collect();
    let radii: Vec<f64> = balls.iter().map(|ball| ball.radius).collect();
    let mut all = vec![
        ("f64 rows", arrays(Strided::columns_of(rows.clone()))),
        ("f64 centers", SphereArrays::of_centers(centers.clone(), radii.clone())),
        ("f64 columns", columns(&rows, f64s)),
        ("f64 backwards", backwards(&rows, f64s)),
    ];
    if !is_f64 {
        let narrow_radii: Vec<f32> = radii.iter().map(|&radius| radius as f32).collect();
        let mixed = SphereArrays {
            radius: Strided::of(narrow_radii.clone()),
            ..SphereArrays::of_centers(centers.clone(), radii)
        };
        all.extend([
            ("f32 rows", SphereArrays::of_rows(narrow(&rows))),
            ("f32 centers", SphereArrays::of_centers(narrow(&centers), narrow_radii)),
            ("f32 columns", columns(&rows, to_f32s)),
            ("f32 backwards", backwards(&rows, to_f32s)),
            ("f64 centers and f32 radii", mixed),
        ]);
    }
    all
}

#[test]
fn arrays_of_any_layout_are_the_spheres_one_by_one() {
    for is_f64 in [false, true] {
        let balls = balls(is_f64);
        let expected = one_by_one(&balls, false);
        for (name, arrays) in layouts(&balls, is_f64) {
            assert_eq!(arrays.len(), balls.len());
            must_be_same(name, &of_arrays(arrays).expect("good arrays"), &expected);
        }
    }
}

#[test]
fn one_number_can_be_that_of_all_spheres() {
    let mut balls = balls(false);
    for ball in &mut balls {
        ball.center.y = 0.5;
        ball.radius = 0.25;
    }
    let expected = one_by_one(&balls, false);
    let rows = rows(&balls);
    for array in [f64s, to_f32s] {
        let mut arrays = columns(&rows, array);
        arrays.center[1] = strided(array(vec![9.0, 0.5]), 1, 0, rows.len());
        arrays.radius = Strided::all(0.25f32, rows.len());
        must_be_same("stride 0", &of_arrays(arrays).expect("good arrays"), &expected);
    }
}

#[test]
fn spheres_of_an_array_can_have_colors() {
    let balls = balls(false);
    let expected = one_by_one(&balls, true);
    let colors: Vec<[f32; 3]> = (0..balls.len()).map(color_of).collect();
    let wide: Vec<[f64; 3]> = colors.iter().map(|color| color.map(f64::from)).collect();
    let flat = colors.iter().rev().flatten().copied().collect();
    let backwards = {
        let (values, len) = (f32s(flat), colors.len());
        std::array::from_fn(|at| strided(values.clone(), at + 3 * (len - 1), -3, len))
    };
    for (name, arrays) in layouts(&balls, false) {
        for arrays in [
            arrays.clone().with_colors(colors.clone()),
            arrays.clone().with_colors(wide.clone()),
            SphereArrays { color: Some(backwards.clone()), ..arrays },
        ] {
            must_be_same(name, &of_arrays(arrays).expect("good arrays"), &expected);
        }
    }
}

#[test]
fn the_layer_of_ids_shows_the_numbers_of_an_array() {
    let balls = balls(false);
    let ids: Vec<u32> = (0..balls.len()).map(id_of).collect();
    let plain = picture(&one_by_one(&balls, false));
    let numbered = |&row: &u32| if row == u32::MAX { row } else { id_of(row as usize) };
    let expected: Vec<u32> = sphere_ids(&plain).iter().map(numbered).collect();
    assert!(expected.iter().any(|&id| id != u32::MAX));
    for (name, arrays) in layouts(&balls, false) {
        let scene = of_arrays(arrays.with_ids(ids.clone())).expect("good arrays");
        let shown = picture(&scene);
        assert_eq!(sphere_ids(&shown), expected, "{name}");
        assert_eq!(shown.direct, plain.direct, "{name}");
        assert_eq!(scene.name_of_row(3), format!("table 0:{}", id_of(3)), "{name}");
    }
}

/// Spheres one by one, and tables in f32, in f64 and in f32 again, the middle one with ids.
#[test]
fn several_tables_lie_behind_each_other() {
    let balls = balls(false);
    let expected = one_by_one(&balls, true);
    let mut scene = view();
    scene.diffuse([0.5; 3]);
    for (row, ball) in balls[..10].iter().enumerate() {
        let own = scene.diffuse(color_of(row));
        scene.sphere(own, ball.center, ball.radius);
    }
    let grey = scene.diffuse([0.5; 3]);
    let colors = |from: usize, to: usize| (from..to).map(color_of).collect::<Vec<_>>();
    let narrow_rows = |from: usize, to: usize| narrow(&rows(&balls[from..to]));
    let ids: Vec<u32> = (20..45).map(id_of).collect();
    let wide = columns(&rows(&balls[20..45]), f64s);
    scene
        .spheres(grey, SphereArrays::of_rows(narrow_rows(10, 20)).with_colors(colors(10, 20)))
        .spheres(grey, wide.with_colors(colors(20, 45)).with_ids(ids))
        .spheres(grey, SphereArrays::of_rows(narrow_rows(45, 60)).with_colors(colors(45, 60)));
    let scene = scene.build().expect("good arrays");
    assert_eq!(scene.spheres().particles(), expected.spheres().particles());
    assert_eq!(scene.spheres().rows(), expected.spheres().rows());
    let (shown, plain) = (picture(&scene), picture(&expected));
    assert_eq!(shown.direct, plain.direct);
    assert_eq!(shown.indirect, plain.indirect);
    let in_the_middle = |row: u32| (20..45).contains(&row);
    let numbered = |&row: &u32| if in_the_middle(row) { id_of(row as usize) } else { row };
    let ids: Vec<u32> = sphere_ids(&plain).iter().map(numbered).collect();
    assert_eq!(sphere_ids(&shown), ids);
    assert!(sphere_ids(&plain).iter().any(|&row| in_the_middle(row)));
}

/// Four good spheres, with one thing changed.
fn flawed(change: impl FnOnce(&mut SphereArrays)) -> String {
    let mut arrays = SphereArrays::of_rows(vec![[0.0, 1.0, 2.0, 0.5]; 4])
        .with_colors(vec![[0.5f32; 3]; 4])
        .with_ids(vec![1, 2, 3, 4]);
    change(&mut arrays);
    let error = of_arrays(arrays).expect_err("it must be refused");
    error.to_string()
}

#[test]
fn arrays_that_cannot_be_are_refused() {
    let good = f32s(vec![0.5; 4]);
    let array = |first, stride, len| strided(good.clone(), first, stride, len);
    let is_refused = |words: &str, change: &dyn Fn(&mut SphereArrays)| {
        let told = flawed(change);
        assert!(told.contains(words), "{told:?} does not tell {words:?}");
    };
    is_refused("4 radii, but 3 numbers in its column x", &|a| a.center[0] = array(0, 1, 3));
    is_refused("2 radii, but 4 numbers in its column y", &|a| a.radius = array(0, 1, 2));
    is_refused("4 radii, but 1 numbers in its column g", &|a| {
        a.color.as_mut().expect("colours")[1] = array(0, 1, 1);
    });
    is_refused("4 radii, but 3 ids", &|a| a.ids = Some(Shared::new(vec![1, 2, 3])));
    is_refused("has no spheres", &|a| *a = SphereArrays::default());
    for (first, stride) in [(1, 1), (4, 0), (0, 2), (2, -1), (0, -1), (usize::MAX, 1)] {
        let beyond = array(first, stride, 4);
        is_refused("column z of", &|a| a.center[2] = beyond.clone());
        is_refused("reaches beyond its array", &|a| a.radius = beyond.clone());
    }
    for stride in [isize::MAX, isize::MIN] {
        is_refused("reaches beyond its array", &|a| a.center[2] = array(0, stride, 4));
    }
    is_refused("the id 2^32 - 1", &|a| a.ids = Some(Shared::new(vec![1, 2, u32::MAX, 4])));
}

#[test]
fn numbers_that_cannot_be_are_refused() {
    let is_refused = |column: &str, number: f64| {
        for array in [f64s, to_f32s] {
            let bad = strided(array(vec![0.5, 0.5, number, 0.5]), 0, 1, 4);
            let told = flawed(|arrays| {
                let color = arrays.color.as_mut().expect("colours");
                match column {
                    "x" => arrays.center[0] = bad,
                    "radius" => arrays.radius = bad,
                    _ => color[2] = bad,
                }
            });
            let words = format!("row 2 (the first is 0) has {column} = ");
            assert!(told.contains(&words) && told.contains("it must be from"), "{told}");
        }
    };
    for number in [f64::NAN, f64::INFINITY, -f64::INFINITY, 1e30] {
        is_refused("x", number);
    }
    for number in [f64::NAN, f64::INFINITY, -0.5, 0.0] {
        is_refused("radius", number);
    }
    for number in [f64::NAN, f64::INFINITY, -0.25, 1.5] {
        is_refused("b", number);
    }
}

/// However many there are said to be.
#[test]
fn more_spheres_than_a_scene_can_hold_are_refused() {
    for (len, tables) in [(usize::MAX, 1), (usize::MAX, 2), (usize::MAX / 2 + 1, 2), (1 << 32, 1)] {
        let mut scene = view();
        let grey = scene.diffuse([0.5; 3]);
        scene.sphere(grey, [0.0; 3], 1.0);
        for _ in 0..tables {
            let [x, y, z, radius] = [(); 4].map(|()| Strided::all(0.5f32, len));
            scene.spheres(grey, arrays([x, y, z, radius]));
        }
        let told = scene.build().expect_err("too many").to_string();
        assert!(told.contains("than the 4294967293 that a scene can hold"), "{told}");
    }
}

#[test]
fn mistakes_of_values_are_told_all_at_once() {
    let mut scene = view();
    let grey = scene.diffuse([0.5; 3]);
    scene.sphere(grey, [0.0; 3], -1.0).sphere(grey, [f64::NAN, 0.0, 0.0], 1.0);
    let material = 7;
    scene.description.spheres.push(SphereRow { radius: 1.0, material, ..SphereRow::default() });
    let direction = DVec3::ZERO;
    let sun = Sun { direction, angular_diameter_degrees: 1.0, irradiance: [1.0; 3].into() };
    scene.description.background.sun = Some(sun);
    let error = scene.build().expect_err("nothing is right");
    assert_eq!(error.mistakes().len(), 4, "{error}");
}

#[test]
fn values_that_are_no_numbers_are_refused() {
    let places: [fn(&mut Description, f64); 14] = [
        |scene, x| scene.camera.position.x = x,
        |scene, x| scene.camera.look_at.y = x,
        |scene, x| scene.camera.up.z = x,
        |scene, x| scene.camera.near = x,
        |scene, x| scene.camera.projection = Projection::Orthographic { height: x },
        |scene, x| scene.background.up.x = x,
        |scene, x| scene.background.dome = Dome::Constant { radiance: Rgb::splat(x as f32) },
        |scene, x| scene.spheres[1].center.x = x,
        |scene, x| scene.spheres[1].center.y = x,
        |scene, x| scene.spheres[1].center.z = x,
        |scene, x| scene.spheres[1].radius = x,
        |scene, x| scene.materials[3].emission.y = x as f32,
        |scene, x| scene.materials[4].opacity = x,
        |scene, x| scene.materials[0].surface = Surface::Mirror { reflectance: Rgb::X * x as f32 },
    ];
    for (index, change) in places.into_iter().enumerate() {
        for x in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            let mut scene = scene_of_values();
            change(&mut scene.description, x);
            let mistakes = scene.build().err().map_or(0, |error| error.mistakes().len());
            assert!(mistakes > 0, "{x} in place {index} is accepted");
        }
    }
}

// Sessions.

/// Balls from an array over a ground, with light from everywhere: built anew each time.
fn session_scene() -> Scene {
    let mut scene = view();
    let grey = scene.diffuse([0.5; 3]);
    scene.sphere(grey, [0.0, -105.0, 0.0], 100.0);
    let colors = (0..60).map(color_of).collect();
    scene.spheres(grey, SphereArrays::of_rows(narrow(&rows(&balls(false)))).with_colors(colors));
    scene.build().expect("good spheres")
}

fn session_job(samples: u32) -> Job {
    let mut settings = Settings::default();
    (settings.image.width, settings.image.height) = (48, 36);
    settings.render.samples_per_pixel = samples;
    settings.render.sampler = SamplerKind::Sobol;
    job(settings, &[Kind::SphereId, Kind::Variance, Kind::SampleCount])
}

const SAMPLES: u32 = 800;

fn opened(samples: u32) -> Session {
    Session::new(&session_scene(), session_job(samples), Opening::default()).expect("opens")
}

fn resumed(checkpoint: &Path, samples: u32) -> Session {
    let checkpoint = Checkpoint::open(checkpoint).expect("a checkpoint");
    let job = session_job(samples);
    Session::resume(&session_scene(), job, checkpoint, Opening::default()).expect("resumes")
}

fn finished(session: &Session) -> Outcome {
    let reached = session.run(&()).expect("renders");
    assert_eq!(reached.end, End::Finished);
    session.outcome(reached)
}

/// Fails unless the picture and what is known of it are the same, whatever happened in between.
fn must_be_outcome(what: &str, found: &Outcome, expected: &Outcome) {
    assert!(found.picture == expected.picture, "{what}: another picture");
    assert_eq!(found.samples, expected.samples, "{what}");
    assert_eq!(found.error, expected.error, "{what}");
}

/// Runs a session on another thread, and looks at it as soon as there is something to be seen.
fn looked_at(session: &Session, look: impl FnOnce()) -> Reached {
    std::thread::scope(|scope| {
        let running = scope.spawn(|| session.run(&()));
        while session.progress().samples_done == 0 {
            assert!(!running.is_finished(), "it ended without a sample");
            std::thread::sleep(Duration::from_millis(1));
        }
        look();
        running.join().expect("no panic").expect("renders")
    })
}

#[test]
fn a_session_can_be_looked_at_while_it_runs_and_changes_nothing_by_that() {
    let expected = finished(&opened(SAMPLES));
    let session = opened(SAMPLES);
    assert_eq!((session.progress().samples_done, session.error()), (0, None));
    let reached = looked_at(&session, || {
        let mut last = 0;
        for _ in 0..5 {
            let progress = session.progress();
            assert!(progress.samples_done >= last && progress.rate > 0.0);
            assert_eq!(progress.samples_total, 48 * 36 * u64::from(SAMPLES));
            last = progress.samples_done;
            let picture = session.picture();
            assert_eq!((picture.width, picture.height, picture.non_finite()), (48, 36, 0));
            assert_eq!(sphere_ids(&picture), sphere_ids(&expected.picture));
            assert!(picture.mean().y > 0.0 && session.preview().mean().y > 0.0);
            assert!(session.error().is_none_or(|error| error > 0.0));
            assert!(session.metadata().run.is_some());
        }
    });
    assert_eq!(reached.end, End::Finished);
    assert!(session.error().is_some_and(|error| error > 0.0));
    must_be_outcome("looked at", &session.outcome(reached), &expected);
}

#[test]
fn a_stopped_session_is_resumed_to_the_same_bits_and_extended() {
    let expected = finished(&opened(SAMPLES));
    let folder = tempfile::tempdir().expect("a folder");
    let [on_the_way, at_the_end, whole] =
        ["a.part", "b.part", "c.part"].map(|name| folder.path().join(name));
    let write = |session: &Session, path: &Path, reached: Option<&Reached>| {
        let file = WholeFile::new(path).expect("can be written");
        session.write_checkpoint(&file, reached).expect("written");
    };

    let session = opened(SAMPLES);
    let reached = looked_at(&session, || {
        write(&session, &on_the_way, None);
        session.stop();
    });
    let done = session.progress().samples_done;
    assert!(reached.end == End::Stopped && done > 0 && done < expected.samples, "{reached:?}");
    write(&session, &at_the_end, Some(&reached));
    let stopped = session.outcome(reached);
    assert_eq!(stopped.samples, done);

    for path in [&on_the_way, &at_the_end] {
        let session = resumed(path, SAMPLES);
        assert!(session.progress().samples_done > 0);
        let outcome = finished(&session);
        must_be_outcome("resumed", &outcome, &expected);
        // A checkpoint on the way may tell of fewer rays than were traced for its samples.
        assert!(outcome.rays == expected.rays || path == &on_the_way);
        write(&session, &whole, Some(&Reached { end: End::Finished, noise: None, error: None }));
    }
    // More samples than were asked for at first, from half-way and from the end.
    let more = finished(&opened(SAMPLES + 100));
    assert!(more.picture != expected.picture);
    for path in [&at_the_end, &whole] {
        must_be_outcome("extended", &finished(&resumed(path, SAMPLES + 100)), &more);
    }
    // Fewer than there are.
    let checkpoint = Checkpoint::open(&whole).expect("a checkpoint");
    let fewer = Session::resume(&session_scene(), session_job(16), checkpoint, Opening::default());
    let told = fewer.err().expect("it has more").to_string();
    assert!(told.contains("it has samples up to 800, more than the 16"), "{told}");
}

#[test]
fn a_checkpoint_of_another_scene_is_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a.part");
    let session = opened(16);
    let reached = session.run(&()).expect("renders");
    let file = WholeFile::new(&path).expect("can be written");
    session.write_checkpoint(&file, Some(&reached)).expect("written");
    // One number of one array differs.
    let mut other = balls(false);
    other[17].radius *= 2.0;
    let other = of_arrays(SphereArrays::of_rows(narrow(&rows(&other)))).expect("good arrays");
    let checkpoint = Checkpoint::open(&path).expect("a checkpoint");
    let told = Session::resume(&other, session_job(16), checkpoint, Opening::default());
    let told = told.err().expect("it is of another scene").to_string();
    assert!(told.contains("it is of another render"), "{told}");
}
