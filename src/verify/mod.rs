//! Verification and measurement as a product: the means by which a user, and the tests, check every
//! answer and compare every speed.

pub mod bench;
pub mod crosscheck;
mod exact;
pub mod judge;
pub mod rays;
