//! Who is hit? One trait, and its backends, built from the same
//! [`SphereSet`](crate::geometry::SphereSet).

mod backend;
mod brute_force;
mod backend_choice;
#[cfg(feature = "embree")]
#[allow(unsafe_code, reason = "the fence around Embree")]
mod embree;
mod identity;
mod info;
mod intersector;
mod native;
mod options;
mod memory_estimate;

pub use backend::{Backend, embree_info};
pub use backend_choice::{BackendChoice, SelectedBackend};
pub use identity::{EmbreeBuild, Intersector};
pub use info::EmbreeInfo;
pub use intersector::{Accel, ErrorBound};
pub use native::KernelIsa;
pub use options::{BuildOptions, BuildQuality};
pub use memory_estimate::MemoryEstimate;
