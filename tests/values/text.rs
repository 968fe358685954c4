//! One scene as text and as values, and values that cannot be a scene.

use std::path::Path;

use photosphere::color::Rgb;
use photosphere::film::AOVS;
use photosphere::image_io::Picture;
use photosphere::job::{StopReason, run};
use photosphere::material::Metal;
use photosphere::math::DVec3;
use photosphere::scene::data::{Column, SphereData};
use photosphere::scene::description::{
    EnvironmentDescription, LensDescription, MaterialDescription, ProjectionDescription,
    SceneDescription, SphereDescription, SphereTable, SunDescription, SurfaceModel,
};
use photosphere::scene::settings::{FilterKind, ImageSettings, RenderSettings};
use photosphere::scene::{Scene, SceneBuilder, SceneFile, Settings, SphereArrays, read_text};

use super::{job, view};

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
[[sphere_tables]]
name = "grains"
file = "tests/data/grains.f32"
columns = ["x", "y", "z", "radius", "r", "g", "b"]
material = "ground"
[render]
samples_per_pixel = 20
max_depth = 8
seed = 7
"#;

/// The table of the text.
const FILE: &str = "tests/data/grains.f32";

/// The columns of that table.
const COLUMNS: [Column; 7] = {
    use Column::{Blue, Green, Radius, Red, X, Y, Z};
    [X, Y, Z, Radius, Red, Green, Blue]
};

/// The rows of that table.
fn grains() -> Vec<[f32; 7]> {
    let bytes = std::fs::read(Path::new(FILE)).expect("a table of ours");
    let values: Vec<f32> =
        bytes.chunks_exact(4).map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]])).collect();
    values.chunks_exact(7).map(|row| row.try_into().expect("seven numbers")).collect()
}

fn scene_of_values() -> SceneBuilder {
    let mut scene = SceneBuilder::new();
    scene.camera([0.0, 1.5, 8.0], [0.0, 1.0, 0.0]).sun([1.0, 2.0, 1.0], 4.0, [2.0, 1.9, 1.7]);
    let lens =
        LensDescription { radius: 0.05, focus_distance: 7.5, blades: 0, rotation_degrees: 0.0 };
    let camera = &mut scene.description.camera;
    camera.projection =
        ProjectionDescription::Perspective { vertical_fov_degrees: 40.0, lens: Some(lens) };
    camera.near = 0.5;
    let [zenith, horizon, nadir] = [[0.2, 0.3, 0.6], [0.7, 0.7, 0.8], [0.1; 3]].map(Into::into);
    scene.description.background.dome = EnvironmentDescription::Gradient { zenith, horizon, nadir };

    let ground = scene.diffuse([0.5, 0.4, 0.3]);
    let gold = scene.metal(Metal::NAMED[0].1, 0.3);
    let glass = scene.glass(1.5);
    let emitter = scene.emitter([5.0, 4.0, 3.0]);
    let surface = SurfaceModel::Diffuse { albedo: [0.9, 0.2, 0.2].into(), roughness: 0.5 };
    let veil = scene.material(MaterialDescription { surface, opacity: 0.5, ..Default::default() });
    scene
        .sphere(ground, [0.0, -100.0, 0.0], 100.0)
        .sphere(gold, [-1.5, 1.0, 0.0], 1.0)
        .sphere(glass, [1.5, 1.0, 0.0], 1.0)
        .sphere(emitter, [0.0, 3.0, -1.0], 0.5)
        .sphere(veil, [0.0, 0.6, 1.5], 0.6);
    for (material, name) in
        scene.description.materials.iter_mut().zip(["ground", "gold", "glass", "lamp", "veil"])
    {
        material.name = name.to_owned();
    }
    scene.description.spheres[0].name = Some("ground".to_owned());
    scene.description.tables.push(SphereTable {
        name: Some("grains".to_owned()),
        data: SphereData::file(FILE, COLUMNS),
        ..SphereTable::default()
    });
    scene
}

fn settings_of_values() -> Settings {
    let filter = FilterKind::Gaussian;
    let filter_radius = ImageSettings::default_filter_radius(filter);
    let image =
        ImageSettings { width: 40, height: 30, filter, filter_radius, ..ImageSettings::default() };
    let render = RenderSettings {
        samples_per_pixel: 20,
        max_depth: Some(8),
        seed: 7,
        ..RenderSettings::default()
    };
    Settings { image, render }
}

/// The file of a picture with all layers, but for what only this run took.
fn file_of(scene: &Scene, settings: Settings) -> Vec<u8> {
    let kinds = AOVS.map(|row| row.aov);
    let mut outcome = run(scene, &job(settings, &kinds), &()).expect("renders");
    assert_eq!(outcome.stop_reason, StopReason::Finished);
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
    assert_eq!(built.content_hash(), scene.content_hash());
    let (of_text, of_values) = (file_of(&scene, settings), file_of(&built, settings_of_values()));
    assert!(of_text == of_values, "the same bytes");
}

