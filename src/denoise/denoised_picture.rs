//! A picture with its denoised one, as files of both kinds show them.

use crate::color::Rgb;
use crate::error::Result;
use crate::image_io::{ChannelValues, ImageChannel, Picture};

use super::picture::{DENOISED, Denoiser, layer};

/// A picture that is denoised.
#[derive(Clone, Debug)]
pub struct DenoisedPicture {
    layered: Picture,
    alone: Picture,
}

impl DenoisedPicture {
    /// Denoises a picture. A layer `denoised` that it has is made anew.
    ///
    /// # Errors
    /// If the library fails.
    pub fn new(denoiser: &Denoiser, picture: &Picture) -> Result<Self> {
        let denoised = denoiser.denoise(picture)?;
        let names = ["R", "G", "B"].map(|end| format!("{DENOISED}.{end}"));
        let mut layered = picture.clone();
        layered.channels.retain(|channel| !names.contains(&channel.name));
        let channel = |(axis, name): (usize, &String)| {
            let values = denoised.iter().map(|pixel| pixel[axis]).collect();
            ImageChannel::new(name, ChannelValues::Float(values))
        };
        layered.channels.extend(names.iter().enumerate().map(channel));
        let alone = alone(&layered, denoised);
        Ok(Self { layered, alone })
    }

    /// The picture with the layer `denoised` for files with layers, or the denoised picture alone.
    pub fn of(&self, has_layers: bool) -> &Picture {
        if has_layers { &self.layered } else { &self.alone }
    }

    /// The picture with the layer `denoised`.
    pub fn into_layered(self) -> Picture {
        self.layered
    }
}

/// The denoised picture alone, of a picture with the layer `denoised`; `None` of others.
pub fn denoised_alone(layered: &Picture) -> Option<Picture> {
    layer(layered, DENOISED).map(|denoised| alone(layered, denoised))
}

fn alone(layered: &Picture, denoised: Vec<Rgb>) -> Picture {
    Picture {
        width: layered.width,
        height: layered.height,
        indirect: vec![Rgb::ZERO; layered.len()],
        direct: denoised,
        alpha: layered.alpha.clone(),
        hidden_layers: layered.hidden_layers.clone(),
        channels: Vec::new(),
        attributes: layered.attributes.clone(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_layer_alone_is_what_was_denoised() {
        let channel = |end: &str, value: f32| {
            ImageChannel::new(&format!("{DENOISED}.{end}"), ChannelValues::Float(vec![value; 2]))
        };
        let plain = Picture {
            width: 2,
            height: 1,
            direct: vec![Rgb::ONE; 2],
            indirect: vec![Rgb::ONE; 2],
            alpha: Some(vec![1.0, 0.5]),
            hidden_layers: Vec::new(),
            channels: Vec::new(),
            attributes: Vec::new(),
        };
        assert_eq!(denoised_alone(&plain), None);
        let channels = vec![channel("R", 0.25), channel("G", 0.5), channel("B", 0.75)];
        let alone = denoised_alone(&Picture { channels, ..plain.clone() }).unwrap();
        assert_eq!(alone.beauty(1), Rgb::new(0.25, 0.5, 0.75));
        assert_eq!((alone.alpha, alone.channels.len()), (plain.alpha, 0));
    }
}
