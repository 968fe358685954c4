//! The sections of a scene file, each with its keys.

use crate::scene::description::{ProjectionKind, SurfaceKind};

use super::entries::{background, camera, image, material, render, root, sphere, table};
use super::{AnyKey, Section};

const fn plain(
    path: &'static str,
    help: &'static str,
    keys: &'static [&'static dyn AnyKey],
) -> Section {
    Section { path, help, keys, types: &[] }
}

/// Every table of a scene file.
pub(super) const SECTIONS: &[Section] = &[
    plain("", "a scene", root::ALL),
    plain("image", "the picture", image::ALL),
    Section {
        path: "camera",
        help: "where the picture is seen from",
        keys: camera::ALL,
        types: &[
            (ProjectionKind::Perspective.name(), camera::perspective::ALL),
            (ProjectionKind::Orthographic.name(), camera::orthographic::ALL),
            (ProjectionKind::Panoramic.name(), camera::panoramic::ALL),
        ],
    },
    plain("background", "what a ray sees that hits nothing", background::ALL),
    plain("background.gradient", "from above to below", background::gradient::ALL),
    plain("background.image", "a picture of the surroundings", background::image::ALL),
    plain("background.sky", "a clear sky", background::sky::ALL),
    plain("background.sun", "the sun's disc", background::sun::ALL),
    Section {
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
    plain("spheres", "a sphere", sphere::ALL),
    plain("sphere_tables", "many spheres from a file", table::ALL),
    plain("render", "how the light is computed", render::ALL),
    plain(
        "render.ambient_occlusion",
        "used only by ambient-occlusion",
        render::ambient_occlusion::ALL,
    ),
    plain("render.paper", "used only by paper", render::paper::ALL),
    plain("render.raycast", "used only by raycast", render::raycast::ALL),
];
