//! Pictures become files, whole or not at all, and come back from them. Nobody else reads or writes
//! pixels in files.
//!
//! A [`Target`] is made before any rendering: it refuses a place that cannot be written to while
//! that costs nobody an hour. The picture goes into a temporary file beside the target, which takes
//! the target's name only once every byte is on the disk, so an earlier picture of that name is
//! replaced whole or stays as it was.
//!
//! Values that are not finite are written as they are where the format can hold them (`.exr`,
//! `.pfm`). The others show them: not-a-number becomes magenta, infinity the brightest value. They
//! are never made black; [`Picture::non_finite`] counts them for the caller to report.

mod exr;
mod format;
mod hdr;
mod notes;
mod pfm;
mod picture;
mod png;
mod read;
mod record;
mod metadata;
mod target;
#[cfg(test)]
mod tests;
mod atomic_file;

pub use notes::{CropWindow, WriteOptions};
pub use picture::{Picture, ImageChannel, ChannelValues};
pub use png::rgba_png;
pub use read::{BEAUTY, Image, ImageLayer, LayeredImage, RawChannel, read_raw_channels, read_image, read_light};
pub use record::MetadataEntry;
pub use metadata::read_metadata;
pub use target::ImageWriter;
pub use atomic_file::{Sink, AtomicFile, remove_temp_files};
