//! Emitters that opaque spheres cut, such as a lamp that sticks out of a wall.
//!
//! Found when a scene is loaded: for each emitter, the opaque sphere that hides most of it from
//! points outside that sphere, and the one that hides most of it from points inside, such as the
//! wall of a room. Occlusion by others is left to the shadow ray. Only spheres at least as large as
//! the emitter count: a smaller one never hides half of it from points outside. From inside it may
//! hide nearly all, so an emitter larger than the room that it sticks into is sampled badly.

mod emitter_cuts;
mod search;

pub use emitter_cuts::{EmitterCut, EmitterCuts};
