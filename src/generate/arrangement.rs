//! The arrangements that there are.

use crate::names::named_enum;

/// How the spheres are arranged. All fill a box of side 1 around the origin, more or less.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Arrangement {
    /// Uniformly random places, overlapping or not. With N spheres of mean radius r, N pi r^2 = 8
    /// as long as r <= 0.2: a ray across the box meets about eight, however many there are. Radii
    /// vary by a quarter.
    Gas,
    /// Spheres that fill half of the volume without touching: a face-centred lattice, shaken as far
    /// as there is room, radii varying by an eighth.
    Packed,
    /// 400 Gaussian clusters of very different density; radii spread evenly over two decades of
    /// their logarithm.
    Clusters,
    /// A cubic lattice.
    Lattice,
}

named_enum! { Arrangement { Gas = "gas", Packed = "packed", Clusters = "clusters", Lattice = "lattice" } }
