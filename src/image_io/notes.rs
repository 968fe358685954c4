//! What a file can say of a picture.

use crate::color::ViewTransform;

use super::record::MetadataEntry;

/// What a file can say of a picture beside its pixels.
#[derive(Clone, Debug, Default)]
pub struct WriteOptions {
    /// Which part of a larger picture this is; an EXR file places it there.
    pub crop_window: Option<CropWindow>,
    /// How a PNG file shows it.
    pub view_transform: ViewTransform,
    /// How it was made, in PNG and EXR files.
    pub metadata: Vec<MetadataEntry>,
    /// Whether the file is wanted soon rather than small: it is then compressed less, and left to the
    /// system to be brought to the disk.
    pub fast: bool,
}

/// The place of a part in a larger picture.
#[derive(Clone, Copy, Debug)]
pub struct CropWindow {
    /// Pixels of the larger picture, across and down.
    pub full_size: [usize; 2],
    /// Column and row there of the part's upper left pixel.
    pub offset: [usize; 2],
}
