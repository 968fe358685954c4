//! Standard scenes of `photosphere bench --suite`: identical on every machine, of any size, built
//! in memory.

use std::sync::Arc;

use rayon::prelude::*;

use crate::camera::{Camera, CameraModel, CameraPose};
use crate::error::Result;
use crate::generate::{Arrangement, Recipe};
use crate::geometry::{PathRay, Sphere, SphereRows, SphereSet};
use crate::math::DVec3;

use super::camera_rays;

/// Image width and height in pixels for the camera rays; there is one ray per pixel.
const SIDE: u32 = 512;
/// Seed of the sphere generator.
const SEED: u64 = 0;

/// Spheres, with camera rays that look at them.
#[derive(Debug)]
pub struct StandardScene {
    /// The spheres.
    pub spheres: Arc<SphereSet>,
    /// Camera rays, as returned by [`camera_rays`].
    pub camera_rays: Vec<PathRay>,
}

impl StandardScene {
    /// Generates `count` spheres as `photosphere generate` does, seen by the camera of the scene
    /// that it writes.
    ///
    /// # Errors
    /// If the number of spheres is out of range.
    pub fn new(arrangement: Arrangement, count: u64) -> Result<Self> {
        Self::with_extra_spheres(Vec::new(), arrangement, count)
    }

    /// Generates a standard scene with the additional spheres `exact`.
    ///
    /// # Errors
    /// Same as [`Self::new`].
    pub fn with_extra_spheres(
        exact: Vec<Sphere>,
        arrangement: Arrangement,
        count: u64,
    ) -> Result<Self> {
        let recipe = Recipe::new(arrangement, count, SEED, false)?;
        let table = (0..count).into_par_iter().map(|index| recipe.sphere(index).sphere).collect();
        let spheres = SphereSet::new(SphereRows { exact, table })?;
        let (position, look_at, fov) = recipe.viewpoint();
        let pose = CameraPose {
            position: DVec3::from_array(position) - spheres.origin(),
            view_direction: DVec3::from_array(look_at) - DVec3::from_array(position),
            up: DVec3::Y,
            near: 0.0,
            resolution: [SIDE; 2],
        };
        let model = CameraModel::Perspective { vertical_fov: fov.to_radians(), lens: None };
        let camera = Camera::new(&pose, model);
        let camera = camera_rays(&camera, [SIDE; 2], (SIDE * SIDE) as usize);
        Ok(Self { spheres: Arc::new(spheres), camera_rays: camera })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::{Backend, BuildOptions};
    use crate::math::{Hit, Ray};

    #[test]
    fn the_camera_sees_the_spheres_however_many_there_are() {
        for &(name, arrangement) in Arrangement::NAMES {
            for count in [3, 1000] {
                let scene = StandardScene::new(arrangement, count).unwrap();
                let options = BuildOptions::default();
                let accel = Backend::Native.build(&scene.spheres, &options).unwrap();
                let rays: Vec<Ray> =
                    scene.camera_rays.iter().map(|ray| scene.spheres.to_query(ray)).collect();
                let mut hits = vec![Hit::MISS; rays.len()];
                accel.closest(&rays, &mut hits);
                let hit_count = hits.iter().filter(|hit| !hit.is_miss()).count();
                assert!(hit_count > 100, "{name} {count}: {hit_count} of {}", rays.len());
            }
        }
    }
}
