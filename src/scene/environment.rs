//! The background: its description, its image read from a file, and the light made of them.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use crate::color::Rgb;
use crate::image_io::{Image, read_light};
use crate::light::{self, Orientation};
use crate::math::DVec3;

/// Maximum image width in pixels.
const MAX_WIDTH: usize = 32_768;

/// `[background]`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BackgroundDescription {
    /// Light from all directions.
    pub dome: EnvironmentDescription,
    /// The unit direction of the zenith.
    pub up: DVec3,
    /// `[background.sun]`.
    pub sun: Option<SunDescription>,
    /// True if camera rays that hit nothing see the background, else they see black.
    pub camera_visible: bool,
    /// True if pictures have an alpha channel that is 0 where camera rays hit nothing.
    pub transparent: bool,
    /// The radiance that camera rays see which hit nothing, in place of the background.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub backdrop: Option<Rgb>,
}

impl Default for BackgroundDescription {
    /// Darkness, with y as its zenith.
    fn default() -> Self {
        let dome = EnvironmentDescription::default();
        Self {
            dome,
            up: DVec3::Y,
            sun: None,
            camera_visible: true,
            transparent: false,
            backdrop: None,
        }
    }
}

/// The light of the background.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "type", rename_all = "kebab-case", deny_unknown_fields)]
pub enum EnvironmentDescription {
    /// `radiance`: the same from everywhere.
    Constant {
        /// W/(sr m^2).
        radiance: Rgb,
    },
    /// `[background.gradient]`: linear in the sine of the elevation.
    Gradient {
        /// From above.
        zenith: Rgb,
        /// From the sides.
        horizon: Rgb,
        /// From below.
        nadir: Rgb,
    },
    /// `[background.image]`: a picture in latitude and longitude.
    Image {
        /// The file: `.exr` or `.hdr`.
        #[serde(with = "super::paths")]
        file: PathBuf,
        /// Turns it about `up`, counterclockwise when seen from above.
        rotation_degrees: f64,
        /// A factor on its radiance.
        scale: f64,
    },
    /// `[background.sky]`: a clear sky.
    Sky {
        /// The air's turbidity, from 2 to 10.
        turbidity: f64,
        /// The albedo of the ground below the horizon.
        ground_albedo: Rgb,
        /// A factor on its radiance.
        scale: f64,
    },
}

impl Default for EnvironmentDescription {
    /// No light.
    fn default() -> Self {
        Self::Constant { radiance: Rgb::ZERO }
    }
}

/// `[background.sun]`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SunDescription {
    /// Unit direction towards it.
    pub direction: DVec3,
    /// How wide it is seen.
    pub angular_diameter_degrees: f64,
    /// W/m^2 on a surface that faces it.
    pub irradiance: Rgb,
}

impl EnvironmentDescription {
    /// The table in `[background]` that its keys stand in; `None` for `[background]` itself.
    pub(super) fn table(&self) -> Option<&'static str> {
        match self {
            Self::Constant { .. } => None,
            Self::Gradient { .. } => Some("gradient"),
            Self::Image { .. } => Some("image"),
            Self::Sky { .. } => Some("sky"),
        }
    }
}

/// The pixels of an image in latitude and longitude, rows from the top, checked to be radiance.
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
