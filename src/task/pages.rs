//! Memory of large arrays, on huge pages if the system provides them.
//!
//! The system gives memory page by page when it is first written. With pages of 4 KB, that is a
//! good part of the time in which a text is read into it; with pages of 2 MB, a small one.
//!
//! The `unsafe` here, and its argument: advice about memory changes neither what is in it nor who
//! owns it.

use std::collections::TryReserveError;

use rayon::prelude::*;

/// Takes memory for exactly `count` more elements.
///
/// # Errors
/// If there is not so much.
pub(crate) fn try_reserve<T>(to: &mut Vec<T>, count: usize) -> Result<(), TryReserveError> {
    to.try_reserve_exact(count)?;
    #[cfg(target_os = "linux")]
    linux::prefer_huge(to);
    Ok(())
}

/// Collects all items in order, computed in parallel.
pub(crate) fn collect<T: Send>(items: impl IndexedParallelIterator<Item = T>) -> Vec<T> {
    let mut all = Vec::new();
    // If there is not enough memory, what follows says so.
    let _ = try_reserve(&mut all, items.len());
    all.par_extend(items);
    all
}

#[cfg(target_os = "linux")]
mod linux {
    /// The huge page size of x86-64, and of most other processors.
    const HUGE_PAGE: usize = 2 << 20;

    /// Asks for huge pages where they fit into the memory of an array.
    pub(super) fn prefer_huge<T>(of: &mut Vec<T>) {
        let start = of.as_mut_ptr().cast::<u8>();
        let bytes = of.capacity() * size_of::<T>();
        let before = start.align_offset(HUGE_PAGE);
        let huge = bytes.saturating_sub(before) / HUGE_PAGE * HUGE_PAGE;
        if huge > 0 {
            // SAFETY: `huge` is not 0, so `before + huge` bytes belong to the array, which is
            // borrowed exclusively. This advice keeps what is in them, and may be ignored.
            let _ = unsafe { libc::madvise(start.add(before).cast(), huge, libc::MADV_HUGEPAGE) };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arrays_of_all_sizes_keep_what_is_in_them() {
        for count in [0, 1, 1000, 300_000, 3_000_000] {
            let mut all = vec![7u64, 8];
            try_reserve(&mut all, count).expect("memory");
            assert!(all.capacity() >= count + 2);
            all.extend(0..count as u64);
            assert_eq!(all[..2], [7, 8]);
            assert!(all[2..].iter().copied().eq(0..count as u64));
        }
        assert!(try_reserve(&mut vec![0u64], usize::MAX / 16).is_err());
        assert!(try_reserve(&mut vec![()], 1 << 30).is_ok());
    }
}
