//! Every intersector against the judge and against brute force, and the fence around Embree.

mod backends;
mod differential;
#[cfg(has_embree)]
mod embree;
mod leaving;
#[cfg(has_embree)]
mod memory;
mod native;
mod scenes;
