//! What a good scene becomes.

use std::path::Path;

use photosphere::color::Rgb;
use photosphere::geometry::Sphere;
use photosphere::math::DVec3;
use photosphere::scene::description::{
    EnvironmentDescription, ProjectionDescription, SurfaceModel,
};
use photosphere::scene::settings::{FilterKind, IntegratorSettings};
use photosphere::scene::{Scene, SceneFile, read_file};

use crate::scenes::{EXAMPLE, SCENE, load};

#[test]
fn the_example_is_read_as_written() {
    let file = load(EXAMPLE, &[]).expect("a good scene");
    let SceneFile { description, settings, .. } = &file;
    assert_eq!((settings.image.width, settings.image.height), (640, 480));
    assert_eq!(settings.image.filter, FilterKind::Box);
    assert_eq!(description.camera.position, DVec3::new(1.0, 2.0, 9.0));
    let pinhole = ProjectionDescription::Perspective { vertical_fov_degrees: 36.0, lens: None };
    assert_eq!(description.camera.projection, pinhole);
    let names: Vec<_> = description.materials.iter().map(|material| &*material.name).collect();
    assert_eq!(names, ["grass", "lamp"]);
    assert_eq!(description.materials[1].emission.to_array(), [18.0, 17.0, 15.0]);
    assert_eq!(description.spheres[0].name.as_deref(), Some("ground"));
    assert_eq!(settings.render.integrator, IntegratorSettings::Path);
    assert_eq!(settings.render.max_depth, Some(6));
    assert_eq!(description.spheres[0].center.y, -250.0);
    let (scene, _) = file.build().expect("a good table");
    assert_eq!(row(&scene, 1), Sphere { center: DVec3::new(1.0, 2.0, 3.0), radius: 0.5 });
    assert_eq!(row(&scene, 2), Sphere { center: DVec3::new(-1.0, 0.0, 1.0), radius: 0.25 });
    assert_eq!([1, 2].map(|row| scene.material_of_row(row)), [0, 0]);
    let albedo = |row| scene.sphere_material(id(&scene, row)).albedo.expect("a colour");
    let colors = [[0.25, 0.5, 0.75], [0.0, 1.0, 0.5]];
    assert_eq!([1, 2].map(|row| albedo(row).to_array()), colors);
}

/// The id of a row.
fn id(scene: &Scene, row: u32) -> u32 {
    let rows = scene.spheres().rows();
    rows.iter().position(|&of_id| of_id == row).expect("every row has an id") as u32
}

/// The sphere in a row, where the user put it.
fn row(scene: &Scene, row: u32) -> Sphere {
    let Sphere { center, radius } = scene.spheres().sphere(id(scene, row));
    Sphere { center: center + scene.spheres().origin(), radius }
}

#[test]
fn what_is_left_out_has_its_default() {
    let SceneFile { description, settings, .. } = load(SCENE, &[]).expect("a good scene");
    assert_eq!((description.camera.up, description.camera.near), (DVec3::Y, 0.0));
    let background = &description.background;
    assert_eq!(background.dome, EnvironmentDescription::Constant { radiance: [0.0; 3].into() });
    assert!(background.camera_visible && !background.transparent && background.sun.is_none());
    assert_eq!(settings.image.filter_radius, 0.5);
    assert_eq!(
        description.materials[1].surface,
        SurfaceModel::Dielectric { ior: 1.5, roughness: 0.0, priority: 0, absorption: Rgb::ZERO }
    );
    let render = settings.render;
    assert_eq!((render.samples_per_pixel, render.max_depth, render.seed), (64, None, 7));
    for (filter, radius) in [("tent", 1.0), ("gaussian", 1.5), ("blackman-harris", 2.0)] {
        let option = format!("image.filter={filter}");
        let image = load(SCENE, &[&option]).expect("a good scene").settings.image;
        assert_eq!(image.filter_radius, radius);
    }
}

#[test]
fn the_examples_in_the_manual_and_in_scenes_are_good() {
    let manual = include_str!("../../docs/scene-format.md");
    let blocks: Vec<_> = manual.split("```toml\n").skip(1).collect();
    assert!(!blocks.is_empty());
    for block in blocks {
        let (example, _) = block.split_once("```").expect("a closed block");
        load(example, &[]).expect("the manual is right");
    }
    for scene in ["scenes/furnace.toml", "scenes/cornell-spheres.toml"] {
        read_file(Path::new(scene), &[]).expect("our own scene");
    }
}
