//! Ray intersection: one trait, and its backends, all built from the same
//! [`SphereSet`](crate::geometry::SphereSet).

mod backend;
mod backend_choice;
mod brute_force;
#[cfg(has_embree)]
#[allow(unsafe_code, reason = "the fence around Embree")]
mod embree;
mod info;
mod intersector;
mod memory_estimate;
mod native;
mod options;

pub use backend::{Backend, embree_info};
pub use backend_choice::{BackendChoice, SelectedBackend};
pub use info::EmbreeInfo;
pub use intersector::{Accel, ErrorBound};
pub use memory_estimate::MemoryEstimate;
pub use native::KernelIsa;
pub use options::{BuildOptions, BuildQuality};
