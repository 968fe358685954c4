//! Memory for the tree: large arrays on huge pages, if the system provides them.
//!
//! A traversal reads the tree at scattered addresses. With pages of 4 KB, nearly every step would
//! also miss the TLB; with pages of 2 MB, tracing is 10 to 30 % faster.

use std::marker::PhantomData;

use memmap2::{MmapMut, MmapOptions};

use crate::error::{Error, Result, Suggestion};

/// Element types of [`HugePageVec`].
///
/// # Safety
/// Every bit pattern must be a valid value, there must be no padding, and the alignment must be at
/// most 64.
pub(in crate::accel::native) unsafe trait Pod:
    Copy + Send + Sync
{
}

// SAFETY: 64 numbers, aligned to 64.
unsafe impl Pod for crate::accel::native::node::BvhNode {}
// SAFETY: 32 numbers, aligned to 64.
unsafe impl Pod for crate::accel::native::node::SphereLeaf {}
// SAFETY: 8 numbers.
unsafe impl Pod for [u32; 8] {}

/// A growable array, initialised with zeros.
pub(in crate::accel::native) struct HugePageVec<T> {
    map: Option<MmapMut>,
    /// Bytes of the map before the first element.
    offset: usize,
    len: usize,
    of: PhantomData<T>,
}

/// The huge page size of x86-64, and of most other processors.
const HUGE_PAGE: usize = 2 << 20;

impl<T: Pod> HugePageVec<T> {
    /// Creates an array with capacity for `capacity` elements. Pages are allocated when first
    /// written.
    ///
    /// # Errors
    /// If the system refuses the memory.
    pub(in crate::accel::native) fn with_capacity(capacity: usize) -> Result<Self> {
        let mut pages = Self { map: None, offset: 0, len: 0, of: PhantomData };
        if capacity > 0 {
            let bytes = capacity.checked_mul(size_of::<T>()).ok_or_else(out_of_memory)?;
            let slack = if bytes >= HUGE_PAGE { HUGE_PAGE } else { 0 };
            let total = bytes.checked_add(slack).ok_or_else(out_of_memory)?;
            let map = MmapOptions::new().len(total).no_reserve_swap().map_anon();
            let map = map.map_err(|_| out_of_memory())?;
            if slack > 0 {
                pages.offset = map.as_ptr().align_offset(HUGE_PAGE) % HUGE_PAGE;
                // A hint: everything works without it, only slower.
                #[cfg(target_os = "linux")]
                let _ = map.advise(memmap2::Advice::HugePage);
            }
            pages.map = Some(map);
        }
        Ok(pages)
    }

    /// The number of elements.
    pub(in crate::accel::native) fn len(&self) -> usize {
        self.len
    }

    fn capacity(&self) -> usize {
        let bytes = self.map.as_ref().map_or(0, |map| map.len() - self.offset);
        bytes / size_of::<T>()
    }

    /// Appends `count` elements, and returns them to be filled.
    ///
    /// # Errors
    /// If the system refuses more memory.
    pub(in crate::accel::native) fn grow(&mut self, count: usize) -> Result<&mut [T]> {
        let (old, new) = (self.len, self.len.checked_add(count).ok_or_else(out_of_memory)?);
        if new > self.capacity() {
            let mut larger = Self::with_capacity(new.max(2 * self.capacity()))?;
            larger.len = old;
            larger.as_mut_slice().copy_from_slice(self.as_slice());
            *self = larger;
        }
        self.len = new;
        Ok(&mut self.as_mut_slice()[old..])
    }

    #[inline(always)]
    pub(in crate::accel::native) fn as_slice(&self) -> &[T] {
        match &self.map {
            // SAFETY: the map has `offset` bytes and then room for `capacity >= len` elements,
            // aligned to a page, and all its bits are initialised, at first to 0; `T` is plain
            // data.
            Some(map) => unsafe {
                std::slice::from_raw_parts(map.as_ptr().add(self.offset).cast(), self.len)
            },
            None => &[],
        }
    }

    fn as_mut_slice(&mut self) -> &mut [T] {
        match &mut self.map {
            // SAFETY: as above, and the map is borrowed exclusively.
            Some(map) => unsafe {
                std::slice::from_raw_parts_mut(map.as_mut_ptr().add(self.offset).cast(), self.len)
            },
            None => &mut [],
        }
    }
}

fn out_of_memory() -> Error {
    Error::backend("there is not enough memory for the tree over the spheres")
        .with_help("take fewer spheres, or choose another intersector")
        .with_suggestion(Suggestion::Intersector, "embree")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_written_stays_while_it_grows() {
        let mut pages = HugePageVec::<[u32; 8]>::with_capacity(0).expect("nothing");
        assert!(pages.as_slice().is_empty());
        let mut expected = Vec::new();
        for round in 1..60u32 {
            let new = pages.grow(round as usize * 300).expect("memory");
            assert!(new.iter().all(|element| *element == [0; 8]));
            new.fill([round; 8]);
            expected.extend(std::iter::repeat_n([round; 8], round as usize * 300));
            assert!(pages.as_slice() == expected);
        }
        assert_eq!(pages.as_slice().as_ptr() as usize % HUGE_PAGE, 0);
    }
}
