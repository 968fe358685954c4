//! LAMMPS data files.

mod head;
mod read;
mod style;

pub(in crate::particles) use read::{read, survey};
