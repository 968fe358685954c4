//! Intel Embree, behind our own C shim (`ffi/shim.c`).
//!
//! Particles are sphere points, or user geometry on request. Giants and other large spheres are
//! always user geometry ([`group`]). Embree finds candidates, which are tested in C, in f64, with
//! the operations of [`crate::geometry::Sphere::first_root`] on the spheres that the user wrote. So
//! the hits are those of all other backends, whatever instructions Embree uses. Rays are traced in
//! a loop in C. That loop does not check Embree's error state: only invalid rays could cause an
//! error, and they never reach Embree.
//!
//! Only this module and the native kernel contain `unsafe` code. No Embree types appear here:
//! `ffi/shim.h` uses only handles and plain numbers.

mod device;
mod group;
mod scene;
mod sys;
mod threads;

#[cfg(test)]
mod tests;

use std::sync::Arc;

use crate::error::{Error, Result, Suggestion};
use crate::geometry::SphereSet;
use crate::math::{Hit, Ray};

use super::info::EmbreeInfo;
use super::intersector::{Accel, ErrorBound};
use super::options::BuildOptions;

pub(super) use group::ParticleGeometry;

use device::Device;
use group::SphereGroup;
use scene::{EmbreeScene, EmbreeSceneBuilder, Geometry};

/// The backend: a scene for each group of spheres.
pub(super) struct Embree {
    scenes: Vec<EmbreeScene>,
    device: Arc<Device>,
}

impl Embree {
    pub(super) fn build(
        set: &Arc<SphereSet>,
        particles: ParticleGeometry,
        options: &BuildOptions,
    ) -> Result<Self> {
        threads::check(options.threads)?;
        let device = Device::new(options.threads)?;
        check_support(&describe(&device)?, particles)?;
        let scene = |group: &Arc<SphereGroup>| {
            let geometry = Geometry::new(&device, group)?;
            EmbreeSceneBuilder::new(&device)?.attach(&geometry)?.commit(options)
        };
        let groups = SphereGroup::divide(set, particles);
        let scenes = groups.iter().map(scene).collect::<Result<_>>()?;
        Ok(Self { scenes, device })
    }
}

impl Accel for Embree {
    fn closest(&self, rays: &[Ray], hits: &mut [Hit]) {
        scene::closest(&self.scenes, rays, hits);
    }

    fn occluded(&self, rays: &[Ray], occluded: &mut [bool]) {
        scene::occluded(&self.scenes, rays, occluded);
    }

    /// Candidates are tested in f64 from the 48-bit ray, and none is lost ([`group`]). So the error
    /// is that of the other backends, `k 2^-24 = 2^-44`.
    fn error_bound(&self) -> ErrorBound {
        let k = 2f64.powi(-20);
        ErrorBound { particles: k, giants: k, rounds_origin: false }
    }

    fn bytes(&self) -> usize {
        // All scenes share the device.
        self.device.bytes() + self.scenes.iter().map(EmbreeScene::group_bytes).sum::<usize>()
    }
}

/// Version and features of the Embree in use.
pub(super) fn info() -> Result<EmbreeInfo> {
    let device = Device::new(0)?;
    describe(&device)
}

fn describe(device: &Device) -> Result<EmbreeInfo> {
    let info = device.describe()?;
    let version = |v: u32| format!("{}.{}.{}", v / 10_000, v / 100 % 100, v % 100);
    let required_features = [
        (info.sphere_points, "sphere points"),
        (info.user_geometry, "user geometry"),
        (info.filters, "filter functions"),
    ];
    Ok(EmbreeInfo {
        compiled_version: version(info.compiled_version),
        runtime_version: version(info.runtime_version),
        instruction_set: match info.packet_width {
            16 => "AVX-512",
            8 if cfg!(target_arch = "x86_64") => "AVX or AVX2",
            4 if cfg!(target_arch = "x86_64") => "SSE",
            4 | 8 => "NEON",
            _ => "unknown",
        },
        tasking: match info.tasking {
            0 => "Embree's own threads",
            1 => "TBB",
            2 => "PPL",
            _ => "unknown",
        },
        culls_sphere_back_faces: match info.culls_sphere_back_faces {
            0 => Some(false),
            1 => Some(true),
            _ => None,
        },
        missing: required_features
            .iter()
            .filter(|(is_supported, _)| !is_supported)
            .map(|(_, name)| *name)
            .collect(),
    })
}

/// Rejects an Embree build that would silently give wrong results.
fn check_support(info: &EmbreeInfo, particles: ParticleGeometry) -> Result<()> {
    if let Some(feature) = info.missing.first() {
        return Err(Error::backend(format!("this Embree was built without {feature}"))
            .with_help("install another build of Embree, or choose another intersector")
            .with_suggestion(Suggestion::Intersector, "native"));
    }
    if particles == ParticleGeometry::Points && info.culls_sphere_back_faces == Some(true) {
        return Err(Error::backend(
            "this Embree was built with EMBREE_BACKFACE_CULLING_SPHERES: it does not see spheres \
             from inside",
        )
        .with_help("choose the intersector `embree-user` or `native`")
        .with_suggestion(Suggestion::Intersector, "embree-user"));
    }
    Ok(())
}
