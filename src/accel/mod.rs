//! Who is hit? One trait, and its backends, built from the same
//! [`SphereSet`](crate::geometry::SphereSet).

mod backend;
mod brute_force;
mod choice;
#[cfg(feature = "embree")]
#[allow(unsafe_code, reason = "the fence around Embree")]
mod embree;
mod identity;
mod info;
mod intersector;
mod native;
mod options;
mod plan;

pub use backend::{Backend, embree_info};
pub use choice::{Choice, Chosen};
pub use identity::{EmbreeBuild, Intersector};
pub use info::EmbreeInfo;
pub use intersector::{Accel, Precision};
pub use native::Instance;
pub use options::{BuildOptions, Quality};
pub use plan::PlannedBytes;
