//! Options for writing a picture.

use std::sync::Arc;

use crate::color::ViewTransform;

use super::overlay_image::OverlayImage;
use super::png_depth::PngDepth;
use super::record::MetadataEntry;

/// Options for writing a picture: metadata, display and compression.
#[derive(Clone, Debug, Default)]
pub struct WriteOptions {
    /// Position within a larger picture; used by EXR files.
    pub crop_window: Option<CropWindow>,
    /// View transform for PNG files.
    pub view_transform: ViewTransform,
    /// Bits per channel of PNG files.
    pub png_depth: PngDepth,
    /// Resolution in pixels per inch, for PNG files; none by default.
    pub dpi: Option<u32>,
    /// How the picture was made; written to PNG and EXR files.
    pub metadata: Vec<MetadataEntry>,
    /// An image that is laid over the picture in PNG files, and is a layer of EXR files.
    pub overlay: Option<Arc<OverlayImage>>,
    /// True if speed matters more than size: compresses less and does not sync to the disk.
    pub fast: bool,
}

/// Position of a crop in a larger picture.
#[derive(Clone, Copy, Debug)]
pub struct CropWindow {
    /// Width and height of the larger picture, in pixels.
    pub full_size: [usize; 2],
    /// Column and row of the crop's upper left pixel in the larger picture.
    pub offset: [usize; 2],
}
