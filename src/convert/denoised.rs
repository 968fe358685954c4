//! Adds the denoised picture to a picture that was read.

use crate::denoise::{DENOISED, Denoiser};
use crate::error::Result;
use crate::image_io::{ChannelValues, ImageChannel};

use super::options::ConvertOptions;
use super::picture::layered;
use super::source::{Source, SourceLayer};

impl Source {
    /// Adds the layer with the denoised picture, and its mark in the record.
    ///
    /// # Errors
    /// If the library fails.
    pub(super) fn denoise(&mut self, denoiser: &Denoiser) -> Result<()> {
        let denoised = denoiser.denoise(&layered(self, &ConvertOptions::default()))?;
        let channel = |axis: usize| {
            let values = denoised.iter().map(|pixel| pixel[axis]).collect();
            let name = format!("{DENOISED}.{}", ["R", "G", "B"][axis]);
            ImageChannel::new(&name, ChannelValues::Float(values))
        };
        let channels = (0..3).map(channel).collect();
        self.layers.retain(|layer| layer.name != DENOISED);
        self.layers.push(SourceLayer { name: DENOISED.to_owned(), channels });
        if let Some(metadata) = &mut self.metadata {
            metadata.mark_denoised(&denoiser.name());
        }
        Ok(())
    }
}
