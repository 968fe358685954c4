//! Verification as a product: the means by which a user, and the tests, check every answer.

pub mod crosscheck;
mod exact;
pub mod judge;
pub mod rays;
