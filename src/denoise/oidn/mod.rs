//! The functions of Open Image Denoise 2 that are used, and a safe interface to them.
//!
//! # Why this is sound
//!
//! [`functions`] declares the functions with the types of the library's C header, version 2, and
//! the library's file name carries that version. Every function pointer is kept beside the library
//! that it comes from, which is never unloaded while it is used. Device and filter are released
//! exactly once, the filter first. The images of a filter are borrowed slices, whose length is
//! checked against the size that the library is told, and which outlive the filter: it is made, run
//! and released within one function. The device is one of the processor, so that it reads memory of
//! this program. Nothing is called from two threads: a [`Device`] is neither `Send` nor `Sync`.

mod device;
mod functions;

pub(super) use device::{Device, Images};
pub(super) use functions::Functions;
