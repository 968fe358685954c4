//! Light transport against closed forms, for every estimator and every backend.
//!
//! Means are over 32 independent seeds and may be off by four standard errors (see
//! `common/kit.rs` for the significance of that) and 1e-5 relative.

#[path = "../common/kit.rs"]
mod common;
mod furnaces;
mod lone_ball;
mod mirrors_and_glass;
mod paper_and_path;
mod pixels;
mod reproducible;
mod scenes;
mod split;
