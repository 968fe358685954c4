//! photosphere: a physically based Monte Carlo path tracer for scenes made of spheres.
//!
//! Data flows in one direction: a scene enters as values or as a file, pictures leave at the other
//! end.
//!
//! ```text
//! SceneDescription -> Scene -> accel -> integrator -> film -> job -> image_io
//! ```
//!
//! [`scene::SceneBuilder`] makes a scene, [`job::run`] renders it; README.md has an example.
//!
//! ARCHITECTURE.md says what each module holds and which module may use which.
//! `docs/conventions.md` defines every symbol and unit once.

pub mod accel;
pub mod appearance;
pub mod camera;
#[cfg(feature = "cli")]
pub mod cli;
pub mod color;
pub mod convert;
pub mod denoise;
pub mod draw;
pub mod error;
#[cfg(feature = "faults")]
pub mod fault;
#[cfg(not(feature = "faults"))]
mod fault;
pub mod film;
pub mod generate;
pub mod geometry;
pub mod image_io;
pub mod integrator;
pub mod job;
pub mod light;
pub mod material;
pub mod math;
pub mod names;
pub mod overlay;
pub mod particles;
pub mod report;
pub mod sampling;
pub mod scene;
pub mod studio;
pub mod task;
pub mod verify;

pub use error::{Error, Result};

/// What README.md shows of the library compiles and runs.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
