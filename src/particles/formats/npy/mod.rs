//! NumPy files: arrays (`.npy`), and archives of them (`.npz`).

mod array;
mod header;
mod literal;
mod npz;
mod read;

pub(crate) use header::{Dtype, NpyField, NpyHeader, read_header};
pub(in crate::particles) use npz::{read_npz, survey_npz};
pub(in crate::particles) use read::{count_npy, read_npy, survey_npy};
