//! Every intersector against the judge and against brute force, and the fence around Embree.

mod backends;
mod differential;
#[cfg(feature = "embree")]
mod embree;
mod leaving;
#[cfg(feature = "embree")]
mod memory;
mod native;
mod scenes;
