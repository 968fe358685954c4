//! Verification and measurement as part of the product.

pub mod bench;
