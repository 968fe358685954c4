//! Reads environment maps and builds the background from its description.

use std::path::Path;

use crate::color::Rgb;
use crate::image_io::{Image, read_light};
use crate::light::{self, Orientation};

use super::description::{BackgroundDescription, EnvironmentDescription, SunDescription};

/// Maximum image width in pixels.
const MAX_WIDTH: usize = 32_768;

/// Validated radiance of an image in latitude and longitude, rows from the top.
#[derive(Clone, Debug)]
pub(super) struct EnvironmentPixels {
    width: usize,
    height: usize,
    pixels: Vec<Rgb>,
}

impl EnvironmentPixels {
    fn into_environment(mut self, scale: f64) -> light::EnvironmentMap {
        self.pixels.iter_mut().for_each(|pixel| *pixel *= scale as f32);
        light::EnvironmentMap::from_image(self.width, self.height, &self.pixels)
    }

    /// Number of pixels.
    pub(super) fn len(&self) -> usize {
        self.pixels.len()
    }

    /// Hash of size and values.
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

    /// Checks that the pixels can be an environment map.
    fn check(self) -> Result<Self, String> {
        let Self { width, height, ref pixels } = self;
        if width != 2 * height || width > MAX_WIDTH {
            return Err(format!(
                "it has {width} x {height} pixels, but an image in latitude and longitude is twice \
                 as wide as high, and at most {MAX_WIDTH} wide"
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

/// Reads a `.exr` or `.hdr` file. The error describes what is wrong.
pub(super) fn read(path: &Path) -> Result<EnvironmentPixels, String> {
    let Image { width, height, pixels } = read_light(path)?;
    EnvironmentPixels { width, height, pixels }.check()
}

/// Builds the background from its description.
pub(super) fn build_background(
    of: &BackgroundDescription,
    pixels: Option<EnvironmentPixels>,
) -> light::Environment {
    let angle = match of.dome {
        EnvironmentDescription::Image { rotation_degrees, .. } => rotation_degrees.to_radians(),
        _ => 0.0,
    };
    let orientation = Orientation::new(of.up, angle);
    let dome = match (&of.dome, pixels) {
        (EnvironmentDescription::Constant { radiance }, _) => {
            light::EnvironmentMap::constant(*radiance)
        }
        (EnvironmentDescription::Gradient { zenith, horizon, nadir }, _) => {
            light::EnvironmentMap::gradient(*zenith, *horizon, *nadir)
        }
        (EnvironmentDescription::Image { scale, .. }, Some(image)) => {
            image.into_environment(*scale)
        }
        (EnvironmentDescription::Image { .. }, None) => light::EnvironmentMap::constant(Rgb::ZERO),
        (EnvironmentDescription::Sky { turbidity, ground_albedo, scale }, _) => {
            let sun = of.sun.as_ref();
            light::Sky {
                turbidity: *turbidity,
                sun: orientation.to_local(sun.map_or(of.up, |sun| sun.direction)),
                sun_irradiance: sun.map_or(Rgb::ZERO, |sun| sun.irradiance),
                ground: *ground_albedo,
                scale: *scale,
            }
            .environment_map()
        }
    };
    let is_emitting = |sun: &&SunDescription| sun.irradiance.max_element() > 0.0;
    let sun = of.sun.as_ref().filter(is_emitting).map(|sun| {
        let diameter = sun.angular_diameter_degrees.to_radians();
        light::SunLight::new(sun.direction, diameter, sun.irradiance)
    });
    light::Environment::new(dome, orientation, sun)
}
