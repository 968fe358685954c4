//! One file for each format.

mod extended_xyz;
pub(super) mod gro;
pub(super) mod gsd;
pub(super) mod lammps_data;
pub(super) mod lammps_dump;
pub(super) mod mmcif;
pub(crate) mod npy;
pub(super) mod pdb;
pub(super) mod ply;
pub(super) mod poscar;
mod splats;
pub(super) mod table;
pub(super) mod vtk;
pub(super) mod xtc;
pub(super) mod xyz;
