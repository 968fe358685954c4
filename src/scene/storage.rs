//! Fallible memory allocation for scene data.

use crate::error::{Error, Result};
use crate::task::pages::try_reserve;

use super::colors::SphereColors;
use super::description::ColorStorage;

/// Reserves memory for colours in the given storage format.
pub(super) fn reserve_colors(storage: ColorStorage, rows: u64) -> Result<SphereColors> {
    Ok(match storage {
        ColorStorage::Exact => SphereColors::Exact(try_with_capacity(rows)?),
        ColorStorage::Packed => SphereColors::Packed(try_with_capacity(rows)?),
    })
}

/// Reserves memory for `count` elements.
pub(super) fn try_with_capacity<T>(count: u64) -> Result<Vec<T>> {
    let mut vec = Vec::new();
    try_reserve(&mut vec, count as usize).map_err(|_| {
        Error::input(format!("there is not enough memory for {count} spheres"))
            .with_help("leave some sphere tables out")
    })?;
    Ok(vec)
}
