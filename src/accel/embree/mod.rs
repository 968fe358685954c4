//! Intel Embree, behind our own C shim (`ffi/shim.c`).
//!
//! Particles are sphere points that share the array of the [`SphereSet`], or user geometry on
//! request. Giants are always user geometry. User geometry is intersected in C, in f64, with the
//! operations of [`crate::geometry::Sphere::first_root`]. Rays are traced in a loop in C. That loop
//! does not check Embree's error state: only invalid rays could cause an error, and they never
//! reach Embree.
//!
//! Only this module and the native kernel contain `unsafe` code. No Embree types appear here:
//! `ffi/shim.h` uses only handles and plain numbers.

mod device;
mod scene;
mod sys;

#[cfg(test)]
mod tests;

use std::sync::Arc;

use crate::error::{Error, Result, Suggestion};
use crate::geometry::SphereSet;
use crate::math::{Hit, Ray};

use super::info::EmbreeInfo;
use super::intersector::{Accel, ErrorBound};
use super::options::BuildOptions;

pub(super) use scene::ParticleGeometry;

use device::Device;
use scene::{EmbreeScene, EmbreeSceneBuilder, Geometry, SphereBuffers};

/// The backend: spheres in an Embree scene.
pub(super) struct Embree {
    scene: EmbreeScene,
    particles: ParticleGeometry,
}

impl Embree {
    pub(super) fn build(
        set: &Arc<SphereSet>,
        particles: ParticleGeometry,
        options: &BuildOptions,
    ) -> Result<Self> {
        let device = Device::new(options.threads)?;
        check_support(&describe(&device)?, particles)?;
        let spheres = SphereBuffers::new(set, particles);
        let mut builder = EmbreeSceneBuilder::new(&device)?;
        if spheres.point_count() > 0 {
            builder = builder.attach(&Geometry::points(&device, &spheres)?)?;
        }
        if spheres.user_count() > 0 {
            builder = builder.attach(&Geometry::user(&device, &spheres)?)?;
        }
        Ok(Self { scene: builder.commit(options)?, particles })
    }
}

impl Accel for Embree {
    fn closest(&self, rays: &[Ray], hits: &mut [Hit]) {
        self.scene.closest(rays, hits);
    }

    fn occluded(&self, rays: &[Ray], blocked: &mut [bool]) {
        self.scene.occluded(rays, blocked);
    }

    fn error_bound(&self) -> ErrorBound {
        let particles = match self.particles {
            ParticleGeometry::Points => POINTS_ERROR,
            ParticleGeometry::User => USER_ERROR,
        };
        ErrorBound { particles, giants: USER_ERROR, rounds_origin: true }
    }

    fn bytes(&self) -> usize {
        self.scene.bytes()
    }
}

/// `k` of sphere points, which Embree intersects in f32. With `u = 2^-24`, `e = c - o` and all
/// vectors as rounded, Embree computes `s = (e.d) rcp(d.d)`, `p = e - s d`, and where `p.p <= R^2`,
/// `t = s -+ sqrt((R^2 - p.p) rcp(d.d))`. Each rounding moves the apparent surface by a multiple of
/// `u |e|` or of `u R`:
///
/// | step | `u \|e\|` | `u R` |
/// |---|---|---|
/// | the direction, rounded to f32 | 1 | |
/// | `e` | 1 | |
/// | `s`: two dot products of 3, a reciprocal by one Newton step (4), a product | 11 | |
/// | `p`: a product and a difference (one rounding only where there is FMA) | 2 | |
/// | `p.p` and `R^2`, halved by the root | | 2 |
/// | half the chord: (difference, `rcp(d.d)` 7, product) halved, and the root | | 5.5 |
/// | `s -+ h` | 1 | 1 |
///
/// The largest column sums to 16. An error of `s` moves `p` along the ray, perpendicular to `p`, so
/// near the silhouette most of the 11 is a second-order effect and real errors are far smaller.
///
/// Embree's tree is traversed with the robust flag, which misses nothing. Embree does round the
/// boxes of sphere points to nearest at the scale of `|c| + R`, but the ray's origin was rounded at
/// that scale too.
const POINTS_ERROR: f64 = 16.0;

/// `k` of user geometry. Distances are computed and compared in f64 from the 48-bit ray. Only
/// Embree's tree traversal uses the ray in f32, so a sphere may be missed at the very edge of its
/// box: 1 for the rounded direction, and 1 for the reciprocals in the box test.
const USER_ERROR: f64 = 2.0;

/// Version and features of the Embree in use.
pub(super) fn info() -> Result<EmbreeInfo> {
    let device = Device::new(0)?;
    describe(&device)
}

fn describe(device: &Device) -> Result<EmbreeInfo> {
    let found = device.describe()?;
    let version = |v: u32| format!("{}.{}.{}", v / 10_000, v / 100 % 100, v % 100);
    let needed = [
        (found.sphere_points, "sphere points"),
        (found.user_geometry, "user geometry"),
        (found.filters, "filter functions"),
    ];
    Ok(EmbreeInfo {
        compiled_version: version(found.compiled_version),
        runtime_version: version(found.runtime_version),
        instruction_set: match found.packet_width {
            16 => "AVX-512",
            8 if cfg!(target_arch = "x86_64") => "AVX or AVX2",
            4 if cfg!(target_arch = "x86_64") => "SSE",
            4 | 8 => "NEON",
            _ => "unknown",
        },
        tasking: match found.tasking {
            0 => "Embree's own threads",
            1 => "TBB",
            2 => "PPL",
            _ => "unknown",
        },
        culls_sphere_back_faces: match found.culls_sphere_back_faces {
            0 => Some(false),
            1 => Some(true),
            _ => None,
        },
        missing: needed.iter().filter(|(there, _)| !there).map(|(_, name)| *name).collect(),
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
