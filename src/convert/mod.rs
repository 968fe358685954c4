//! Shows a finished picture in another way: another format, tone or crop, one of its layers, or
//! numbers as colours.
//!
//! The pixels of a render are never improved here. What a file records of how it was made is kept
//! as far as it stays true of the new file: a picture that only went through another view transform
//! or was cropped can be rendered again, any other records what was done to it.

mod crop;
mod denoised;
mod false_color;
mod legend;
mod options;
mod picture;
mod record;
mod shown;
mod source;

pub use options::{ConvertOptions, FalseColors};
pub use picture::{Converted, convert};
