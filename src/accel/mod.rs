//! Who is hit? One trait, and its backends, built from the same [`SphereSet`].

mod brute_force;
mod choice;
#[cfg(feature = "embree")]
#[allow(unsafe_code, reason = "the fence around Embree")]
mod embree;
mod info;
mod native;
mod plan;

use std::str::FromStr;
use std::sync::Arc;

use crate::error::{Error, Result};
use crate::geometry::{PathRays, SphereSet};
use crate::math::{Hit, Ray};
use crate::names::named;
use crate::task::{Cancel, Progress};

pub use choice::{Choice, Chosen};
pub use info::EmbreeInfo;
pub use native::Instance;
pub use plan::PlannedBytes;

/// An intersector over a fixed set of spheres.
///
/// Rays come in batches of any length; a batch of one is a single ray. Answers are in the order of
/// the rays. A ray that is not [valid](Ray::is_valid) hits nothing. All backends overlook excluded
/// spheres, report the far wall of a sphere that the ray starts in, and take hits in the open
/// interval `(t_min, t_max)` only. Where two spheres are hit at exactly the same distance, the
/// backends in Rust answer the smaller id, whatever order they met them in.
pub trait Accel: Send + Sync {
    /// The first sphere that each ray hits. The slices have equal lengths.
    fn closest(&self, rays: &[Ray], hits: &mut [Hit]);

    /// Whether each ray hits anything. The slices have equal lengths.
    fn occluded(&self, rays: &[Ray], blocked: &mut [bool]);

    /// [`Self::closest`] for the f64 rays of paths. Most backends are asked with [`SphereSet::ask`] of
    /// each, for which `asked` is room; one that computes in f64 may take them as they are.
    fn closest_of(
        &self,
        spheres: &SphereSet,
        rays: &PathRays,
        asked: &mut Vec<Ray>,
        hits: &mut [Hit],
    ) {
        ask(spheres, rays, asked);
        self.closest(asked, hits);
    }

    /// [`Self::occluded`] for the f64 rays of paths.
    fn occluded_of(
        &self,
        spheres: &SphereSet,
        rays: &PathRays,
        asked: &mut Vec<Ray>,
        blocked: &mut [bool],
    ) {
        ask(spheres, rays, asked);
        self.occluded(asked, blocked);
    }

    /// How far this backend's arithmetic may move a sphere's surface for a ray.
    fn precision(&self) -> Precision;

    /// Bytes held by the structure, without the spheres themselves.
    fn bytes(&self) -> usize;

    /// How it was built and works, in a few words for people; empty where there is nothing to say.
    fn details(&self) -> String {
        String::new()
    }
}

fn ask(spheres: &SphereSet, rays: &PathRays, asked: &mut Vec<Ray>) {
    asked.clear();
    asked.extend(rays.iter().map(|ray| spheres.ask(&ray)));
}

/// The stated error of a backend's arithmetic, as a backward error: an answer is exact for spheres
/// whose radius was changed by at most `k 2^-24 (|o - c| + R)`, plus what rounding the ray's own
/// origin to f32 moved it.
///
/// `crosscheck` and the differential tests accept an id that differs from the judge's only within
/// this band.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Precision {
    /// The factor `k` for spheres stored in f32.
    pub particles: f64,
    /// The factor `k` for giants.
    pub giants: f64,
    /// Whether the backend traces from the origin as rounded to f32.
    pub rounds_origin: bool,
}

/// The backends that can be asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Backend {
    /// Embree: particles as sphere points, giants as user geometry.
    Embree,
    /// Embree: every sphere as user geometry, with callbacks in C.
    EmbreeUser,
    /// The bounding volume hierarchy in Rust.
    Native,
    /// Every ray against every sphere, in f64: the oracle, and fine for tiny scenes.
    BruteForce,
}

