//! Light that suits most scenes, by name: a dome and a key light far away, which therefore need no
//! size. The key light stands beside the camera, so that it lights what the picture shows.

use crate::color::Rgb;
use crate::math::DVec3;
use crate::names::named_enum;

use super::environment::{BackgroundDescription, EnvironmentDescription, SunDescription};

/// Light by name (`light.preset`).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LightPreset {
    /// A large soft lamp above and to the left, in a bright room.
    Softbox,
    /// A small lamp high on the right, in a dark room.
    Rembrandt,
    /// The sky on an overcast day.
    Cloudy,
    /// The sun, and some blue sky.
    Sun,
}

named_enum! {
    LightPreset {
        Softbox = "softbox",
        Rembrandt = "rembrandt",
        Cloudy = "cloudy",
        Sun = "sun",
    }
}

/// What a preset is made of. A white surface that faces up has a radiance near 0.8 under it.
struct Parts {
    zenith: [f32; 3],
    horizon: [f32; 3],
    key: Option<Key>,
}

/// The key light.
struct Key {
    /// To the right of the camera, seen from the scene, in degrees.
    azimuth: f64,
    elevation: f64,
    diameter: f64,
    irradiance: [f32; 3],
}

impl LightPreset {
    fn parts(self) -> Parts {
        match self {
            Self::Softbox => Parts {
                zenith: [0.45; 3],
                horizon: [0.3; 3],
                key: Some(Key {
                    azimuth: -35.0,
                    elevation: 50.0,
                    diameter: 40.0,
                    irradiance: [2.0; 3],
                }),
            },
            Self::Rembrandt => Parts {
                zenith: [0.05; 3],
                horizon: [0.03; 3],
                key: Some(Key {
                    azimuth: 50.0,
                    elevation: 45.0,
                    diameter: 10.0,
                    irradiance: [3.4, 3.2, 2.9],
                }),
            },
            // The overcast sky of the CIE: three times as bright above as at the horizon.
            Self::Cloudy => Parts { zenith: [1.05; 3], horizon: [0.35; 3], key: None },
            Self::Sun => Parts {
                zenith: [0.16, 0.27, 0.5],
                horizon: [0.4, 0.48, 0.56],
                key: Some(Key {
                    azimuth: -45.0,
                    elevation: 42.0,
                    diameter: 0.533,
                    irradiance: [2.7, 2.5, 2.2],
                }),
            },
        }
    }

    /// Sets dome and sun of a background, whose zenith is kept, all as many times as bright as
    /// `strength` says. `to_camera` leads from what is shown to the camera.
    pub fn light(self, background: &mut BackgroundDescription, to_camera: DVec3, strength: f64) {
        let scaled = |color: [f32; 3]| Rgb::from_array(color) * strength as f32;
        let Parts { zenith, horizon, key } = self.parts();
        let (zenith, horizon) = (scaled(zenith), scaled(horizon));
        background.dome = EnvironmentDescription::Gradient { zenith, horizon, nadir: horizon };
        background.sun = key.map(|key| SunDescription {
            direction: key.direction(background.up, to_camera),
            angular_diameter_degrees: key.diameter,
            irradiance: scaled(key.irradiance),
        });
    }
}

impl Key {
    /// The unit direction towards it.
    fn direction(&self, up: DVec3, to_camera: DVec3) -> DVec3 {
        let level = to_camera - up * to_camera.dot(up);
        // From straight above or below, any side is as good.
        let front = level.try_normalize().unwrap_or_else(|| up.any_orthonormal_vector());
        let right = up.cross(front);
        let (sin, cos) = libm::sincos(self.azimuth.to_radians());
        let (sin_elevation, cos_elevation) = libm::sincos(self.elevation.to_radians());
        ((front * cos + right * sin) * cos_elevation + up * sin_elevation).normalize()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn key_lights_stand_beside_the_camera_and_above_the_horizon() {
        let up = DVec3::Z;
        for to_camera in [DVec3::new(0.0, -3.0, 1.0), DVec3::Z, DVec3::new(5.0, 1.0, -20.0)] {
            for (name, preset) in LightPreset::NAMES {
                let mut background = BackgroundDescription { up, ..Default::default() };
                preset.light(&mut background, to_camera, 2.0);
                let Some(sun) = background.sun else {
                    assert_eq!(*name, "cloudy");
                    continue;
                };
                assert!((sun.direction.length() - 1.0).abs() < 1e-12);
                assert!((0.6..0.8).contains(&sun.direction.dot(up)), "{name}");
                let level = (to_camera - up * to_camera.dot(up)).normalize_or_zero();
                assert!(level == DVec3::ZERO || sun.direction.dot(level) > 0.4, "{name}");
            }
        }
    }

    #[test]
    fn a_white_floor_is_bright_and_not_burnt() {
        for (name, preset) in LightPreset::NAMES {
            let mut background = BackgroundDescription::default();
            preset.light(&mut background, DVec3::Z, 1.0);
            let EnvironmentDescription::Gradient { zenith, horizon, .. } = background.dome else {
                panic!("{name} has another dome");
            };
            // The integral of (h + (z - h) sin) sin over the upper half is pi h + 2/3 pi (z - h).
            let dome = horizon + (zenith - horizon) * (2.0 / 3.0);
            let sun = background.sun.map_or(Rgb::ZERO, |sun| {
                sun.irradiance * (sun.direction.y / std::f64::consts::PI) as f32
            });
            let radiance = (dome + sun) * 0.8;
            assert!((0.5..0.85).contains(&radiance.y), "{name}: {radiance}");
        }
    }
}
