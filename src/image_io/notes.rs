//! What a file can say of a picture.

use crate::color::Look;

use super::record::Record;

/// What a file can say of a picture beside its pixels.
#[derive(Clone, Debug, Default)]
pub struct Notes {
    /// Which part of a larger picture this is; an EXR file places it there.
    pub cropped_from: Option<Crop>,
    /// How a PNG file shows it.
    pub look: Look,
    /// How it was made, in PNG and EXR files.
    pub records: Vec<Record>,
    /// Whether the file is wanted soon rather than small: it is then compressed less, and left to the
    /// system to be brought to the disk.
    pub quickly: bool,
}

/// The place of a part in a larger picture.
#[derive(Clone, Copy, Debug)]
pub struct Crop {
    /// Pixels of the larger picture, across and down.
    pub full_size: [usize; 2],
    /// Column and row there of the part's upper left pixel.
    pub corner: [usize; 2],
}
