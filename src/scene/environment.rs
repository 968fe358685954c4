//! The background: its image read from a file, and its light made from its description.

use std::path::Path;

use crate::color::Rgb;
use crate::image_io::{Image, read_light};
use crate::light::{self, Orientation};

use super::description::{Background, Dome, Sun};

/// The most pixels along an image.
const WIDEST: usize = 32_768;

/// The pixels of an image in latitude and longitude, rows from the top, checked to be radiance.
#[derive(Clone, Debug)]
pub(super) struct Pixels {
    width: usize,
    height: usize,
    pixels: Vec<Rgb>,
}

impl Pixels {
    fn dome(mut self, scale: f64) -> light::Dome {
        self.pixels.iter_mut().for_each(|pixel| *pixel *= scale as f32);
        light::Dome::image(self.width, self.height, &self.pixels)
    }

    /// How many there are.
    pub(super) fn len(&self) -> usize {
        self.pixels.len()
    }

    /// The hash of size and values.
    pub(super) fn hash(&self) -> blake3::Hash {
        let mut hasher = blake3::Hasher::new();
        for length in [self.width, self.height] {
            hasher.update(&(length as u64).to_le_bytes());
        }
        for row in self.pixels.chunks(self.width.max(1)) {
            let values = row.iter().flat_map(|pixel| pixel.to_array());
            let bytes: Vec<u8> = values.flat_map(f32::to_le_bytes).collect();
            hasher.update(&bytes);
        }
        hasher.finalize()
    }

    /// What keeps the pixels from being a background.
    fn check(self) -> Result<Self, String> {
        let Self { width, height, ref pixels } = self;
        if width != 2 * height || width > WIDEST {
            return Err(format!(
                "it has {width} x {height} pixels, but an image in latitude and longitude is twice \
                 as wide as high, and at most {WIDEST} wide"
            ));
        }
        let is_wrong = |pixel: &&Rgb| !pixel.is_finite() || pixel.min_element() < 0.0;
        let wrong = pixels.iter().filter(is_wrong).count();
        match pixels.iter().position(|pixel| is_wrong(&pixel)) {
            None => Ok(self),
            Some(first) => Err(format!(
                "{wrong} of its pixels are negative, infinite or not a number, first the one in \
                 column {}, row {}, which is {}",
                first % width,
                first / width,
                pixels[first]
            )),
        }
    }
}

/// Reads a `.exr` or `.hdr` file; or says what is wrong with it.
pub(super) fn read(path: &Path) -> Result<Pixels, String> {
    let Image { width, height, pixels } = read_light(path)?;
    Pixels { width, height, pixels }.check()
}

/// The light of a described background.
pub(super) fn light(of: &Background, pixels: Option<Pixels>) -> light::Background {
    let angle = match of.dome {
        Dome::Image { rotation_degrees, .. } => rotation_degrees.to_radians(),
        _ => 0.0,
    };
    let orientation = Orientation::new(of.up, angle);
    let dome = match (&of.dome, pixels) {
        (Dome::Constant { radiance }, _) => light::Dome::constant(*radiance),
        (Dome::Gradient { zenith, horizon, nadir }, _) => {
            light::Dome::gradient(*zenith, *horizon, *nadir)
        }
        (Dome::Image { scale, .. }, Some(image)) => image.dome(*scale),
        (Dome::Image { .. }, None) => light::Dome::constant(Rgb::ZERO),
        (Dome::Sky { turbidity, ground_albedo, scale }, _) => {
            let sun = of.sun.as_ref();
            light::Sky {
                turbidity: *turbidity,
                sun: orientation.to_local(sun.map_or(of.up, |sun| sun.direction)),
                sun_irradiance: sun.map_or(Rgb::ZERO, |sun| sun.irradiance),
                ground: *ground_albedo,
                scale: *scale,
            }
            .dome()
        }
    };
    let shines = |sun: &&Sun| sun.irradiance.max_element() > 0.0;
    let sun = of.sun.as_ref().filter(shines).map(|sun| {
        let diameter = sun.angular_diameter_degrees.to_radians();
        light::Sun::new(sun.direction, diameter, sun.irradiance)
    });
    light::Background::new(dome, orientation, sun)
}
