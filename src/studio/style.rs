//! Styles: light, material and surroundings that suit each other.
//!
//! The sky is a gradient, the key light a large disc like a softbox far away. Both are at infinity,
//! so they suit particles of any size. The ground is as bright in their light as the sky at the
//! horizon, so that there is no visible horizon, and only the shadow remains.

use std::f64::consts::PI;

use crate::color::Rgb;
use crate::names::named_enum;

/// A style.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Style {
    /// Satin balls in a white studio.
    #[default]
    Studio,
    /// Matte, in softer light.
    Clay,
    /// Polished, with a smaller light.
    Glossy,
    /// Matte on a white floor, as in papers on point clouds.
    Paper,
    /// Colours as in the colour bar.
    Flat,
    /// On a dark ground.
    Dark,
    /// Particles that shine in the dark.
    Glow,
}

named_enum! {
    Style {
        Studio = "studio",
        Clay = "clay",
        Glossy = "glossy",
        Paper = "paper",
        Flat = "flat",
        Dark = "dark",
        Glow = "glow",
    }
}

/// What a style consists of. Radiance is relative to white, which is 1.
#[derive(Clone, Copy, Debug)]
pub(super) struct StyleValues {
    /// Radiance of the zenith.
    pub(super) zenith: f64,
    /// Irradiance of the key light on a facing surface, divided by pi.
    pub(super) key: f64,
    /// Apparent diameter of the key light, in degrees.
    pub(super) key_diameter: f64,
    /// Elevation of the key light, in degrees.
    pub(super) key_elevation: f64,
    /// Azimuth of the key light from the camera, in degrees; negative is to the left.
    pub(super) key_azimuth: f64,
    /// Colour of ground and horizon, in linear light.
    pub(super) backdrop: f64,
    /// True if there is a ground.
    pub(super) ground: bool,
    /// The colour of particles where the file suggests none.
    pub(super) plain: &'static str,
    /// Name of the material.
    pub(super) material: &'static str,
    /// Multiplies radii that are chosen from distances.
    pub(super) radius_scale: f64,
    /// Emission of a white particle.
    pub(super) glow: f64,
    /// Share of the colours that is reflected.
    pub(super) shade: f64,
    /// Maximum path length, if light must not be scattered often.
    pub(super) max_depth: Option<u32>,
}

/// The materials by name, each as keys of a scene file. Particles replace the colour.
pub const MATERIALS: [(&str, &str); 8] = [
    ("matte", "type = \"diffuse\"\nalbedo = [0.5, 0.5, 0.5]\nroughness = 0.3"),
    ("lambert", "type = \"diffuse\"\nalbedo = [0.5, 0.5, 0.5]"),
    // Shows colours as they are; plastic would deepen them, and a colour bar would be wrong.
    (
        "satin",
        "type = \"principled\"\nbase_color = [0.5, 0.5, 0.5]\nroughness = 0.35\nspecular = 0.25",
    ),
    ("plastic", "type = \"plastic\"\nalbedo = [0.5, 0.5, 0.5]\nroughness = 0.2"),
    ("glossy", "type = \"plastic\"\nalbedo = [0.5, 0.5, 0.5]\nroughness = 0.08"),
    (
        "metal",
        "type = \"principled\"\nbase_color = [0.5, 0.5, 0.5]\nmetallic = 1.0\nroughness = 0.35",
    ),
    ("glass", "type = \"dielectric\"\nior = 1.5"),
    ("mirror", "type = \"mirror\"\nreflectance = [0.9, 0.9, 0.9]"),
];

impl Style {
    pub(super) fn values(self) -> StyleValues {
        let studio = StyleValues {
            zenith: 0.5,
            key: 0.6,
            key_diameter: 30.0,
            key_elevation: 42.0,
            key_azimuth: -30.0,
            backdrop: 1.0,
            ground: true,
            plain: "#6f9bc4",
            material: "satin",
            radius_scale: 1.0,
            glow: 0.0,
            shade: 0.95,
            max_depth: None,
        };
        match self {
            Self::Studio => studio,
            Self::Clay => {
                StyleValues { key_diameter: 50.0, plain: "#cbb9a8", material: "matte", ..studio }
            }
            Self::Glossy => StyleValues { key_diameter: 16.0, material: "glossy", ..studio },
            Self::Paper => StyleValues {
                zenith: 0.8,
                key: 0.85,
                key_diameter: 60.0,
                key_elevation: 62.0,
                plain: "position",
                radius_scale: 1.8,
                material: "lambert",
                ..studio
            },
            // Mostly emission, so that shadows change colours little.
            Self::Flat => StyleValues {
                zenith: 1.0,
                key: 0.0,
                ground: false,
                material: "lambert",
                glow: FLAT_GLOW,
                shade: 1.0 - FLAT_GLOW,
                max_depth: Some(2),
                ..studio
            },
            Self::Dark => StyleValues {
                zenith: 0.35,
                key: 1.5,
                key_diameter: 18.0,
                key_azimuth: -55.0,
                backdrop: 0.018,
                ..studio
            },
            Self::Glow => StyleValues {
                zenith: 0.02,
                key: 0.0,
                backdrop: 0.0,
                plain: "#ffcf8f",
                ground: false,
                material: "lambert",
                glow: 1.0,
                ..studio
            },
        }
    }
}

/// Share of the colours that particles emit in the style `flat`.
const FLAT_GLOW: f64 = 0.85;

impl StyleValues {
    /// Albedo of a ground that is as bright in the light of the studio as the backdrop.
    pub(super) fn ground_albedo(&self, backdrop: Rgb) -> Rgb {
        let from_key = self.key * self.key_elevation.to_radians().sin();
        let channel = |color: f32| {
            let color = f64::from(color);
            let from_sky = color + (self.zenith - color) * 2.0 / 3.0;
            (color / (from_sky + from_key).max(1e-9)).min(MAX_GROUND_ALBEDO) as f32
        };
        Rgb::from_array(backdrop.to_array().map(channel))
    }

    /// Irradiance of the key light on a facing surface.
    pub(super) fn key_irradiance(&self) -> f64 {
        PI * self.key
    }
}

/// Whiter than paper, but not so white that light never ends.
const MAX_GROUND_ALBEDO: f64 = 0.95;

#[cfg(test)]
mod tests {
    use super::*;

    /// Integrates the sky over the hemisphere.
    #[test]
    fn an_open_ground_is_as_bright_as_the_horizon() {
        for (name, style) in Style::NAMES {
            let values = style.values();
            let backdrop = Rgb::splat(values.backdrop as f32);
            let albedo = f64::from(values.ground_albedo(backdrop).x);
            let steps = 10_000;
            let sky: f64 = (0..steps)
                .map(|step| {
                    let sine = (f64::from(step) + 0.5) / f64::from(steps);
                    let radiance = values.backdrop + (values.zenith - values.backdrop) * sine;
                    2.0 * radiance * sine / f64::from(steps)
                })
                .sum();
            let key = values.key * values.key_elevation.to_radians().sin();
            let radiance = albedo * (sky + key);
            if values.ground {
                assert!((radiance - values.backdrop).abs() < 0.01, "{name}: {radiance}");
            }
        }
    }
}
