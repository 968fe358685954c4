//! The one table of keys against what else says the same: the manual, the values' own defaults, and
//! the JSON schema.

use std::collections::BTreeSet;

use photosphere::color::Rgb;
use photosphere::image_io::{ImageWriter, Picture};
use photosphere::material::{Metal, PrincipledParameters};
use photosphere::scene::description::{
    BackgroundDescription, CameraDescription, ColorStorage, LensDescription, MaterialDescription,
    ProjectionDescription, ProjectionKind, SurfaceKind, SurfaceModel,
};
use photosphere::scene::keys::{DefaultValue, KeyInfo, all};
use photosphere::scene::settings::{
    ImageSettings, IntegratorKind, IntegratorSettings, PaperSettings, PathTermination,
    PathTerminationKind, Settings,
};
use photosphere::scene::{SceneFile, read_text};
use serde_json::Value;

use crate::scenes::{load, set};

/// One row of the manual's tables.
struct Row<'m> {
    table: &'m str,
    of_type: Option<&'m str>,
    name: &'m str,
    kind: &'m str,
    default: &'m str,
    meaning: &'m str,
}

const MANUAL: &str = include_str!("../../docs/scene-format.md");

/// Every row of every table of keys.
fn rows() -> Vec<Row<'static>> {
    let (mut rows, mut table, mut of_type) = (Vec::new(), "", None);
    for line in MANUAL.lines() {
        if line.starts_with('#') {
            table = line.split('`').nth(1).unwrap_or_default().trim_matches(['[', ']']);
        }
        let cells: Vec<&str> = line.split('|').map(str::trim).collect();
        match cells[..] {
            ["", "key" | "type", ..] => of_type = None,
            ["", key, kind, default, meaning, ""] if key.starts_with('`') => {
                let name = key.trim_matches('`');
                rows.push(Row { table, of_type: None, name, kind, default, meaning });
            }
            ["", word, key, kind, default, meaning, ""] if key.starts_with('`') => {
                let named = word.strip_prefix("`\"").and_then(|word| word.strip_suffix("\"`"));
                of_type = named.or(of_type);
                let name = key.trim_matches('`');
                rows.push(Row { table, of_type, name, kind, default, meaning });
            }
            _ => {}
        }
    }
    rows
}

/// What the manual calls a kind of value.
fn kind_in_the_manual(key: &KeyInfo) -> String {
    let expects = key.expects.as_str();
    match (key.table, key.name) {
        ("", "format") => return "integer".into(),
        ("image", "crop") => return "four integers, `[x0, y0, x1, y1]`".into(),
        ("camera", "direction") => return "string or three numbers".into(),
        ("camera", "focus_on_pixel") => return "two integers, `[x, y]`".into(),
        ("camera", "blades") => return "integer, 0 or 3 to 64".into(),
        ("particles", "replicate") => return "three integers, 1 to 1000".into(),
        _ => {}
    }
    if expects.starts_with("a list, each entry \"") {
        return "list of strings".into();
    }
    if expects.starts_with('"') || expects == "a string" {
        return "string".into();
    }
    match expects {
        "true or false" => "boolean".into(),
        "three numbers from -1e15 to 1e15" => "three numbers".into(),
        "a whole number from -2147483648 to 2147483647" => "integer, 32 bits".into(),
        _ => expects
            .replace("a whole number from -9223372036854775808", "integer, -2^63")
            .replace("a whole number", "integer")
            .replace("a string or a number", "string or number")
            .replace("a number", "number")
            .replace(" from ", ", ")
            .replace(" above ", ", above ")
            .replace(" and ", ", ")
            .replace("4294967295", "2^32 - 1"),
    }
}

/// Says in which of the rows' words the manual disagrees.
fn check_row(key: &KeyInfo, row: &Row<'_>) {
    let at = format!("{}.{} ({:?})", key.table, key.name, key.of_type);
    assert_eq!(row.kind, kind_in_the_manual(key), "{at}");
    let default = row.default.replace('`', "").replace('²', "^2");
    match key.default {
        DefaultValue::Required => assert_eq!(default, "required", "{at}"),
        DefaultValue::Toml(value) => assert_eq!(default, value, "{at}"),
        DefaultValue::Derived(words) => {
            let default = default.replace('"', "");
            assert!(default.starts_with(words), "{at}: {default} is not {words}");
        }
    }
    assert!(!row.meaning.is_empty(), "{at}");
    // Each word that is allowed is told, if not in the table then below it.
    for word in key.expects.split('"').skip(1).step_by(2) {
        assert!(MANUAL.contains(&format!("`\"{word}\"`")), "{at}: {word}");
    }
}

