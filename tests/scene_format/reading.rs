//! What a good scene becomes.

use std::path::Path;

use photosphere::color::Rgb;
use photosphere::math::DVec3;
use photosphere::scene::description::{Dome, FilterKind, Integrator, Projection, Surface};
use photosphere::scene::{Colors, Loaded, read_file};

use crate::scenes::{EXAMPLE, SCENE, load};

#[test]
fn the_example_is_read_as_written() {
    let Loaded { description, rows, groups, .. } = load(EXAMPLE, &[]).expect("a good scene");
    assert_eq!((description.image.width, description.image.height), (640, 480));
    assert_eq!(description.image.filter, FilterKind::Box);
    assert_eq!(description.camera.position, DVec3::new(1.0, 2.0, 9.0));
    let pinhole = Projection::Perspective { vertical_fov_degrees: 36.0, lens: None };
    assert_eq!(description.camera.projection, pinhole);
    let names: Vec<_> = description.materials.iter().map(|material| &*material.name).collect();
    assert_eq!(names, ["grass", "lamp"]);
    assert_eq!(description.materials[1].emission.to_array(), [18.0, 17.0, 15.0]);
    assert_eq!(description.spheres[0].name.as_deref(), Some("ground"));
    assert_eq!(description.render.integrator, Integrator::Path);
    assert_eq!(description.render.max_depth, Some(6));
    assert_eq!(rows.exact[0].center.y, -250.0);
    assert_eq!(rows.table, [[1.0, 2.0, 3.0, 0.5], [-1.0, 0.0, 1.0, 0.25]]);
    assert!(rows.table.capacity() >= 3, "there is room for the exact sphere");
    assert_eq!((groups[0].first_row, groups[0].count, groups[0].material), (1, 2, 0));
    let colors = Colors::Exact(vec![[0.25, 0.5, 0.75], [0.0, 1.0, 0.5]]);
    assert_eq!(groups[0].colors, Some(colors));
}

#[test]
fn what_is_left_out_has_its_default() {
    let description = load(SCENE, &[]).expect("a good scene").description;
    assert_eq!((description.camera.up, description.camera.near), (DVec3::Y, 0.0));
    let background = &description.background;
    assert_eq!(background.dome, Dome::Constant { radiance: [0.0; 3].into() });
    assert!(background.camera_visible && !background.transparent && background.sun.is_none());
    assert_eq!(description.image.filter_radius, 0.5);
    assert_eq!(
        description.materials[1].surface,
        Surface::Dielectric { ior: 1.5, roughness: 0.0, priority: 0, absorption: Rgb::ZERO }
    );
    let render = description.render;
    assert_eq!((render.samples_per_pixel, render.max_depth, render.seed), (64, None, 7));
    for (filter, radius) in [("tent", 1.0), ("gaussian", 1.5), ("blackman-harris", 2.0)] {
        let option = format!("image.filter={filter}");
        let image = load(SCENE, &[&option]).expect("a good scene").description.image;
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
