//! Finds the sphere that a pixel of a picture shows.

use std::path::Path;

use crate::accel::{Accel, Backend, BuildOptions};
use crate::error::{Error, Result};
use crate::math::{DVec3, Hit};
use crate::scene::PreparedScene;
use crate::scene::description::SphereTable;

use super::metadata::Metadata;
use super::reproduce::{ReproduceOptions, rebuild_scene};

/// A sphere that a pixel shows.
#[derive(Clone, Debug, PartialEq)]
pub struct Pick {
    /// The name of the sphere.
    pub name: String,
    /// Row in the scene.
    pub row: u32,
    /// The table that it comes from, and its row there; `None` for a sphere of its own.
    pub table: Option<(SphereTable, u32)>,
    /// Centre of the sphere.
    pub center: DVec3,
    /// Radius of the sphere.
    pub radius: f64,
    /// Distance from the camera.
    pub distance: f64,
}

/// Finds the sphere in the middle of a pixel of a picture; `None` if there is the background.
/// `folder` is that of the scene's files, which are checked to be those of the picture.
///
/// # Errors
/// If the picture has no such pixel, or its scene has changed.
pub fn pick(recorded: &Metadata, folder: &Path, [x, y]: [u32; 2]) -> Result<Option<Pick>> {
    let image = &recorded.settings.image;
    if x >= image.width || y >= image.height {
        let (width, height) = (image.width, image.height);
        return Err(Error::input(format!("the picture has no pixel {x}, {y}"))
            .with_help(format!("it has {width} columns and {height} rows, counted from 0")));
    }
    let options = ReproduceOptions { folder: folder.to_path_buf(), ..Default::default() };
    let scene = rebuild_scene(recorded, &options)?;
    let prepared = PreparedScene::new(&scene, recorded.settings)?;
    let accel = Backend::BruteForce.build(scene.spheres(), &BuildOptions::default())?;
    Ok(pick_in_scene(&prepared, accel.as_ref(), [x, y]))
}

/// Finds the sphere in the middle of a pixel of the full picture; `None` if there is the
/// background.
pub fn pick_in_scene(prepared: &PreparedScene, accel: &dyn Accel, pixel: [u32; 2]) -> Option<Pick> {
    let scene = prepared.scene();
    let [x, y] = pixel.map(|pixel| f64::from(pixel) + 0.5);
    let ray = prepared.camera().generate_ray(x, y, [0.5; 2]);
    let spheres = scene.spheres();
    let mut hit = [Hit::MISS];
    accel.closest(&[spheres.to_query(&ray)], &mut hit);
    let found = spheres.resolve_hit(&ray, hit[0])?;
    let (row, sphere) = (spheres.row(found.id), spheres.sphere(found.id));
    let table = scene
        .table_and_row(row)
        .map(|(index, row)| (scene.description().tables[index].clone(), row));
    Some(Pick {
        name: scene.name_of_row(row),
        row,
        table,
        center: sphere.center + spheres.origin(),
        radius: sphere.radius,
        distance: found.t,
    })
}
