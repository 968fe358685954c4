//! Automatic backend selection.

use std::str::FromStr;

use crate::error::{Error, Result};
use crate::geometry::SphereSet;

use super::{Backend, KernelIsa};

/// The value of `--accel`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum BackendChoice {
    /// The fastest backend for the scene, according to our measurements.
    #[default]
    Auto,
    /// This backend.
    Only(Backend),
}

/// The backend to use, and why.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SelectedBackend {
    /// The backend.
    pub backend: Backend,
    /// The reason, in a few words.
    pub reason: String,
}

impl BackendChoice {
    /// Up to this many spheres, testing all of them in f64 is fastest. With more, the tree of the
    /// native backend pays off: from 75 spheres with AVX-512, from 45 with AVX2.
    pub const BRUTE_FORCE_MAX_SPHERES: usize = 48;

    /// The name used on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Auto => "auto",
            Self::Only(backend) => backend.name(),
        }
    }

    /// Selects the backend for a scene.
    ///
    /// According to the measurements in `benches/record/`, the native kernel is faster than Embree
    /// on x86-64 for every kind of scene and ray tested. On other processors, where only portable
    /// code is available, it is slower.
    pub fn select(self, spheres: &SphereSet) -> SelectedBackend {
        self.select_for_count(spheres.len())
    }

    /// Selects the backend for a sphere count.
    pub fn select_for_count(self, spheres: usize) -> SelectedBackend {
        match self {
            Self::Only(backend) => SelectedBackend { backend, reason: "as asked for".to_owned() },
            Self::Auto => select_for(spheres, KernelIsa::best()),
        }
    }
}

fn select_for(spheres: usize, isa: KernelIsa) -> SelectedBackend {
    let selected = |backend, reason: String| SelectedBackend { backend, reason };
    if spheres <= BackendChoice::BRUTE_FORCE_MAX_SPHERES {
        return selected(
            Backend::BruteForce,
            format!("fastest for up to {} spheres", BackendChoice::BRUTE_FORCE_MAX_SPHERES),
        );
    }
    match isa {
        KernelIsa::Portable if Backend::AVAILABLE.contains(&Backend::Embree) => {
            selected(Backend::Embree, "faster than portable code on this processor".to_owned())
        }
        KernelIsa::Portable => selected(Backend::Native, "this build has no Embree".to_owned()),
        KernelIsa::Avx2 | KernelIsa::Avx512 => {
            selected(Backend::Native, format!("fastest on processors with {}", isa.name()))
        }
    }
}

impl serde::Serialize for BackendChoice {
    fn serialize<S: serde::Serializer>(&self, to: S) -> std::result::Result<S::Ok, S::Error> {
        to.serialize_str(self.name())
    }
}

impl<'de> serde::Deserialize<'de> for BackendChoice {
    fn deserialize<D: serde::Deserializer<'de>>(from: D) -> std::result::Result<Self, D::Error> {
        let name = <std::borrow::Cow<'de, str>>::deserialize(from)?;
        name.parse().map_err(serde::de::Error::custom)
    }
}

impl FromStr for BackendChoice {
    type Err = Error;

    fn from_str(name: &str) -> Result<Self> {
        if name == Self::Auto.name() { Ok(Self::Auto) } else { name.parse().map(Self::Only) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_choice_follows_the_number_of_spheres_and_the_processor() {
        let backend = |spheres, isa| select_for(spheres, isa).backend;
        for isa in KernelIsa::ALL {
            assert_eq!(backend(0, *isa), Backend::BruteForce);
            assert_eq!(backend(BackendChoice::BRUTE_FORCE_MAX_SPHERES, *isa), Backend::BruteForce);
        }
        assert_eq!(
            backend(BackendChoice::BRUTE_FORCE_MAX_SPHERES + 1, KernelIsa::Avx2),
            Backend::Native
        );
        assert_eq!(backend(1_000_000, KernelIsa::Avx512), Backend::Native);
        let without_vectors = if cfg!(has_embree) { Backend::Embree } else { Backend::Native };
        assert_eq!(backend(1_000_000, KernelIsa::Portable), without_vectors);
    }

    #[test]
    fn every_choice_can_be_named() {
        let choices = Backend::ALL.iter().map(|&backend| BackendChoice::Only(backend));
        for choice in choices.chain([BackendChoice::Auto]) {
            assert_eq!(choice.name().parse::<BackendChoice>().expect("a name"), choice);
        }
        assert!("fast".parse::<BackendChoice>().is_err());
    }
}
