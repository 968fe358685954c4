//! Particle files of other programs are read as those programs read them back, and bad ones are
//! refused with a message that helps.

mod bad;
mod cells;
mod compressed;
mod gro;
mod gsd;
mod kit;
mod lammps;
mod mmcif;
mod numpy;
mod pdb;
mod ply;
mod poscar;
mod random;
mod table;
mod vtk;
mod xtc;
mod xyz;
