//! Intel Embree behind our own C shim (`ffi/shim.c`).
//!
//! Particles are sphere points that share the [`SphereSet`]'s own array, or user geometry on
//! request; giants are always user geometry. User geometry is intersected in C, in f64, with the
//! operations of [`crate::geometry::Sphere::first_root`]. Rays are traced in a loop in C; nothing
//! is asked of Embree's error state on that path, because invalid rays, the one way to fail there,
//! never reach Embree.
//!
//! This and the native kernel are the places with `unsafe` code. No Embree type enters here:
//! `ffi/shim.h` speaks of handles and plain numbers only.

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

/// Spheres in an Embree scene.
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
/// vectors as rounded, it computes `s = (e.d) rcp(d.d)`, `p = e - s d`, and where `p.p <= R^2`,
/// `t = s -+ sqrt((R^2 - p.p) rcp(d.d))`. Each rounding moves the surface as the ray sees it by a
/// multiple of `u |e|` or of `u R`:
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
/// The largest column sums to 16. An error of `s` moves `p` along the ray, at a right angle to
/// `p`, so near the silhouette most of the 11 is of second order and real errors are far smaller.
///
/// Embree's tree is traversed with its robust flag, which loses nothing; but it rounds the boxes of
/// sphere points to nearest at the scale of `|c| + R`, the scale at which the ray's origin was
/// rounded too.
const POINTS_ERROR: f64 = 16.0;

/// `k` of user geometry. Distances are computed from the 48-bit ray, and compared, in f64; only
/// Embree's walk through its boxes uses the ray in f32, so that a sphere may be overlooked at its
/// box's very edge: 1 for the rounded direction, and 1 for the reciprocals in the box test.
const USER_ERROR: f64 = 2.0;

/// What the Embree in use says of itself.
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

/// Refuses an Embree that would answer wrongly without saying so.
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