/// Layers and names of Cryptomatte included.
#[test]
fn a_table_in_memory_gives_the_picture_of_the_file_that_it_is_named_after() {
    let of_file = scene_of_values().build().expect("a good scene");
    let grains = grains();
    let rows = grains.iter().map(|&[x, y, z, radius, ..]| [x, y, z, radius]).collect();
    let colors = grains.iter().map(|&[.., r, g, b]| [r, g, b]).collect::<Vec<[f32; 3]>>();
    let mut values = scene_of_values();
    let arrays = SphereArrays::from_rows(rows).with_colors(colors);
    values.description.tables[0].data = SphereData::Memory(arrays);
    must_be_one_scene("in memory", &values.clone().build().expect("a good scene"), &of_file);
    values.description.tables[0].name = None;
    let unnamed = values.build().expect("a good scene");
    assert_ne!(unnamed.content_hash(), of_file.content_hash());
    assert!(picture_of(&unnamed) != picture_of(&of_file), "Cryptomatte shows the names");
}

/// The scene of the text with one passage in place of another.
fn scene_of_text(old: &str, new: &str) -> Scene {
    assert_eq!(TEXT.matches(old).count(), 1, "{old}");
    let read = read_text("test.toml", &TEXT.replace(old, new), Path::new(""), &[]);
    read.and_then(SceneFile::build).expect("a good scene").0
}

fn picture_of(scene: &Scene) -> Picture {
    let kinds = AOVS.map(|row| row.aov);
    let mut settings = settings_of_values();
    settings.render.samples_per_pixel = 2;
    run(scene, &job(settings, &kinds), &()).expect("renders").picture
}

/// Fails unless two scenes have one identity and one picture.
fn must_be_one_scene(what: &str, a: &Scene, b: &Scene) {
    assert_eq!(a.content_hash(), b.content_hash(), "{what}");
    assert!(picture_of(a) == picture_of(b), "{what}: pictures");
}

#[test]
fn values_that_mean_the_same_are_one_scene() {
    let expected = scene_of_text("format = 1", "format = 1");
    let look_at = "look_at = [0.0, 1.0, 0.0]";
    for (old, new) in [
        (look_at, "look_at = [0.0, 1.0, 0.0]\nup = [0.0, 2.0, 0.0]"),
        (look_at, "look_at = [0.0, 1.0, 0.0]\nup = [-0.0, 0.125, -0.0]"),
        (look_at, "look_at = [-0.0, 1.0, -0.0]"),
        ("[background.gradient]", "[background]\nup = [-0.0, 5.0, 0.0]\n[background.gradient]"),
        ("direction = [1.0, 2.0, 1.0]", "direction = [2.0, 4.0, 2.0]"),
        ("center = [1.5, 1.0, 0.0]", "center = [1.5, 1.0, -0.0]"),
        ("albedo = [0.0, 0.0, 0.0]", "albedo = [0.0, -0.0, 0.0]"),
    ] {
        must_be_one_scene(new, &scene_of_text(old, new), &expected);
    }
    // A lens without an opening, and a zenith that is not along an axis.
    let (scale, pinhole) =
        (DVec3::new(1.0, 2.0, 3.0), "up = [1.0, 2.0, 3.0]\naperture_radius = 0.0");
    let text = TEXT.replace("aperture_radius = 0.05", pinhole);
    let text = text
        .replace("[background.gradient]", "[background]\nup = [1, 2, 3]\n[background.gradient]");
    let read = read_text("test.toml", &text, Path::new(""), &[]).and_then(SceneFile::build);
    let (read, _) = read.expect("a good scene");
    for radius in [None, Some(0.0), Some(-0.0)] {
        let mut values = scene_of_values();
        let lens = |radius| LensDescription {
            radius,
            focus_distance: 7.5,
            blades: 5,
            rotation_degrees: 30.0,
        };
        let lens = radius.map(lens);
        let projection = ProjectionDescription::Perspective { vertical_fov_degrees: 40.0, lens };
        values.up(scale).description.camera.projection = projection;
        must_be_one_scene("pinhole", &values.build().expect("a good scene"), &read);
    }
}

#[test]
fn tables_have_one_zero() {
    let scene = |zero: f32, is_f64: bool| {
        let centers = vec![[zero, 1.0, zero], [1.0, zero, 0.5]];
        let (radii, wide) = (vec![0.5, 0.25], |center: &[f32; 3]| center.map(f64::from));
        let arrays = match is_f64 {
            true => {
                SphereArrays::from_centers(centers.iter().map(wide).collect(), vec![0.5f64, 0.25])
            }
            false => SphereArrays::from_centers(centers.clone(), radii),
        };
        let arrays = arrays.with_colors(vec![[0.5, zero, zero], [zero, 0.5, 0.5]]);
        let mut scene = view();
        let grey = scene.diffuse([0.5; 3]);
        scene.spheres(grey, arrays).build().expect("good arrays")
    };
    for is_f64 in [false, true] {
        must_be_one_scene("arrays", &scene(-0.0, is_f64), &scene(0.0, is_f64));
    }
    let folder = tempfile::tempdir().expect("a folder");
    let of_file = |zero: f32| {
        let path = folder.path().join("rows.f32");
        let bytes: Vec<u8> =
            [zero, 1.0, zero, 0.5].into_iter().flat_map(f32::to_le_bytes).collect();
        std::fs::write(&path, bytes).expect("written");
        let columns = [Column::X, Column::Y, Column::Z, Column::Radius];
        let mut scene = view();
        scene.diffuse([0.5; 3]);
        let data = SphereData::file(path, columns);
        scene.description.tables.push(SphereTable { data, ..SphereTable::default() });
        scene.build().expect("a good table")
    };
    must_be_one_scene("file", &of_file(-0.0), &of_file(0.0));
}

