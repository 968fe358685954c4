//! Protein Data Bank files, and PQR files.

pub(super) mod altloc;
mod atoms;
mod read;

pub(in crate::particles) use read::{count, read, survey};
