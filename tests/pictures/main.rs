//! Pictures: the same bits in whatever order they are made, when they are good enough, their
//! layers, and how other programs read them.

mod film;
#[path = "../common/kit.rs"]
mod kit;
mod layers;
#[cfg(all(unix, feature = "cli"))]
mod openexr;
#[cfg(all(unix, feature = "cli"))]
#[path = "../common/python.rs"]
mod python;
mod stopping;
