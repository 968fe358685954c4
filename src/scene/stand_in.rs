//! STAND-IN, to be replaced by the real scene when merging.
#![allow(missing_docs, reason = "thrown away when merging")]

use std::path::Path;
use std::sync::Arc;

use crate::error::Result;
use crate::geometry::{PathRay, SphereSet};
use crate::math::DVec3;

use super::description::Description;
use super::{Loaded, Override, read_file};

pub struct Scene {
    description: Description,
    spheres: Arc<SphereSet>,
    camera: Camera,
}

pub struct Lights;
impl Lights {
    #[allow(clippy::len_without_is_empty, reason = "stand-in")]
    pub fn len(&self) -> usize {
        0
    }
}

pub struct Camera {
    position: DVec3,
    towards: DVec3,
}
impl Camera {
    pub fn ray(&self, x: f64, y: f64) -> PathRay {
        let shift = DVec3::new(x, y, 0.0).fract() - 0.5;
        PathRay::free(self.position, (self.towards.normalize() + shift).normalize())
    }
}

impl Scene {
    pub fn load(path: &Path, overrides: &[Override]) -> Result<Self> {
        let Loaded { description, rows, .. } = read_file(path, overrides)?;
        let spheres = Arc::new(SphereSet::new(rows)?);
        let camera = Camera {
            position: description.camera.position - spheres.origin(),
            towards: description.camera.look_at - description.camera.position,
        };
        Ok(Self { description, spheres, camera })
    }
    pub fn spheres(&self) -> &Arc<SphereSet> {
        &self.spheres
    }
    pub fn description(&self) -> &Description {
        &self.description
    }
    pub fn lights(&self) -> Lights {
        Lights
    }
    pub fn camera(&self) -> &Camera {
        &self.camera
    }
}