#[test]
fn the_manual_has_every_key_as_it_is() {
    let rows = rows();
    let keys = all();
    for key in &keys {
        let is_of_key = |row: &&Row<'_>| {
            (row.table, row.of_type, row.name) == (key.table, key.of_type, key.name)
        };
        match rows.iter().filter(is_of_key).collect::<Vec<_>>()[..] {
            [row] => check_row(key, row),
            ref found => panic!("{} rows for {key:?}", found.len()),
        }
    }
    assert_eq!(rows.len(), keys.len(), "nothing else is in the manual");
}

/// A scene in which nothing is said that may be left out.
const BARE: &str = r#"
format = 1
camera = { position = [0, 0, 10], look_at = [0, 0, 0] }
materials.m = { type = "diffuse", albedo = [0.5, 0.5, 0.5] }
spheres = [{ center = [0, 0, 0], radius = 1, material = "m" }]
"#;

#[test]
fn what_is_left_out_is_what_the_values_have_by_themselves() {
    let SceneFile { description, settings, .. } = load(BARE, &[]).expect("a good scene");
    assert_eq!(settings, Settings::default());
    assert_eq!(description.camera, CameraDescription::default());
    assert_eq!(description.background, BackgroundDescription::default());
    let plain = MaterialDescription { name: "m".into(), ..MaterialDescription::default() };
    assert_eq!(description.materials, [plain]);
    let of = |options: &[&str]| load(BARE, options).expect("a good scene");
    let paper = of(&["render.integrator=paper"]).settings.render.integrator;
    assert_eq!(paper, IntegratorSettings::Paper(PaperSettings::default()));
    let principled = of(&["materials.m={type='principled',base_color=[0.5,0.5,0.5]}"]);
    let usual = SurfaceModel::Principled(PrincipledParameters::default());
    assert_eq!(principled.description.materials[0].surface, usual);
    let table = "sphere_tables=[{file='grains.f32',material='m',columns=['x','y','z','radius','r','g','b']}]";
    assert_eq!(of(&[table]).description.tables[0].colors, ColorStorage::default());
    for (name, filter) in photosphere::scene::settings::FilterKind::NAMES {
        let image = of(&[&format!("image.filter={name}")]).settings.image;
        assert_eq!(image.filter_radius, ImageSettings::default_filter_radius(*filter));
    }
    assert_eq!(description.camera.projection, ProjectionDescription::default());
}

/// What must be said for a key to mean something, beside the key itself.
fn preparation(key: &KeyInfo) -> &'static [&'static str] {
    const SUN: &str = "background.sun={irradiance=[1,1,1]}";
    const ABOVE: &str = "background.sun.elevation_degrees=30";
    match (key.table, key.of_type.unwrap_or_default()) {
        ("camera", "perspective") => &["camera.aperture_radius=0.1"],
        ("camera", "orthographic") => &["camera.type=orthographic", "camera.height=2"],
        ("camera", "panoramic") => &["camera.type=panoramic"],
        ("background.gradient", _) => &["background.gradient={zenith=[1,1,1],horizon=[1,0,1]}"],
        ("background.image", _) => &["background.image={file='sky.exr'}"],
        ("background.sky", _) => &[SUN, ABOVE, "background.sky={}"],
        ("background.sun", _) => &[SUN, ABOVE, "background.sun.azimuth_degrees=30"],
        ("materials.NAME", "mirror") => &["materials.m={type='mirror',reflectance=[1,1,1]}"],
        ("materials.NAME", "conductor") => &["materials.m={type='conductor',metal='gold'}"],
        ("materials.NAME", "dielectric") => &["materials.m={type='dielectric',ior=1.5}"],
        ("materials.NAME", "plastic") => &["materials.m={type='plastic',albedo=[1,0,1]}"],
        ("materials.NAME", "principled") => &["materials.m={type='principled',base_color=[1,0,1]}"],
        ("materials.NAME", "phong") => {
            &["materials.m={type='phong',albedo=[0.5,0,0],specular=[0.5,0,0],exponent=3}"]
        }
        ("sphere_tables", _) => &[
            "sphere_tables=[{file='grains.f32',material='m',columns=['x','y','z','radius','r','g','b']}]",
        ],
        ("particles", _) => &["particles=[{file='grains.csv',material='m'}]"],
        ("render.paper", _) => &["render.integrator=paper", "render.paper.stop=threshold"],
        ("render.raycast", _) => &["render.integrator=raycast"],
        _ => &[],
    }
}

/// A folder with what the preparations name.
pub(crate) fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    let layer = vec![Rgb::ONE; 8];
    let picture = Picture {
        width: 4,
        height: 2,
        direct: layer.clone(),
        indirect: layer,
        ..Picture::default()
    };
    let file = folder.path().join("sky.exr");
    ImageWriter::new(&file).expect("a name").write(&picture).expect("a picture");
    let rows = "x,y,z,radius\n0,0,0,1\n3,0,0,0.5\n";
    std::fs::write(folder.path().join("grains.csv"), rows).expect("particles");
    std::fs::copy("tests/data/grains.f32", folder.path().join("grains.f32")).expect("a table");
    folder
}

