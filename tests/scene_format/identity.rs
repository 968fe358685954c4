//! What makes two scenes the same: what is in them, wherever it comes from.

use std::path::Path;

use photosphere::color::Rgb;
use photosphere::math::DVec3;
use photosphere::scene::data::{Column, SphereArrays, SphereData};
use photosphere::scene::description::{
    BackgroundDescription, CameraDescription, EnvironmentDescription, LensDescription,
    MaterialDescription, ProjectionDescription, SceneDescription, SphereDescription, SphereTable,
    SurfaceModel,
};
use photosphere::scene::{ContentHash, Scene, SceneFile, read_text};
use tempfile::TempDir;

use crate::scenes::set;

const TEXT: &str = r#"
format = 1

[camera]
position = [0.5, 1, 5]
look_at = [0.5, 1, 0]
vertical_fov_degrees = 40
aperture_radius = 0.125

[background.gradient]
zenith = [0.25, 0.5, 1]
horizon = [1, 1, 1]

[materials.grass]
type = "diffuse"
albedo = [0.2, 0.6, 0.2]

[materials.glass]
type = "dielectric"
ior = 1.5
priority = 2

[[spheres]]
name = "ground"
center = [0, -10, 0]
radius = 10
material = "grass"

[[spheres]]
center = [0, 1, 0]
radius = 0.1
material = "glass"

[[sphere_tables]]
file = "grains.f32"
columns = ["radius", "x", "y", "z", "r", "g", "b"]
material = "grass"
"#;

/// Two spheres: x, y, z, radius, and red, green, blue.
const GRAINS: [[f32; 7]; 2] =
    [[1.0, 2.0, 3.0, 0.5, 0.25, 0.5, 0.75], [-1.0, 0.1, 1.0, 0.25, 0.0, 1.0, 0.5]];

/// A folder with the grains, their columns as [`TEXT`] names them.
fn folder() -> TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    let in_file = |&[x, y, z, radius, r, g, b]: &[f32; 7]| [radius, x, y, z, r, g, b];
    let values = GRAINS.iter().flat_map(in_file);
    let bytes: Vec<u8> = values.flat_map(f32::to_le_bytes).collect();
    std::fs::write(folder.path().join("grains.f32"), bytes).expect("the disk takes it");
    folder
}

fn scene_of_text(text: &str, folder: &Path, options: &[&str]) -> Scene {
    let options: Vec<_> = options.iter().map(|option| set(option)).collect();
    let built = read_text("test.toml", text, folder, &options).and_then(SceneFile::build);
    built.unwrap_or_else(|error| panic!("{options:?}: {error}")).0
}

fn grains() -> SphereArrays {
    let centers = GRAINS.iter().map(|&[x, y, z, ..]| [x, y, z]).collect();
    let radii = GRAINS.iter().map(|grain| grain[3]).collect();
    let colors = GRAINS.iter().map(|&[.., r, g, b]| [r, g, b]).collect::<Vec<[f32; 3]>>();
    SphereArrays::from_centers::<f32>(centers, radii).with_colors(colors)
}

fn table(arrays: SphereArrays) -> SphereTable {
    let name = Some("grains.f32".to_owned());
    SphereTable { name, data: SphereData::Memory(arrays), ..SphereTable::default() }
}

/// [`TEXT`] as values.
fn values() -> SceneDescription {
    let lens =
        LensDescription { radius: 0.125, focus_distance: 5.0, blades: 0, rotation_degrees: 0.0 };
    let named = |name: &str, surface| MaterialDescription {
        name: name.to_owned(),
        surface,
        ..MaterialDescription::default()
    };
    let grass = SurfaceModel::Diffuse { albedo: Rgb::new(0.2, 0.6, 0.2), roughness: 0.0 };
    let glass =
        SurfaceModel::Dielectric { ior: 1.5, roughness: 0.0, priority: 2, absorption: Rgb::ZERO };
    SceneDescription {
        camera: CameraDescription {
            position: DVec3::new(0.5, 1.0, 5.0),
            look_at: DVec3::new(0.5, 1.0, 0.0),
            projection: ProjectionDescription::Perspective {
                vertical_fov_degrees: 40.0,
                lens: Some(lens),
            },
            ..CameraDescription::default()
        },
        background: BackgroundDescription {
            dome: EnvironmentDescription::Gradient {
                zenith: Rgb::new(0.25, 0.5, 1.0),
                horizon: Rgb::ONE,
                nadir: Rgb::ONE,
            },
            ..BackgroundDescription::default()
        },
        materials: vec![named("grass", grass), named("glass", glass)],
        spheres: vec![
            SphereDescription {
                name: Some("ground".to_owned()),
                center: DVec3::new(0.0, -10.0, 0.0),
                radius: 10.0,
                ..SphereDescription::default()
            },
            SphereDescription {
                center: DVec3::Y,
                radius: 0.1,
                material: 1,
                ..SphereDescription::default()
            },
        ],
        tables: vec![table(grains())],
    }
}

