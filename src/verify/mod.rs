//! Verification as a product: the means by which a user, and the tests, check every answer and
//! measure every backend.

pub mod bench;
pub mod crosscheck;
mod exact;
pub mod judge;
pub mod rays;