#[test]
fn saying_a_default_changes_nothing() {
    let folder = folder();
    let read = |options: &[String]| {
        let options: Vec<_> = options.iter().map(|option| set(option)).collect();
        let file = read_text("test.toml", BARE, folder.path(), &options);
        let file = file.unwrap_or_else(|error| panic!("{options:?}: {error}"));
        (file.description, file.settings)
    };
    let mut said = 0;
    for key in all() {
        let DefaultValue::Toml(value) = key.default else { continue };
        let table = key.table.replace("NAME", "m").replace("sphere_tables", "sphere_tables.0");
        let table = table.replace("particles", "particles.0");
        let table = if table == "spheres" { "spheres.0".to_owned() } else { table };
        let path = format!("{table}.{}", key.name);
        let is_key_itself = |option: &&&str| option.starts_with(&format!("{path}="));
        let prepared = preparation(&key).iter().filter(|option| !is_key_itself(option));
        let mut options: Vec<String> = prepared.map(|option| (*option).to_owned()).collect();
        let left_out = read(&options);
        options.push(format!("{path}={value}"));
        assert_eq!(read(&options), left_out, "{path} is not {value} by itself");
        said += 1;
    }
    assert!(said > 40, "only {said} keys have a default");
}

#[test]
fn no_key_is_declared_twice() {
    let keys = all();
    let places: BTreeSet<_> = keys.iter().map(|key| (key.table, key.of_type, key.name)).collect();
    assert_eq!(places.len(), keys.len());
}

/// A surface of every kind.
pub(crate) fn surfaces() -> [SurfaceModel; 7] {
    let half = Rgb::splat(0.5);
    [
        SurfaceModel::Diffuse { albedo: half, roughness: 0.25 },
        SurfaceModel::Mirror { reflectance: half },
        SurfaceModel::Conductor { metal: Metal::NAMED[0].1, roughness: 0.25 },
        SurfaceModel::Dielectric { ior: 1.25, roughness: 0.25, priority: 3, absorption: half },
        SurfaceModel::Plastic { albedo: half, ior: 1.25, roughness: 0.25 },
        SurfaceModel::Principled(PrincipledParameters::default()),
        SurfaceModel::Phong { albedo: half, specular: half, exponent: 8.0, normalized: false },
    ]
}

/// A projection of every kind.
pub(crate) fn projections() -> [ProjectionDescription; 3] {
    let lens =
        LensDescription { radius: 0.125, focus_distance: 5.0, blades: 6, rotation_degrees: 30.0 };
    [
        ProjectionDescription::Perspective { vertical_fov_degrees: 40.0, lens: Some(lens) },
        ProjectionDescription::Orthographic { height: 4.0 },
        ProjectionDescription::Panoramic { horizontal_degrees: 270.0, vertical_degrees: 90.0 },
    ]
}

/// An integrator of every kind.
pub(crate) fn integrators() -> [IntegratorSettings; 6] {
    [
        IntegratorSettings::Path,
        IntegratorSettings::Direct,
        IntegratorSettings::AmbientOcclusion { distance: Some(2.0) },
        IntegratorSettings::Normals,
        IntegratorSettings::Paper(PaperSettings {
            stop: PathTermination::Threshold(0.25),
            ..PaperSettings::default()
        }),
        IntegratorSettings::Raycast { shadows: true },
    ]
}

/// Fails unless these are the values of every kind, each with the kind's name as its tag in JSON.
fn must_have_names<T: serde::Serialize, K: Copy + PartialEq>(
    values: &[T],
    kind: impl Fn(&T) -> K,
    names: &[(&str, K)],
) {
    assert_eq!(values.len(), names.len());
    for (name, of_name) in names {
        let value = values.iter().find(|value| kind(value) == *of_name).expect("one of each kind");
        let written = serde_json::to_value(value).expect("plain values");
        let tag = match &written {
            Value::Object(map) if map.contains_key("type") => map["type"].as_str(),
            Value::Object(map) => map.keys().next().map(String::as_str),
            other => other.as_str(),
        };
        assert_eq!(tag, Some(*name));
    }
}

#[test]
fn a_kind_has_the_same_name_in_scene_files_and_in_json() {
    must_have_names(&surfaces(), SurfaceModel::kind, SurfaceKind::NAMES);
    must_have_names(&projections(), ProjectionDescription::kind, ProjectionKind::NAMES);
    must_have_names(&integrators(), IntegratorSettings::kind, IntegratorKind::NAMES);
    let stops =
        [PathTermination::Roulette, PathTermination::Depth, PathTermination::Threshold(0.25)];
    must_have_names(&stops, PathTermination::kind, PathTerminationKind::NAMES);
}
