//! The particles of a scene before it is built.

use crate::appearance::Dressed;
use crate::math::DVec3;

use super::data::{SphereArrays, StridedArray};
use super::particle_table::FileRows;

/// Particles that have been read from a file.
#[derive(Clone, Copy, Debug)]
pub struct LoadedParticles<'a> {
    arrays: &'a SphereArrays,
    /// How they look. Its arrays are empty: they are those of the scene.
    pub look: &'a Dressed,
}

impl<'a> LoadedParticles<'a> {
    pub(super) fn new(arrays: &'a SphereArrays, look: &'a Dressed) -> Self {
        Self { arrays, look }
    }

    /// Number of visible spheres.
    pub fn len(&self) -> usize {
        self.arrays.len()
    }

    /// Returns true if no sphere is visible.
    pub fn is_empty(&self) -> bool {
        self.arrays.is_empty()
    }

    /// Which row of the file each row of the table shows.
    pub(super) fn file_rows(&self) -> FileRows {
        let Dressed { rows, copies, edges, .. } = self.look;
        FileRows { rows: rows.clone(), copies: *copies, particles: self.len() - edges }
    }

    /// Centre and radius of each particle by index; the hidden ones come last.
    pub fn spheres(&self) -> impl Fn(usize) -> (DVec3, f64) + Sync + 'a {
        let center = self.arrays.center.each_ref().map(StridedArray::reader);
        let radius = self.arrays.radius.reader();
        let (len, hidden) = (self.len(), &self.look.hidden);
        move |index| match index.checked_sub(len) {
            None => {
                let center = center.each_ref().map(|column| column.get(index));
                (DVec3::from_array(center), radius.get(index))
            }
            Some(hidden_index) => hidden[hidden_index],
        }
    }
}
