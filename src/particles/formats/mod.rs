//! One file for each format.

mod extended_xyz;
pub(super) mod gro;
pub(super) mod lammps_dump;
pub(crate) mod npy;
pub(super) mod pdb;
pub(super) mod ply;
mod splats;
pub(super) mod table;
pub(super) mod xyz;
