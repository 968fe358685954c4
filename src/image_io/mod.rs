//! Reading and writing image files. No other module reads or writes pixels in files.
//!
//! Create an [`ImageWriter`] before rendering: it rejects an unwritable path before any time is
//! spent. The picture goes into a temporary file next to the target, which is renamed once all
//! bytes are on the disk. An earlier picture of that name is replaced completely or left unchanged.
//!
//! Non-finite values are written unchanged where the format can hold them (`.exr`, `.pfm`). The
//! other formats make them visible: NaN becomes magenta, infinity the largest value. They never
//! become black; [`Picture::non_finite`] counts them for the caller to report.

mod atomic_file;
mod display;
mod exr;
mod format;
mod hdr;
mod metadata;
mod notes;
mod overlay_image;
mod pfm;
mod picture;
mod png;
mod png_depth;
mod read;
mod record;
mod target;
mod temp_folder;
#[cfg(test)]
mod tests;

pub use atomic_file::{AtomicFile, Sink, remove_temp_files};
pub use display::display_pixels;
pub use format::{FileFormat, PICTURE_FORMATS, has_picture_extension};
pub use metadata::read_metadata;
pub use notes::{CropWindow, WriteOptions};
pub use overlay_image::OverlayImage;
pub use picture::{ChannelValues, ImageChannel, Picture};
pub use png::rgba_png;
pub use png_depth::PngDepth;
pub use read::{
    BEAUTY, Image, ImageLayer, LayeredImage, RawChannel, StoredPicture, read_image, read_light,
    read_png_depth, read_raw_channels, read_stored,
};
pub use record::MetadataEntry;
pub use target::{ImageWriter, write_to_stream};
pub(crate) use temp_folder::temp_folder;
