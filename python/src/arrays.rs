//! Arrays in and out: numbers of any type and layout come in by one pass, and what a picture holds
//! goes out without a copy. The only file of this crate with `unsafe` code.

use numpy::ndarray::{ArrayView, Dimension, IntoDimension};
use numpy::{Element, PyArray, PyArrayMethods};
use pyo3::exceptions::{PyMemoryError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// Reads an array with `N` columns, or with one dimension if `N` is 1. NumPy itself converts the
/// numbers while it copies them, whatever their type, byte order and strides.
///
/// # Errors
/// If the shape is another, or the numbers do not fit into memory.
pub(crate) fn rows<T, const N: usize>(array: &Bound<'_, PyAny>) -> PyResult<Vec<[T; N]>>
where
    T: Element + Copy + Default,
{
    let py = array.py();
    let shape: Vec<usize> = array.getattr("shape")?.extract()?;
    let count = match shape[..] {
        [count] if N == 1 => count,
        [count, columns] if columns == N => count,
        _ => return Err(PyValueError::new_err(format!("an array of the shape {shape:?}"))),
    };
    let mut rows: Vec<[T; N]> = Vec::new();
    rows.try_reserve_exact(count).map_err(|error| PyMemoryError::new_err(error.to_string()))?;
    rows.resize(count, [T::default(); N]);
    let view = ArrayView::from_shape(shape.into_dimension(), rows.as_flattened())
        .map_err(|error| PyValueError::new_err(error.to_string()))?;
    // SAFETY: `copyto` writes into the array and keeps no reference to it, so that it is gone
    // before `rows` is used again: nobody else has seen it.
    let target = unsafe { PyArray::borrow_from_array(&view, py.None().into_bound(py)) };
    let casting = PyDict::new(py);
    casting.set_item("casting", "unsafe")?;
    py.import("numpy")?.call_method("copyto", (&target, array), Some(&casting))?;
    drop(target);
    Ok(rows)
}

/// Reads an array with one dimension.
///
/// # Errors
/// As for [`rows`].
pub(crate) fn values<T: Element + Copy + Default>(array: &Bound<'_, PyAny>) -> PyResult<Vec<T>> {
    Ok(rows::<T, 1>(array)?.into_flattened())
}

/// A read-only array of numbers that live in a frozen object, without a copy.
///
/// # Errors
/// If the shape does not fit the numbers.
pub(crate) fn shared<'py, T: Element, D: IntoDimension>(
    owner: Bound<'py, PyAny>,
    numbers: &[T],
    shape: D,
) -> PyResult<Bound<'py, PyAny>>
where
    D::Dim: Dimension,
{
    let view = ArrayView::from_shape(shape.into_dimension(), numbers)
        .map_err(|error| PyValueError::new_err(error.to_string()))?;
    // SAFETY: the callers pass numbers that `owner` holds in a `Vec` which nobody can change,
    // because its class is frozen; the array keeps the owner alive.
    let array = unsafe { PyArray::borrow_from_array(&view, owner) };
    Ok(array.readwrite().make_nonwriteable().as_any().clone())
}
