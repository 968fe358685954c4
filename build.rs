//! Placeholder until the Embree seam is written.
fn main() {}
