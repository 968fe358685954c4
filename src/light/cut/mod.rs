//! Emitters that opaque spheres cut, such as a lamp that sticks out of a wall.
//!
//! Found when a scene is loaded: for each emitter, the opaque sphere that hides most of it from
//! points outside that sphere, and the one that hides most of it from points inside, such as the
//! wall of a room. Occlusion by others is left to the shadow ray.
//!
//! No light passes an opaque sphere, so a point is inside one only if the camera is. The spheres
//! around the camera ([`Enclosure`]) are few and are compared with all emitters. All other spheres
//! are seen from outside, where only one about as large as an emitter, or larger, can hide much of
//! it.

mod emitter_cuts;
mod enclosure;
mod search;

pub use emitter_cuts::{EmitterCut, EmitterCuts};
pub use enclosure::Enclosure;
