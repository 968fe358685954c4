//! The values of a scene by the keys of its file: every one has a key, and a file with these keys
//! has the same values.

use std::collections::BTreeSet;
use std::path::Path;

use photosphere::appearance::{Appearance, ViewDirection};
use photosphere::color::Rgb;
use photosphere::math::{DVec3, Rect};
use photosphere::particles::Format;
use photosphere::scene::data::{Column, FileColumn, NumberType, SphereArrays, SphereData};
use photosphere::scene::description::{
    BackgroundDescription, CameraDescription, CameraFit, ColorSpace, EnvironmentDescription,
    FocusTarget, MaterialDescription, ProjectionDescription, SceneDescription, SphereDescription,
    SphereTable, SunDescription,
};
use photosphere::scene::keys::all;
use photosphere::scene::settings::{FilterKind, ImageSettings, RenderSettings, Settings};
use photosphere::scene::{ParticleTable, read_text};
use serde_json::Value;

use crate::keys::{folder, integrators, projections, surfaces};

fn domes(folder: &Path) -> [EnvironmentDescription; 4] {
    let [zenith, horizon, nadir] = [0.75, 0.5, 0.25].map(Rgb::splat);
    let file = folder.join("sky.exr");
    [
        EnvironmentDescription::Constant { radiance: zenith },
        EnvironmentDescription::Gradient { zenith, horizon, nadir },
        EnvironmentDescription::Image { file, rotation_degrees: 30.0, scale: 0.5 },
        EnvironmentDescription::Sky { turbidity: 4.0, ground_albedo: nadir, scale: 0.5 },
    ]
}

/// Descriptions in which every kind of thing occurs; the files are in this folder.
fn descriptions(folder: &Path) -> Vec<SceneDescription> {
    let described = |(index, dome): (usize, EnvironmentDescription)| {
        let materials =
            surfaces().into_iter().enumerate().map(|(at, surface)| MaterialDescription {
                name: format!("material no. {at}"),
                surface,
                emission: Rgb::new(0.1, 0.2, 0.3),
                opacity: 0.5,
            });
        let sun = SunDescription {
            direction: DVec3::Y,
            angular_diameter_degrees: 0.5,
            irradiance: Rgb::ONE,
        };
        use Column::{Blue, Green, Radius, Red, X, Y, Z};
        let of_f32 = |column| FileColumn { number: Some(NumberType::F32), ..column };
        let [x, y, z, radius] = [X, Y, Z, Radius].map(|column| of_f32(column.into()));
        let data = SphereData::File {
            path: folder.join("grains.f32"),
            columns: [x, y, z, radius]
                .into_iter()
                .chain([Red, Green, Blue].map(Into::into))
                .collect(),
            skip_rows: index as u64 % 2,
            skip_bytes: 28 * (1 - index as u64 % 2),
        };
        let table = SphereTable {
            name: Some("grains".into()),
            data,
            material: 2,
            offset: DVec3::new(0.1, -1e9, 0.0),
            color_space: if index % 2 == 0 { ColorSpace::Srgb } else { ColorSpace::Linear },
            ..Default::default()
        };
        let (center, radius) = (DVec3::new(1.0, -2.0, 0.1), 0.5);
        let sphere = SphereDescription {
            name: Some("ball".into()),
            center,
            radius,
            material: 1,
            shadow_catcher: index % 2 == 0,
        };
        SceneDescription {
            camera: CameraDescription {
                near: 0.25,
                projection: projections()[index % 3],
                ..CameraDescription::default()
            },
            background: BackgroundDescription {
                dome,
                sun: Some(sun),
                camera_visible: false,
                transparent: true,
                ..BackgroundDescription::default()
            },
            materials: materials.collect(),
            spheres: vec![sphere.clone(), SphereDescription { name: None, material: 0, ..sphere }],
            tables: vec![table],
        }
    };
    let mut all: Vec<_> = domes(folder).into_iter().enumerate().map(described).collect();
    let with_lens = all.iter().find(|scene| scene.camera.lens().is_some()).expect("a lens").clone();
    let targets = [FocusTarget::Pixel(3, 4), FocusTarget::TableRow(0, 1)];
    all.extend(targets.map(|target| {
        let mut scene = with_lens.clone();
        let fit = CameraFit {
            direction: ViewDirection::Axis(2, true),
            margin: 0.25,
            right_margin: Some(0.375),
        };
        scene.camera.fit = matches!(target, FocusTarget::Pixel(..)).then_some(fit);
        scene.camera.focus_target = Some(target);
        if let ProjectionDescription::Perspective { lens: Some(lens), .. } =
            &mut scene.camera.projection
        {
            // Of no matter beside a target.
            lens.focus_distance = 1.0;
        }
        scene.background.transparent = false;
        scene.background.backdrop = Some(Rgb::splat(0.5));
        scene
    }));
    all
}

