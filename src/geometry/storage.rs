//! Stores spheres as the user wrote them, in as few bytes as possible.
//!
//! Tables in f32 stay `[x, y, z, radius]` in f32, 16 bytes per sphere. The few spheres among them
//! that f32 cannot represent are stored in f64 beside the table, and their rows hold an index and a
//! negative radius. Scenes without an f32 table are stored in f64, 32 bytes per sphere.

use rayon::prelude::*;

use crate::math::DVec3;

use super::Sphere;

/// The spheres as the user gave them. Rows are numbered consecutively: `exact` first, then `table`.
#[derive(Clone, Debug, Default)]
pub struct SphereRows {
    /// Spheres written out in the scene or given in f64.
    pub exact: Vec<Sphere>,
    /// Spheres from f32 tables, `[x, y, z, radius]`; becomes the set's own storage.
    pub table: Vec<[f32; 4]>,
}

/// Spheres by index, in the user's coordinates.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum SphereStorage {
    F32 {
        /// Spheres in f32, or an index into `wide` as the bits of x, marked by [`WIDE`].
        rows: Vec<[f32; 4]>,
        wide: Vec<Sphere>,
    },
    F64(Vec<Sphere>),
}

/// The radius of a row whose sphere is stored in f64.
const WIDE: f32 = -1.0;

impl SphereStorage {
    /// Stores the spheres of a table, followed by the exact ones.
    pub(super) fn new(SphereRows { mut exact, mut table }: SphereRows) -> Self {
        exact.iter_mut().for_each(|sphere| *sphere = without_negative_zeros(*sphere));
        if table.is_empty() {
            return Self::F64(exact);
        }
        let mut wide = Vec::new();
        table.par_iter_mut().for_each(|row| *row = row.map(|x| x + 0.0));
        table.reserve_exact(exact.len());
        for sphere in exact {
            let row = to_f32(&sphere);
            if to_f64(&row) == sphere {
                table.push(row);
            } else {
                table.push([f32::from_bits(wide.len() as u32), 0.0, 0.0, WIDE]);
                wide.push(sphere);
            }
        }
        Self::F32 { rows: table, wide }
    }

    /// Number of spheres.
    pub(super) fn len(&self) -> usize {
        match self {
            Self::F32 { rows, .. } => rows.len(),
            Self::F64(spheres) => spheres.len(),
        }
    }

    /// Returns the sphere with this index.
    #[inline(always)]
    pub(super) fn sphere(&self, index: usize) -> Sphere {
        match self {
            Self::F32 { rows, wide } => {
                let row = &rows[index];
                if row[3] < 0.0 { wide[row[0].to_bits() as usize] } else { to_f64(row) }
            }
            Self::F64(spheres) => spheres[index],
        }
    }

    /// Returns the address of a sphere, for prefetching only; meaningless if the index is too
    /// large.
    #[inline(always)]
    pub(super) fn address(&self, index: usize) -> *const u8 {
        match self {
            Self::F32 { rows, .. } => rows.as_ptr().wrapping_add(index).cast(),
            Self::F64(spheres) => spheres.as_ptr().wrapping_add(index).cast(),
        }
    }

    /// Returns the spheres with these indices, in this order.
    pub(super) fn select(self, indices: impl IndexedParallelIterator<Item = usize>) -> Self {
        match self {
            Self::F32 { rows, wide } => {
                Self::F32 { rows: indices.map(|index| rows[index]).collect(), wide }
            }
            Self::F64(spheres) => Self::F64(indices.map(|index| spheres[index]).collect()),
        }
    }

    /// Copies a sphere to a smaller index.
    pub(super) fn overwrite(&mut self, to: usize, from: usize) {
        match self {
            Self::F32 { rows, .. } => rows[to] = rows[from],
            Self::F64(spheres) => spheres[to] = spheres[from],
        }
    }

    /// Keeps the first `len` spheres.
    pub(super) fn truncate(&mut self, len: usize) {
        match self {
            Self::F32 { rows, .. } => rows.truncate(len),
            Self::F64(spheres) => spheres.truncate(len),
        }
    }

    /// Bytes held.
    pub(super) fn bytes(&self) -> usize {
        match self {
            Self::F32 { rows, wide } => size_of_val(&**rows) + size_of_val(&**wide),
            Self::F64(spheres) => size_of_val(&**spheres),
        }
    }
}

/// Adding 0 turns -0 into 0, so that equal spheres have equal bits.
fn without_negative_zeros(Sphere { center, radius }: Sphere) -> Sphere {
    Sphere { center: center + DVec3::ZERO, radius }
}

/// Rounds a sphere to f32.
pub(super) fn to_f32(sphere: &Sphere) -> [f32; 4] {
    let [x, y, z] = sphere.center.as_vec3().to_array();
    [x + 0.0, y + 0.0, z + 0.0, sphere.radius as f32]
}

/// Converts a row in f32 to f64.
#[inline(always)]
pub(super) fn to_f64(&[x, y, z, radius]: &[f32; 4]) -> Sphere {
    let center = DVec3::new(f64::from(x), f64::from(y), f64::from(z));
    Sphere { center, radius: f64::from(radius) }
}

/// The numbers of a sphere as bits: equal spheres have equal keys.
pub(super) fn bits(Sphere { center, radius }: Sphere) -> [u64; 4] {
    [center.x, center.y, center.z, radius].map(f64::to_bits)
}
