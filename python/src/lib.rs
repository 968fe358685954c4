//! The extension module `photosphere._core`: what the Python package cannot do in Python.
//!
//! The library does the work. This crate takes arrays in and hands arrays out, keeps renders on
//! threads of their own, and lets Python's signals interrupt a wait. Everything that users see
//! (names, defaults, docstrings) is in Python, in `python/photosphere/`.

#[allow(unsafe_code, reason = "NumPy arrays that share memory with Rust")]
mod arrays;
mod columns;
mod error;
mod facts;
mod picture;
mod pool;
mod render;
mod scene;
mod thread;

use std::ffi::OsString;

use photosphere::cli::Packaging;
use pyo3::prelude::*;

/// Runs the command line, whose first word is the name of the program, and ends the process with
/// its exit code.
#[pyfunction]
fn main(py: Python<'_>, words: Vec<OsString>) {
    py.detach(|| photosphere::cli::main_with(words, Packaging::PythonPackage));
}

/// The extension module.
#[pymodule]
fn _core(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_class::<columns::Columns>()?;
    module.add_class::<picture::Picture>()?;
    module.add_class::<render::Render>()?;
    module.add_class::<scene::Scene>()?;
    module.add_class::<scene::Spheres>()?;
    module.add_function(wrap_pyfunction!(main, module)?)?;
    module.add_function(wrap_pyfunction!(columns::survey, module)?)?;
    module.add_function(wrap_pyfunction!(facts::color, module)?)?;
    module.add_function(wrap_pyfunction!(facts::colormap, module)?)?;
    module.add_function(wrap_pyfunction!(facts::element, module)?)?;
    module.add_function(wrap_pyfunction!(facts::keywords, module)?)?;
    module.add_function(wrap_pyfunction!(facts::schema, module)?)?;
    module.add_function(wrap_pyfunction!(facts::ticks, module)?)?;
    module.add_function(wrap_pyfunction!(picture::check_denoiser, module)?)?;
    module.add_function(wrap_pyfunction!(picture::merge, module)?)?;
    module.add("VERSION", photosphere::job::VERSION)?;
    module.add("COMMIT", photosphere::job::COMMIT)
}
