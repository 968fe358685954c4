//! Vectors, frames, rays, and rectangles of pixels.

#[allow(unsafe_code, reason = "calls vector instructions where they were found")]
pub(crate) mod bytes;
mod frame;
#[allow(unsafe_code, reason = "calls functions compiled for the instructions that were found")]
mod isa;
mod lanes;
mod ray;
mod rect;

pub(crate) use frame::normalize_robust;
pub use frame::{Frame, renormalize};
pub use glam::{DVec2, DVec3, Vec3};
pub use isa::{Isa, SimdKernel};
pub use lanes::{LANES, Lanes, Lanes3};
pub use ray::{Hit, MAX_COORDINATE, NO_SPHERE, Ray, rounded_interval};
pub use rect::Rect;

/// Half the distance from 1 to the next larger f32: the relative error of one f32 rounding.
pub const F32_UNIT_ROUNDOFF: f64 = 1.0 / (1u32 << 24) as f64;
