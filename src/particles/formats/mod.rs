//! One file for each format.

mod extended_xyz;
pub(super) mod lammps_dump;
pub(super) mod table;
pub(super) mod xyz;
