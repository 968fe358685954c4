//! Finds the rows of NumPy files (`.npy`). A crate would bring a parser generator for the one line
//! of text in a header, and read number by number.

mod header;
mod layout;

pub(super) use header::read_header;
