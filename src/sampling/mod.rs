//! Random numbers with addresses, and the warps that turn them into directions and positions.

mod trig;

pub use trig::sin_cos;
