//! A picture file as it is stored, to be written again.

use crate::image_io::picture::ImageChannel;

/// Every channel of an EXR file with its own type.
#[derive(Clone, Debug)]
pub struct StoredPicture {
    /// Width and height in pixels.
    pub size: [usize; 2],
    /// Column and row of the upper left pixel in the full picture.
    pub offset: [i32; 2],
    /// Width and height of the full picture, in pixels.
    pub full_size: [usize; 2],
    /// Each channel with the name of its layer, as `read_image` gives it.
    pub channels: Vec<(String, ImageChannel)>,
    /// Texts beside the pixels: name and text.
    pub attributes: Vec<(String, String)>,
}