/// How a backend is built.
#[derive(Clone, Debug, Default)]
pub struct BuildOptions {
    /// Threads that Embree's own build may use; 0 means all. The native backend builds on the
    /// current rayon pool.
    pub threads: usize,
    /// How much care the native backend takes.
    pub quality: Quality,
    /// Told how far a build is.
    pub progress: Progress,
    /// The form of the native kernel; the fastest that there is where `None`.
    pub instance: Option<Instance>,
    /// Set from elsewhere to stop the build, which then fails with a cancellation.
    pub cancel: Cancel,
}

/// How much care a build takes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Quality {
    /// For pictures that take longer than the build.
    #[default]
    Best,
    /// Three times faster to build, and up to a tenth slower to trace: for previews.
    Fast,
}

named! {
    Backend {
        Embree = "embree",
        EmbreeUser = "embree-user",
        Native = "native",
        BruteForce = "brute-force",
    }
}

impl Backend {
    /// Every backend of this build, the default first.
    pub const AVAILABLE: &[Self] = if cfg!(feature = "embree") {
        &[Self::Embree, Self::EmbreeUser, Self::Native, Self::BruteForce]
    } else {
        &[Self::Native, Self::BruteForce]
    };

    /// Every backend there is.
    pub const ALL: &[Self] = &[Self::Embree, Self::EmbreeUser, Self::Native, Self::BruteForce];

    /// The name with the version of what does the work, such as `embree 4.3.3`: backends that say
    /// the same here answer alike. Ours change with the program alone.
    pub fn name_and_version(self) -> String {
        match (self, embree_info()) {
            (Self::Embree | Self::EmbreeUser, Some(Ok(info))) => {
                format!("{} {}", self.name(), info.runtime_version)
            }
            _ => self.name().to_owned(),
        }
    }

    /// Whether it needs Embree.
    pub fn uses_embree(self) -> bool {
        matches!(self, Self::Embree | Self::EmbreeUser)
    }

    /// Builds this backend over the spheres.
    ///
    /// # Errors
    /// When this build has no such backend, when Embree reports an error, or on cancellation.
    pub fn build(self, spheres: &Arc<SphereSet>, options: &BuildOptions) -> Result<Box<dyn Accel>> {
        options.cancel.check()?;
        match self {
            Self::Native => Ok(Box::new(native::Native::new(Arc::clone(spheres), options)?)),
            #[cfg(feature = "embree")]
            Self::Embree => {
                Ok(Box::new(embree::Embree::build(spheres, embree::Particles::Points, options)?))
            }
            #[cfg(feature = "embree")]
            Self::EmbreeUser => {
                Ok(Box::new(embree::Embree::build(spheres, embree::Particles::User, options)?))
            }
            Self::BruteForce => Ok(Box::new(brute_force::BruteForce::new(spheres.clone()))),
            #[cfg(not(feature = "embree"))]
            Self::Embree | Self::EmbreeUser => {
                Err(Error::backend(format!("this build has no `{}` intersector", self.name()))
                    .with_help("build with the default features, or choose another intersector")
                    .with_setting(crate::error::Setting::Intersector, "native"))
            }
        }
    }
}

impl Default for Backend {
    fn default() -> Self {
        Self::AVAILABLE[0]
    }
}

impl Quality {
    /// Every kind of care.
    pub const ALL: &[Self] = &[Self::Best, Self::Fast];
}

named! { Quality { Best = "best", Fast = "fast" } }

impl FromStr for Quality {
    type Err = Error;

    fn from_str(name: &str) -> Result<Self> {
        Self::named(name).ok_or_else(|| Error::input(format!("there is no build `{name}`")))
    }
}

impl FromStr for Backend {
    type Err = Error;

    fn from_str(name: &str) -> Result<Self> {
        Self::named(name).ok_or_else(|| Error::input(format!("there is no intersector `{name}`")))
    }
}

/// What the Embree in use says of itself; `None` in a build without Embree.
///
/// # Errors
/// When Embree cannot start.
pub fn embree_info() -> Option<Result<EmbreeInfo>> {
    #[cfg(feature = "embree")]
    return Some(embree::info());
    #[cfg(not(feature = "embree"))]
    None
}
