//! Tables of values as text: CSV, TSV, values between white space, and point clouds.

mod names;
mod read;
mod rows;
mod sniff;

pub(in crate::particles) use names::axis_of;
pub(in crate::particles) use read::{read, survey};
