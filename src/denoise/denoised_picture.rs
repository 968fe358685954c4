//! A picture with its denoised one, as files of both kinds show them.

use crate::color::Rgb;
use crate::error::Result;
use crate::image_io::{ChannelValues, ImageChannel, Picture};

use super::picture::{DENOISED, Denoiser};

/// A picture that is denoised.
#[derive(Clone, Debug)]
pub struct DenoisedPicture {
    layered: Picture,
    alone: Picture,
}

impl DenoisedPicture {
    /// Denoises a picture.
    ///
    /// # Errors
    /// If the library fails.
    pub fn new(denoiser: &Denoiser, picture: &Picture) -> Result<Self> {
        let denoised = denoiser.denoise(picture)?;
        let mut layered = picture.clone();
        let channel = |(axis, end): (usize, &str)| {
            let values = denoised.iter().map(|pixel| pixel[axis]).collect();
            ImageChannel::new(&format!("{DENOISED}.{end}"), ChannelValues::Float(values))
        };
        layered.channels.extend(["R", "G", "B"].into_iter().enumerate().map(channel));
        let alone = Picture {
            indirect: vec![Rgb::ZERO; picture.len()],
            direct: denoised,
            channels: Vec::new(),
            ..picture.clone()
        };
        Ok(Self { layered, alone })
    }

    /// The picture with the layer `denoised` for files with layers, or the denoised picture alone.
    pub fn of(&self, has_layers: bool) -> &Picture {
        if has_layers { &self.layered } else { &self.alone }
    }
}
