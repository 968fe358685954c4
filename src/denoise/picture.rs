//! Denoises a picture: its beauty, guided by what is seen in each pixel.

use std::path::Path;

use crate::color::Rgb;
use crate::error::{Error, Result};
use crate::image_io::{ChannelValues, ImageChannel, Picture};

use super::find;
use super::oidn::{Device, Functions, Images};

/// The layer with the denoised picture.
pub const DENOISED: &str = "denoised";

/// Open Image Denoise, loaded.
#[derive(Debug)]
pub struct Denoiser {
    functions: Functions,
    version: String,
}

impl Denoiser {
    /// Loads the library.
    ///
    /// # Errors
    /// If it is not installed, or does not work on this processor. The help says how to get it.
    pub fn load() -> Result<Self> {
        Self::load_with(None)
    }

    /// Loads the library, which may also be in this folder of the Python package `pyoidn`.
    ///
    /// # Errors
    /// As [`Self::load`].
    pub fn load_with(package: Option<&Path>) -> Result<Self> {
        let mut reasons = Vec::new();
        for file in find::candidates(package) {
            match Functions::load(&file) {
                Ok(functions) => {
                    let version = Device::new(&functions, 1).map(|device| device.version());
                    let version = version.map_err(|e| failed(&e))?;
                    return Ok(Self { functions, version });
                }
                Err(reason) => reasons.push(reason),
            }
        }
        Err(find::missing(&reasons))
    }

    /// The name of the library with its version, as a record names what was done.
    pub fn name(&self) -> String {
        format!("Intel Open Image Denoise {}", self.version)
    }

    /// Returns the denoised beauty of a picture. The layers `denoising_albedo` and
    /// `denoising_normal` guide the filter, or else `albedo` and `normal`; they are denoised first.
    /// Pixels that are not finite stay as they are.
    ///
    /// # Errors
    /// If the library fails, for example for want of memory.
    pub fn denoise(&self, picture: &Picture) -> Result<Vec<Rgb>> {
        let beauty: Vec<Rgb> = (0..picture.len()).map(|pixel| picture.beauty(pixel)).collect();
        let layer = |names: [&str; 2]| names.into_iter().find_map(|name| layer(picture, name));
        let albedo = layer(["denoising_albedo", "albedo"]);
        let normal = layer(["denoising_normal", "normal"]);
        let size = [picture.width, picture.height];
        let mut denoised = self.filter(size, &beauty, albedo, normal).map_err(|e| failed(&e))?;
        for (new, old) in denoised.iter_mut().zip(&beauty).filter(|(_, old)| !old.is_finite()) {
            *new = *old;
        }
        Ok(denoised)
    }

    fn filter(
        &self,
        size: [usize; 2],
        beauty: &[Rgb],
        albedo: Option<Vec<Rgb>>,
        normal: Option<Vec<Rgb>>,
    ) -> std::result::Result<Vec<Rgb>, String> {
        let device = Device::new(&self.functions, rayon::current_num_threads())?;
        // A mean over few samples has noise of its own, where the pixel sees several surfaces.
        let clean = |name, pixels: Option<Vec<Rgb>>| {
            let filter = |pixels: Vec<Rgb>| {
                let main = (name, &pixels[..]);
                device.filter(&Images { size, main, guides: [None; 2], is_hdr: false })
            };
            pixels.map(filter).transpose()
        };
        let albedo = clean(c"albedo", albedo)?;
        // The library takes a normal with an albedo only.
        let normal = clean(c"normal", normal.filter(|_| albedo.is_some()))?;
        let finite: Vec<Rgb> =
            beauty.iter().map(|c| if c.is_finite() { *c } else { Rgb::ZERO }).collect();
        let guides = [
            albedo.as_deref().map(|pixels| (c"albedo", pixels)),
            normal.as_deref().map(|pixels| (c"normal", pixels)),
        ];
        device.filter(&Images { size, main: (c"color", &finite), guides, is_hdr: true })
    }
}

fn failed(reason: &str) -> Error {
    Error::input(format!("Open Image Denoise cannot denoise: {reason}"))
        .with_help("use another version of it, or leave the picture as it is")
}

/// The three channels of a layer as colours.
pub(super) fn layer(picture: &Picture, name: &str) -> Option<Vec<Rgb>> {
    let channel = |ends: [&str; 2]| {
        let is_it = |channel: &&ImageChannel| {
            let end = channel.name.strip_prefix(name).and_then(|rest| rest.strip_prefix('.'));
            end.is_some_and(|end| ends.contains(&end))
        };
        match &picture.channels.iter().find(is_it)?.values {
            ChannelValues::Float(values) => Some(values),
            ChannelValues::Uint(_) => None,
        }
    };
    let [r, g, b] = [["R", "X"], ["G", "Y"], ["B", "Z"]].map(channel);
    let (r, g, b) = (r?, g?, b?);
    Some((0..picture.len()).map(|at| Rgb::new(r[at], g[at], b[at])).collect())
}
