//! The available sphere arrangements.

use crate::names::named_enum;

/// How the spheres are arranged. All arrangements roughly fill a box of side 1 around the origin.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Arrangement {
    /// Uniformly random, possibly overlapping positions. For N spheres of mean radius r, N pi r^2 =
    /// 8 as long as r <= 0.2: a ray across the box hits about eight spheres for any N. Radii vary
    /// by 25 %.
    Gas,
    /// Non-overlapping spheres that fill half of the volume: a face-centered cubic lattice with
    /// random displacements, and radii that vary by 12.5 %.
    Packed,
    /// 400 Gaussian clusters of very different density, with log-uniform radii over two decades.
    Clusters,
    /// A cubic lattice.
    Lattice,
}

named_enum! { Arrangement { Gas = "gas", Packed = "packed", Clusters = "clusters", Lattice = "lattice" } }