#[test]
fn a_builder_takes_tables_and_names() {
    let mut scene = view();
    let [_, blue] = [0.25, 0.5].map(|share| scene.diffuse([0.0, 0.0, share]));
    let data = SphereData::Memory(SphereArrays::from_rows(vec![[0.0, 0.0, 0.0, 1.0]]));
    let table = SphereTable {
        name: Some("grains".to_owned()),
        data,
        material: blue.index(),
        ..SphereTable::default()
    };
    let scene = scene.named_sphere(blue, "ball", [3.0, 0.0, 0.0], 1.0).table(table).build();
    let scene = scene.expect("a good scene");
    assert_eq!([0, 1].map(|row| scene.name_of_row(row)), ["ball", "grains:0"]);
    assert_eq!([0, 1].map(|row| scene.material_of_row(row)), [1, 1]);
}

#[test]
fn a_material_of_another_builder_is_refused() {
    let mut other = view();
    let foreign = other.diffuse([0.5; 3]);
    let mut scene = view();
    let own = scene.diffuse([0.5; 3]);
    scene.sphere(own, [0.0; 3], 1.0).sphere(foreign, [3.0, 0.0, 0.0], 1.0);
    scene.spheres(foreign, SphereArrays::from_rows(vec![[0.0, 3.0, 0.0, 1.0]]));
    let told = scene.build().expect_err("a material of another builder").to_string();
    assert!(told.contains("`spheres.1.material` is a material of another builder"), "{told}");
    assert!(told.contains("`sphere_tables.0.material` is a material of another builder"), "{told}");
    // A clone goes on with what it has.
    let mut clone = other.clone();
    assert!(clone.sphere(foreign, [0.0; 3], 1.0).build().is_ok());
}

#[test]
#[should_panic(expected = "the scene has 7 rows, and no row 7")]
fn a_row_that_the_scene_does_not_have_has_no_name() {
    scene_of_values().build().expect("a good scene").name_of_row(7);
}

#[test]
fn mistakes_of_values_are_told_all_at_once() {
    let mut scene = view();
    let grey = scene.diffuse([0.5; 3]);
    scene.sphere(grey, [0.0; 3], -1.0).sphere(grey, [f64::NAN, 0.0, 0.0], 1.0);
    let material = 7;
    scene.description.spheres.push(SphereDescription {
        radius: 1.0,
        material,
        ..SphereDescription::default()
    });
    let direction = DVec3::ZERO;
    let sun =
        SunDescription { direction, angular_diameter_degrees: 1.0, irradiance: [1.0; 3].into() };
    scene.description.background.sun = Some(sun);
    let error = scene.build().expect_err("nothing is right");
    assert_eq!(error.diagnostics().len(), 4, "{error}");
}

#[test]
fn values_that_are_no_numbers_are_refused() {
    let places: [fn(&mut SceneDescription, f64); 14] = [
        |scene, x| scene.camera.position.x = x,
        |scene, x| scene.camera.look_at.y = x,
        |scene, x| scene.camera.up.z = x,
        |scene, x| scene.camera.near = x,
        |scene, x| scene.camera.projection = ProjectionDescription::Orthographic { height: x },
        |scene, x| scene.background.up.x = x,
        |scene, x| {
            scene.background.dome =
                EnvironmentDescription::Constant { radiance: Rgb::splat(x as f32) }
        },
        |scene, x| scene.spheres[1].center.x = x,
        |scene, x| scene.spheres[1].center.y = x,
        |scene, x| scene.spheres[1].center.z = x,
        |scene, x| scene.spheres[1].radius = x,
        |scene, x| scene.materials[3].emission.y = x as f32,
        |scene, x| scene.materials[4].opacity = x,
        |scene, x| {
            scene.materials[0].surface = SurfaceModel::Mirror { reflectance: Rgb::X * x as f32 }
        },
    ];
    for (index, change) in places.into_iter().enumerate() {
        for x in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            let mut scene = scene_of_values();
            change(&mut scene.description, x);
            let mistakes = scene.build().err().map_or(0, |error| error.diagnostics().len());
            assert!(mistakes > 0, "{x} in place {index} is accepted");
        }
    }
}
