//! The sections of a scene file, each with its keys.

use crate::scene::description::ProjectionKind;

use super::entries::{camera, image, light, root, sphere, table};
use super::key::{TableSchema, untyped_table};
use super::{background, material, particles, render};

/// Every table of a scene file.
pub(super) fn tables() -> impl Iterator<Item = &'static TableSchema> {
    BEFORE_BACKGROUND.iter().chain(background::TABLES).chain(AFTER_BACKGROUND)
}

const BEFORE_BACKGROUND: &[TableSchema] = &[
    untyped_table("", "a scene", root::ALL),
    untyped_table("image", "the picture", image::ALL),
    TableSchema {
        path: "camera",
        help: "the camera",
        keys: camera::ALL,
        types: &[
            (ProjectionKind::Perspective.name(), camera::perspective::ALL),
            (ProjectionKind::Orthographic.name(), camera::orthographic::ALL),
            (ProjectionKind::Panoramic.name(), camera::panoramic::ALL),
        ],
    },
    untyped_table("light", "light by name, in place of a background", light::ALL),
];

/// Returns true if a scene has a list of tables of this name.
pub(in crate::scene) fn is_list(name: &str) -> bool {
    matches!(name, "spheres" | "sphere_tables" | "particles")
}

const AFTER_BACKGROUND: &[TableSchema] = &[
    TableSchema {
        path: "materials.NAME",
        help: "a material",
        keys: material::ALL,
        types: material::TYPES,
    },
    untyped_table("spheres", "a sphere", sphere::ALL),
    untyped_table("sphere_tables", "many spheres from a file", table::ALL),
    untyped_table("particles", "many spheres from a file of another program", particles::ALL),
    untyped_table("render", "how light is computed", render::ALL),
    untyped_table(
        "render.ambient_occlusion",
        "options for ambient-occlusion",
        render::ambient_occlusion::ALL,
    ),
    untyped_table("render.paper", "options for paper", render::paper::ALL),
    untyped_table("render.raycast", "options for raycast", render::raycast::ALL),
];
