//! Pictures become files, whole or not at all, and come back from them. Nobody else reads or writes
//! pixels in files.
//!
//! A [`ImageWriter`] is made before any rendering: it refuses a place that cannot be written to while
//! that costs nobody an hour. The picture goes into a temporary file beside the target, which takes
//! the target's name only once every byte is on the disk, so an earlier picture of that name is
//! replaced whole or stays as it was.
//!
//! Values that are not finite are written as they are where the format can hold them (`.exr`,
//! `.pfm`). The others show them: not-a-number becomes magenta, infinity the brightest value. They
//! are never made black; [`Picture::non_finite`] counts them for the caller to report.

mod atomic_file;
mod exr;
mod format;
mod hdr;
mod metadata;
mod notes;
mod pfm;
mod picture;
mod png;
mod read;
mod record;
mod target;
#[cfg(test)]
mod tests;

pub use atomic_file::{AtomicFile, Sink, remove_temp_files};
pub use format::{PICTURE_FORMATS, has_picture_extension};
pub use metadata::read_metadata;
pub use notes::{CropWindow, WriteOptions};
pub use picture::{ChannelValues, ImageChannel, Picture};
pub use png::rgba_png;
pub use read::{
    BEAUTY, Image, ImageLayer, LayeredImage, RawChannel, read_image, read_light, read_raw_channels,
};
pub use record::MetadataEntry;
pub use target::ImageWriter;