fn identity(description: SceneDescription) -> ContentHash {
    Scene::build(description).expect("good values").content_hash()
}

#[test]
fn a_scene_is_the_same_from_a_file_and_from_values() {
    let folder = folder();
    let read = scene_of_text(TEXT, folder.path(), &[]);
    assert_eq!(read.content_hash(), identity(values()));
    // The file as a value, too, whatever the order of its columns.
    use Column::{Blue, Green, Radius, Red, X, Y, Z};
    let path = folder.path().join("grains.f32");
    let file = SphereData::file(path, [Radius, X, Y, Z, Red, Green, Blue]);
    let tables = vec![SphereTable { data: file, ..table(grains()) }];
    assert_eq!(read.content_hash(), identity(SceneDescription { tables, ..values() }));
}

/// The layers of Cryptomatte show it.
#[test]
fn the_name_of_a_table_is_part_of_the_scene() {
    let folder = folder();
    let other = folder.path().join("others.f32");
    std::fs::copy(folder.path().join("grains.f32"), other).expect("a copy");
    let scene = |options: &[&str]| scene_of_text(TEXT, folder.path(), options);
    let name = |options: &[&str]| scene(options).table_of_row(2);
    let of_other = "sphere_tables.0.file=others.f32";
    assert_eq!([name(&[]), name(&[of_other])], ["grains.f32", "others.f32"]);
    assert_ne!(scene(&[]).content_hash(), scene(&[of_other]).content_hash());
    let named = "sphere_tables.0.name=grains.f32";
    assert_eq!(name(&[of_other, named]), "grains.f32");
    assert_eq!(scene(&[]).content_hash(), scene(&[of_other, named]).content_hash());
    // Without a name, a table in memory is called by its index.
    let with = |name: Option<&str>| {
        let name = name.map(str::to_owned);
        let tables = vec![SphereTable { name, ..table(grains()) }];
        Scene::build(SceneDescription { tables, ..values() }).expect("good values")
    };
    assert_eq!(with(None).table_of_row(2), "table 0");
    assert_eq!(with(None).content_hash(), with(Some("table 0")).content_hash());
    assert_ne!(with(None).content_hash(), with(Some("grains")).content_hash());
    assert!(
        Scene::build(SceneDescription {
            tables: vec![SphereTable { name: Some(String::new()), ..table(grains()) }],
            ..values()
        })
        .is_err_and(|error| error.to_string().contains("`sphere_tables.0.name` must be a string"))
    );
}

#[test]
fn where_files_lie_and_how_a_scene_is_rendered_or_laid_out_is_no_part_of_it() {
    let [here, there] = [folder(), folder()];
    let identity = |folder: &TempDir, text: &str, options: &[&str]| {
        scene_of_text(text, folder.path(), options).content_hash()
    };
    let first = identity(&here, TEXT, &[]);
    assert_eq!(first, identity(&there, TEXT, &[]));
    let inner = there.path().join("inner");
    std::fs::create_dir(&inner).expect("a folder");
    std::fs::copy(there.path().join("grains.f32"), inner.join("grains.f32")).expect("a copy");
    assert_eq!(first, identity(&there, TEXT, &["sphere_tables.0.file=inner/grains.f32"]));
    let longer = TEXT.replace("radius = 10\n", "radius = 10.000 # a hill\n");
    assert_eq!(first, identity(&here, &longer, &[]));
    let rendering =
        ["image.width=8", "render.seed=9", "render.integrator=normals", "image.filter=tent"];
    assert_eq!(first, identity(&here, TEXT, &rendering));
    // What is left out is what is said.
    let said = ["camera.up=[0,1,0]", "materials.grass.roughness=0", "background.up=[0,1,0]"];
    assert_eq!(first, identity(&here, TEXT, &said));
}

#[test]
fn each_value_of_a_scene_is_part_of_it() {
    let folder = folder();
    let mut identities = vec![scene_of_text(TEXT, folder.path(), &[]).content_hash()];
    for option in [
        "camera.position=[0.5,1,5.000000000000001]",
        "camera.near=0.1",
        "camera.blades=5",
        "camera.focus_distance=4",
        "camera.type=panoramic",
        "background.gradient.nadir=[0,0,0]",
        "background.transparent=true",
        "background.camera_visible=false",
        "materials.grass.albedo=[0.2,0.6,0.3]",
        "materials.grass.opacity=0.5",
        "materials.glass.priority=3",
        "materials.glass.absorption=[0,0,1]",
        "materials.other={type='mirror',reflectance=[1,1,1]}",
        "spheres.0.radius=10.000000000000002",
        "spheres.1.center=[0,1,1e-300]",
        "spheres.1.material=grass",
        "spheres.1.name=ball",
        "sphere_tables.0.name=grain",
        "sphere_tables.0.material=glass",
        "sphere_tables.0.colors=packed",
        "sphere_tables.0.columns=['radius','x','y','z','g','r','b']",
    ] {
        let option: &[&str] = match option.strip_prefix("camera.type") {
            // What a lens has is no key of a panorama.
            Some(_) => &["camera={position=[0.5,1,5],look_at=[0.5,1,0],type='panoramic'}"],
            None => &[option],
        };
        let identity = scene_of_text(TEXT, folder.path(), option).content_hash();
        assert!(!identities.contains(&identity), "{option:?} changes nothing");
        identities.push(identity);
    }
}

