//! The keys of `[background]` and its tables, and which value of an environment stands under which.

use crate::scene::environment::EnvironmentDescription;
use crate::scene::value_types::{
    Boolean, COORDINATES as COORDINATE_VECTOR, Color, NonEmptyString, Number, NumberRange, Vector,
};

use super::key::DefaultValue::{Derived, Required, Toml};
use super::key::{DynKey, Key, KeyVisitor, TableSchema, key, keys, untyped_table};
use super::limits::{ANGLE, RADIANCE, SCALE, UNIT_COLOR};

keys! {
    RADIANCE_EVERYWHERE: Color = key("radiance", RADIANCE, Toml("[0, 0, 0]"), "a constant radiance from all directions, in W/(sr m^2)");
    BACKDROP: Color = key("backdrop", RADIANCE, Derived("what lights the scene"),
        "what camera rays that hit nothing see, in W/(sr m^2); the light comes from the background as before");
    UP: Vector = key("up", COORDINATE_VECTOR, Toml("[0, 1, 0]"), "the direction of the zenith, of any length");
    CAMERA_VISIBLE: Boolean = key("camera_visible", Boolean, Derived("true, unless transparent"),
        "whether camera rays that hit nothing see the background");
    TRANSPARENT: Boolean = key("transparent", Boolean, Toml("false"),
        "whether pictures get an alpha channel that is 0 where camera rays hit nothing");
}

pub(in crate::scene) mod gradient {
    use super::*;
    keys! {
        ZENITH: Color = key("zenith", RADIANCE, Required, "radiance from straight above");
        HORIZON: Color = key("horizon", RADIANCE, Required, "radiance from the horizon");
        NADIR: Color = key("nadir", RADIANCE, Derived("horizon"), "radiance from straight below");
    }
}

pub(in crate::scene) mod image {
    use super::*;
    keys! {
        FILE: NonEmptyString = key("file", NonEmptyString, Required, "an .exr or .hdr picture in latitude and longitude");
        ROTATION: Number = key("rotation_degrees", ANGLE, Toml("0"), "rotates the picture about up, counterclockwise when seen from above");
        FACTOR: Number = key("scale", SCALE, Toml("1"), "multiplies the radiance of the picture");
    }
}

pub(in crate::scene) mod sky {
    use super::*;
    keys! {
        TURBIDITY: Number = key("turbidity", Number(NumberRange::Closed(2.0, 10.0)), Toml("3"), "the turbidity of the air: 2 very clear, 10 hazy");
        GROUND_ALBEDO: Color = key("ground_albedo", UNIT_COLOR, Toml("[0.2, 0.2, 0.2]"), "the albedo of the ground below the horizon");
        FACTOR: Number = key("scale", SCALE, Toml("1"), "multiplies the radiance of the sky");
    }
}

pub(in crate::scene) mod sun {
    use super::*;
    keys! {
        DIRECTION: Vector = key("direction", COORDINATE_VECTOR, Derived("from the angles"), "the direction towards the sun, of any length");
        ELEVATION: Number = key("elevation_degrees", Number(NumberRange::Closed(-90.0, 90.0)), Toml("0"),
            "instead of direction: the angle above the horizon");
        AZIMUTH: Number = key("azimuth_degrees", ANGLE, Toml("0"), "instead of direction: the angle from -z to the right (+x)");
        DIAMETER: Number = key("angular_diameter_degrees", Number(NumberRange::Closed(1e-3, 180.0)), Toml("0.533"), "the apparent diameter of the disc");
        IRRADIANCE: Color = key("irradiance", RADIANCE, Required, "W/m^2 on a surface that faces the sun");
    }
}

/// `[background]` and its tables.
pub(super) const TABLES: &[TableSchema] = &[
    untyped_table("background", "what a ray sees when it hits nothing", ALL),
    untyped_table("background.gradient", "a gradient from the zenith to the nadir", gradient::ALL),
    untyped_table("background.image", "an environment map", image::ALL),
    untyped_table("background.sky", "a clear sky", sky::ALL),
    untyped_table("background.sun", "a sun", sun::ALL),
];

impl EnvironmentDescription {
    /// Visits the keys with their values, all but the file of an image. They stand in
    /// [`Self::table`].
    pub(in crate::scene) fn visit_keys(&mut self, visitor: &mut impl KeyVisitor) {
        match self {
            Self::Constant { radiance } => visitor.visit(&RADIANCE_EVERYWHERE, radiance),
            Self::Gradient { zenith, horizon, nadir } => {
                visitor.visit(&gradient::ZENITH, zenith);
                visitor.visit(&gradient::HORIZON, horizon);
                visitor.visit(&gradient::NADIR, nadir);
            }
            Self::Image { file: _, rotation_degrees, scale } => {
                visitor.visit(&image::ROTATION, rotation_degrees);
                visitor.visit(&image::FACTOR, scale);
            }
            Self::Sky { turbidity, ground_albedo, scale } => {
                visitor.visit(&sky::TURBIDITY, turbidity);
                visitor.visit(&sky::GROUND_ALBEDO, ground_albedo);
                visitor.visit(&sky::FACTOR, scale);
            }
        }
    }
}
