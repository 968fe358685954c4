//! The sections of a scene file, each with its keys.

use crate::scene::description::{ProjectionKind, SurfaceKind};

use super::entries::{background, camera, image, material, render, root, sphere, table};
use super::{DynKey, TableSchema};

const fn untyped_table(
    path: &'static str,
    help: &'static str,
    keys: &'static [&'static dyn DynKey],
) -> TableSchema {
    TableSchema { path, help, keys, types: &[] }
}

/// Every table of a scene file.
pub(super) const TABLES: &[TableSchema] = &[
    untyped_table("", "a scene", root::ALL),
    untyped_table("image", "the picture", image::ALL),
    TableSchema {
        path: "camera",
        help: "where the picture is seen from",
        keys: camera::ALL,
        types: &[
            (ProjectionKind::Perspective.name(), camera::perspective::ALL),
            (ProjectionKind::Orthographic.name(), camera::orthographic::ALL),
            (ProjectionKind::Panoramic.name(), camera::panoramic::ALL),
        ],
    },
    untyped_table("background", "what a ray sees that hits nothing", background::ALL),
    untyped_table("background.gradient", "from above to below", background::gradient::ALL),
    untyped_table("background.image", "a picture of the surroundings", background::image::ALL),
    untyped_table("background.sky", "a clear sky", background::sky::ALL),
    untyped_table("background.sun", "the sun's disc", background::sun::ALL),
    TableSchema {
        path: "materials.NAME",
        help: "a surface",
        keys: material::ALL,
        types: &[
            (SurfaceKind::Diffuse.name(), material::diffuse::ALL),
            (SurfaceKind::Mirror.name(), material::mirror::ALL),
            (SurfaceKind::Conductor.name(), material::conductor::ALL),
            (SurfaceKind::Dielectric.name(), material::dielectric::ALL),
            (SurfaceKind::Plastic.name(), material::plastic::ALL),
            (SurfaceKind::Principled.name(), material::principled::ALL),
            (SurfaceKind::Phong.name(), material::phong::ALL),
        ],
    },
    untyped_table("spheres", "a sphere", sphere::ALL),
    untyped_table("sphere_tables", "many spheres from a file", table::ALL),
    untyped_table("render", "how the light is computed", render::ALL),
    untyped_table(
        "render.ambient_occlusion",
        "used only by ambient-occlusion",
        render::ambient_occlusion::ALL,
    ),
    untyped_table("render.paper", "used only by paper", render::paper::ALL),
    untyped_table("render.raycast", "used only by raycast", render::raycast::ALL),
];
