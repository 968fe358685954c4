//! Light transport against closed forms and against itself: every estimator, every backend, every
//! way to find light.
//!
//! Means are over 32 independent seeds and may be off by four standard errors (see `common/kit.rs`
//! for the significance of that) and 1e-5 relative.

mod agreement;
mod boundaries;
mod cameras;
mod connections;
mod cut_emitters;
mod furnaces;
mod integrators;
#[path = "../common/kit.rs"]
mod kit;
mod lanes;
mod lights;
mod lone_ball;
mod media;
mod mirrors_and_glass;
mod opacity;
mod paper;
mod paper_and_path;
mod pixels;
mod published_box;
mod recursion;
mod reproducible;
mod rough;
mod scenes;
mod shadow_catchers;
mod split;
mod trapped;
