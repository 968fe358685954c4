//! The formats that can be read.

use crate::names::named_enum;

/// A file format.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// A NumPy array (`.npy`).
    Npy,
    /// NumPy arrays in an archive (`.npz`).
    Npz,
    /// A table with values separated by commas, semicolons, tabs or bars.
    Csv,
    /// A table with values separated by white space; a point cloud in `.xyz` or `.pts`.
    Table,
    /// XYZ and extended XYZ.
    Xyz,
    /// A LAMMPS dump as text.
    LammpsDump,
    /// A LAMMPS data file.
    LammpsData,
    /// Protein Data Bank.
    Pdb,
    /// PDBx/mmCIF.
    Mmcif,
    /// GROMACS GRO.
    Gro,
    /// VASP POSCAR or CONTCAR.
    Poscar,
    /// PLY, with its vertices as particles.
    Ply,
    /// GSD, the format of HOOMD-blue.
    Gsd,
    /// VTK PolyData in XML.
    Vtp,
    /// VTK UnstructuredGrid in XML.
    Vtu,
    /// A ParaView collection of VTK files.
    Pvd,
    /// Legacy VTK.
    Vtk,
    /// A GROMACS trajectory; names and types are in another file, the topology.
    Xtc,
}

named_enum! {
    Format {
        Npy = "npy",
        Npz = "npz",
        Csv = "csv",
        Table = "table",
        Xyz = "xyz",
        LammpsDump = "lammps-dump",
        LammpsData = "lammps-data",
        Pdb = "pdb",
        Mmcif = "mmcif",
        Gro = "gro",
        Poscar = "poscar",
        Ply = "ply",
        Gsd = "gsd",
        Vtp = "vtp",
        Vtu = "vtu",
        Pvd = "pvd",
        Vtk = "vtk",
        Xtc = "xtc",
    }
}
