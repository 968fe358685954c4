//! Colours as numbers, as `#rrggbb` and by name; tables in sRGB; backdrops and light by name.

use photosphere::color::{Rgb, linear_from_srgb};
use photosphere::math::DVec3;
use photosphere::scene::data::{SphereArrays, SphereData};
use photosphere::scene::description::{
    ColorSpace, ColorStorage, EnvironmentDescription, SphereTable, SurfaceModel,
};
use photosphere::scene::{Scene, SceneDescription, SceneFile};

use crate::scenes::{SCENE, assert_told, load, with};

fn albedo(text: &str) -> Rgb {
    let SceneFile { description, .. } = load(text, &[]).expect("a good scene");
    match description.materials[0].surface {
        SurfaceModel::Diffuse { albedo, .. } => albedo,
        ref other => panic!("{other:?}"),
    }
}

#[test]
fn a_color_may_be_written_as_on_screens() {
    let given = "albedo = [0.2, 0.6, 0.2]";
    let expected = Rgb::new(0x33 as f32, 0xaa as f32, 0x66 as f32) / 255.0;
    let expected = Rgb::from_array(expected.to_array().map(linear_from_srgb));
    assert_eq!(albedo(&with(given, "albedo = \"#33aa66\"")), expected);
    assert_eq!(albedo(&with(given, "albedo = \"#3a6\"")), expected);
    assert_eq!(albedo(&with(given, "albedo = \"white\"")), Rgb::ONE);
    let told = "13:10: `materials.grass.albedo` must be three numbers from 0 to 1, not \"gras\" \
                | a colour may also be \"#33aa33\" or a name such as \"tomato\"";
    assert_told(&with(given, "albedo = \"gras\""), &[], &[told]);
}

/// The scene of one row of a table with this colour.
fn colored(color: [f32; 3], space: ColorSpace, colors: ColorStorage) -> Scene {
    let mut scene = SceneDescription::default();
    scene.materials.push(Default::default());
    let arrays = SphereArrays::from_rows(vec![[0.0f32, 0.0, 0.0, 1.0]]).with_colors(vec![color]);
    let data = SphereData::Memory(arrays);
    scene.tables.push(SphereTable { data, color_space: space, colors, ..Default::default() });
    Scene::build(scene).expect("a good scene")
}

#[test]
fn colors_of_tables_are_linear_or_srgb() {
    // Equal hashes mean equal scenes, and so equal colours.
    let hash = |color, space, storage| colored(color, space, storage).content_hash();
    let color = [0.2f32, 0.5, 1.0];
    let linear = color.map(linear_from_srgb);
    for storage in [ColorStorage::Exact, ColorStorage::Packed] {
        let from_srgb = hash(color, ColorSpace::Srgb, storage);
        assert_eq!(from_srgb, hash(linear, ColorSpace::Linear, storage));
        assert_ne!(from_srgb, hash(color, ColorSpace::Linear, storage));
    }
}

#[test]
fn the_color_space_of_a_file_is_read() {
    let table = "\n[[sphere_tables]]\nfile = \"grains.f32\"\nmaterial = \"grass\"\ncolor_space = \"srgb\"\n\
                 columns = [\"x\", \"y\", \"z\", \"radius\", ";
    let text = format!("{SCENE}{table}\"r\", \"g\", \"b\"]\n");
    let file = load(&text, &[]).expect("a good scene");
    assert_eq!(file.description.tables[0].color_space, ColorSpace::Srgb);
    let (srgb, _) = file.build().expect("a good scene");
    let linear = text.replace("color_space = \"srgb\"\n", "");
    let (linear, _) = load(&linear, &[]).expect("a good scene").build().expect("a good scene");
    assert_ne!(srgb.content_hash(), linear.content_hash());
    let without = format!("{SCENE}{table}\"_\", \"_\", \"_\"]\n");
    let told = "36:15: `sphere_tables.0.color_space` applies only to tables with colours \
                | remove it, or add r, g and b to `columns`";
    assert_told(&without, &[], &[told]);
}

#[test]
fn light_by_name_stands_beside_the_camera() {
    let lit = |options: &[&str]| {
        let file = load(&format!("{SCENE}\n[light]\npreset = \"softbox\"\n"), options);
        file.expect("a good scene").description.background
    };
    let sun = |options: &[&str]| lit(options).sun.expect("a key light").direction;
    assert!(sun(&[]).dot(DVec3::Z) > 0.4, "the camera is at z = 5");
    assert!(sun(&[]).x < -0.2, "it is on the left");
    assert!(sun(&["camera.position=[5, 1, 0]"]).dot(DVec3::X) > 0.4);
    let EnvironmentDescription::Gradient { zenith, .. } = lit(&["light.strength=2"]).dome else {
        panic!("no dome");
    };
    assert_eq!(zenith, Rgb::splat(0.9));
    let both = format!("{SCENE}\n[background]\nradiance = [1, 1, 1]\n[light]\npreset = \"sun\"\n");
    let told =
        "36:10: `light.preset` and `background.radiance` both light the scene | remove one of them";
    assert_told(&both, &[], &[told]);
}

#[test]
fn a_backdrop_is_what_the_camera_sees_behind_everything() {
    let text = format!("{SCENE}\n[background]\nradiance = [1, 2, 3]\nbackdrop = \"white\"\n");
    let (scene, _) = load(&text, &[]).and_then(SceneFile::build).expect("a good scene");
    assert_eq!(scene.camera_background(DVec3::Y).direct, Rgb::ONE);
    assert_eq!(scene.background_radiance(DVec3::Y), Rgb::new(1.0, 2.0, 3.0));
    let told = "35:12: `background.backdrop` is never seen, because `background.transparent` leaves it \
                out of the picture | remove one of them";
    assert_told(&format!("{text}transparent = true\n"), &[], &[told]);
}
