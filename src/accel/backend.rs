//! The backends, by name.

use std::str::FromStr;
use std::sync::Arc;

use crate::error::{Error, Result};
use crate::geometry::SphereSet;
use crate::names::named_enum;

#[cfg(has_embree)]
use super::embree;
use super::info::EmbreeInfo;
use super::intersector::Accel;
use super::options::BuildOptions;
use super::{brute_force, native};

/// A ray intersection backend.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Backend {
    /// Embree: particles as sphere points, giants as user geometry.
    Embree,
    /// Embree: every sphere as user geometry, with callbacks in C.
    EmbreeUser,
    /// Our own bounding volume hierarchy in Rust.
    Native,
    /// Tests every ray against every sphere in f64: the reference, and fast for tiny scenes.
    BruteForce,
}

named_enum! {
    Backend {
        Embree = "embree",
        EmbreeUser = "embree-user",
        Native = "native",
        BruteForce = "brute-force",
    }
}

impl Backend {
    /// Every backend in this build, the default first.
    pub const AVAILABLE: &[Self] = if cfg!(has_embree) {
        &[Self::Embree, Self::EmbreeUser, Self::Native, Self::BruteForce]
    } else {
        &[Self::Native, Self::BruteForce]
    };

    /// Every backend, including those that this build lacks.
    pub const ALL: &[Self] = &[Self::Embree, Self::EmbreeUser, Self::Native, Self::BruteForce];

    /// Returns true if the backend uses Embree.
    pub fn uses_embree(self) -> bool {
        matches!(self, Self::Embree | Self::EmbreeUser)
    }

    /// Builds this backend over the spheres.
    ///
    /// # Errors
    /// On a backend that this build lacks, an Embree error, or cancellation.
    pub fn build(self, spheres: &Arc<SphereSet>, options: &BuildOptions) -> Result<Box<dyn Accel>> {
        options.cancel.check()?;
        match self {
            Self::Native => Ok(Box::new(native::NativeAccel::new(Arc::clone(spheres), options)?)),
            #[cfg(has_embree)]
            Self::Embree => Ok(Box::new(embree::Embree::build(
                spheres,
                embree::ParticleGeometry::Points,
                options,
            )?)),
            #[cfg(has_embree)]
            Self::EmbreeUser => Ok(Box::new(embree::Embree::build(
                spheres,
                embree::ParticleGeometry::User,
                options,
            )?)),
            Self::BruteForce => Ok(Box::new(brute_force::BruteForce::new(spheres.clone()))),
            #[cfg(not(has_embree))]
            Self::Embree | Self::EmbreeUser => {
                Err(Error::backend(format!("this build has no `{}` intersector", self.name()))
                    .with_help(
                        "build with Embree's headers, libclang and the feature `embree`, or choose \
                         another intersector",
                    )
                    .with_suggestion(crate::error::Suggestion::Intersector, "native"))
            }
        }
    }
}

impl Default for Backend {
    fn default() -> Self {
        Self::AVAILABLE[0]
    }
}

impl FromStr for Backend {
    type Err = Error;

    fn from_str(name: &str) -> Result<Self> {
        Self::named(name).ok_or_else(|| Error::input(format!("there is no intersector `{name}`")))
    }
}

/// Version and features of the Embree in use; `None` in a build without Embree.
///
/// # Errors
/// When Embree cannot start.
pub fn embree_info() -> Option<Result<EmbreeInfo>> {
    #[cfg(has_embree)]
    return Some(embree::info());
    #[cfg(not(has_embree))]
    None
}