#[test]
fn each_number_of_a_table_is_part_of_the_scene() {
    let with = |arrays| identity(SceneDescription { tables: vec![table(arrays)], ..values() });
    let mut identities = vec![with(grains())];
    let mut add = |identity: ContentHash, what: &str| {
        assert!(!identities.contains(&identity), "{what} changes nothing");
        identities.push(identity);
    };
    for number in 0..7 {
        let mut changed = GRAINS;
        // A neighbour among the numbers that there are.
        changed[1][number] = f32::from_bits(changed[1][number].to_bits() + 1);
        // Colours end at 1.
        if number >= 4 && changed[1][number] > 1.0 {
            changed[1][number] = 0.5;
        }
        add(with(arrays_of(&changed)), &format!("number {number} of a row"));
    }
    let [first, second] = GRAINS;
    add(with(arrays_of(&[second, first])), "the order");
    add(with(arrays_of(&[first])), "leaving one out");
    add(with(SphereArrays { color: None, ..grains() }), "having no colours");
    let colors = || GRAINS.iter().map(|&[.., r, g, b]| [r, g, b]).collect::<Vec<[f32; 3]>>();
    let dark = SphereArrays { color: None, ..grains() };
    add(with(dark.clone().with_emission(colors())), "emission in place of colours");
    add(with(grains().with_emission(colors())), "having emission");
    add(with(grains().with_emission(vec![[0.0f32; 3]; 2])), "having no light of one's own");
    add(with(grains().with_ids(vec![0, 1])), "having numbers of one's own");
    add(with(grains().with_ids(vec![0, 2])), "other numbers of one's own");
}

fn arrays_of(grains: &[[f32; 7]]) -> SphereArrays {
    let rows = grains.iter().map(|&[x, y, z, radius, ..]| [x, y, z, radius]).collect();
    let colors = grains.iter().map(|&[.., r, g, b]| [r, g, b]).collect::<Vec<[f32; 3]>>();
    SphereArrays::from_rows(rows).with_colors(colors)
}

/// Whatever changes it must change the version of the encoding.
#[test]
fn the_identity_of_a_scene_stays() {
    let text = r#"
format = 1
camera = { position = [0, 0, 10], look_at = [0, 0, 0] }
materials.m = { type = "diffuse", albedo = [0.5, 0.5, 0.5] }
spheres = [{ center = [0, 0, 0], radius = 1, material = "m" }]
[[sphere_tables]]
file = "grains.f32"
columns = ["x", "y", "z", "radius", "r", "g", "b"]
material = "m"
"#;
    let identity = scene_of_text(text, Path::new("tests/data"), &[]).content_hash().to_string();
    assert_eq!(identity, "5a37e27318df496bf8f16e622539fdb5fd0ea0957f9f03fe5276b64217b5d457");
}

/// How numbers lie in memory does not matter, and their type only where it holds more.
#[test]
fn equal_numbers_are_the_same_in_every_layout_and_type() {
    let with = |arrays| identity(SceneDescription { tables: vec![table(arrays)], ..values() });
    let expected = with(grains());
    assert_eq!(expected, with(arrays_of(&GRAINS)), "in rows and in columns");
    let wide = |grain: &[f32; 7]| [grain[0], grain[1], grain[2]].map(f64::from);
    let in_f64 = |last: f64| {
        let mut centers: Vec<[f64; 3]> = GRAINS.iter().map(wide).collect();
        centers[1][2] += last;
        let radii = GRAINS.iter().map(|grain| f64::from(grain[3])).collect();
        SphereArrays { color: grains().color, ..SphereArrays::from_centers(centers, radii) }
    };
    assert_eq!(expected, with(in_f64(0.0)), "in f64");
    assert_ne!(expected, with(in_f64(1e-12)), "what only f64 tells apart");
}

#[test]
fn a_scene_keeps_its_identity_but_not_its_arrays() {
    let scene = Scene::build(values()).expect("good values");
    assert_eq!(scene.content_hash(), scene.clone().content_hash());
    let SphereData::Memory(arrays) = &scene.description().tables[0].data else {
        panic!("the table was in memory");
    };
    assert_eq!(arrays.len(), 2);
    assert!(Scene::build(scene.description().clone()).is_err(), "its numbers are gone");
}