fn settings() -> impl Iterator<Item = Settings> {
    integrators().into_iter().map(|integrator| Settings {
        image: ImageSettings {
            width: 64,
            height: 48,
            crop: Some(Rect { x: 8, y: 4, width: 16, height: 8 }),
            filter: FilterKind::Gaussian,
            filter_radius: 1.25,
        },
        render: RenderSettings {
            integrator,
            samples_per_pixel: 16,
            max_depth: Some(5),
            clamp_indirect: Some(10.0),
            seed: 7,
            ..RenderSettings::default()
        },
    })
}

/// Every value in a tree with the table and the name of its key, and the type of that table.
fn leaves(value: &Value, path: &[String], found: &mut BTreeSet<(String, Option<String>, String)>) {
    let of_type = value.get("type").and_then(Value::as_str);
    for (name, inner) in value.as_object().expect("a table") {
        let path = [path, std::slice::from_ref(name)].concat();
        match inner {
            Value::Object(_) => leaves(inner, &path, found),
            Value::Array(list) if list.iter().any(Value::is_object) => {
                list.iter().for_each(|entry| leaves(entry, &path, found));
            }
            _ => {
                let table = match &path[..path.len() - 1] {
                    [materials, _] if materials == "materials" => "materials.NAME".to_owned(),
                    table => table.join("."),
                };
                found.insert((table, of_type.map(str::to_owned), name.clone()));
            }
        }
    }
}

#[test]
fn every_value_has_a_key() {
    let folder = folder();
    let mut found = BTreeSet::new();
    for mut description in descriptions(folder.path()) {
        let arrays = SphereArrays::from_rows(vec![[0.0, 0.0, 0.0, 1.0]]);
        let arrays = arrays.with_colors(vec![[0.5f32; 3]]);
        let data = SphereData::Memory(arrays);
        description.tables.push(SphereTable { data, ..SphereTable::default() });
        let appearance = Appearance {
            select: Some("z > 0".into()),
            slice: Some("x > 0".into()),
            ..Appearance::default()
        };
        let particles = ParticleTable {
            path: "run.xtc".into(),
            format: Some(Format::Xtc),
            columns: vec!["x".into()],
            topology: Some("conf.gro".into()),
            appearance,
            ..ParticleTable::default()
        };
        let data = SphereData::Particles(Box::new(particles));
        description.tables.push(SphereTable { data, ..SphereTable::default() });
        leaves(&description.to_keys(), &[], &mut found);
    }
    settings().for_each(|settings| leaves(&settings.to_keys(), &[], &mut found));
    let keys = all();
    for (table, of_type, name) in &found {
        let is_it = |key: &&photosphere::scene::keys::KeyInfo| {
            let of_type = key.of_type.is_none() || key.of_type == of_type.as_deref();
            key.table == table && of_type && key.name == name
        };
        assert_eq!(keys.iter().filter(is_it).count(), 1, "{table}.{name} ({of_type:?})");
    }
    // The other keys stand for values that others say.
    let is_found = |key: &&photosphere::scene::keys::KeyInfo| {
        found.iter().any(|(table, of_type, name)| {
            let of_type = key.of_type.is_none() || key.of_type == of_type.as_deref();
            key.table == table && of_type && key.name == name
        })
    };
    let others: Vec<&str> = keys.iter().filter(|key| !is_found(key)).map(|key| key.name).collect();
    let expected = [
        "format",
        "f_number",
        "meters_per_unit",
        "preset",
        "strength",
        "elevation_degrees",
        "azimuth_degrees",
        "metal",
        "glass",
    ];
    assert_eq!(others, expected);
}

/// A value in TOML; the names of materials are quoted already.
fn toml(value: &Value) -> String {
    match value {
        Value::Null => panic!("what is left out has no key"),
        Value::Object(map) => {
            let entries: Vec<_> =
                map.iter().map(|(key, value)| format!("{key} = {}", toml(value))).collect();
            format!("{{ {} }}", entries.join(", "))
        }
        Value::Array(list) => format!("[{}]", list.iter().map(toml).collect::<Vec<_>>().join(", ")),
        other => other.to_string(),
    }
}

#[test]
fn a_file_with_these_keys_has_the_same_values() {
    let folder = folder();
    let mut settings = settings();
    for description in descriptions(folder.path()) {
        let mut read = |settings: Settings| {
            let mut text = "format = 1\n".to_owned();
            for tree in [description.to_keys(), settings.to_keys()] {
                for (key, value) in tree.as_object().expect("a table") {
                    text += &format!("{key} = {}\n", toml(value));
                }
            }
            let file = read_text("test.toml", &text, Path::new(""), &[]);
            let file = file.unwrap_or_else(|error| panic!("{error}\n{text}"));
            assert_eq!(file.description, description);
            assert_eq!(file.settings, settings);
        };
        settings.by_ref().take(2).for_each(&mut read);
        read(Settings::default());
    }
}
