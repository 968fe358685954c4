//! The keys of each section, in the order of the manual.

use crate::material::{Metal, NAMED_IORS};
use crate::math::MAX_COORDINATE;
use crate::scene::data::Column;
use crate::scene::description::{ColorStorage, ProjectionKind, SurfaceKind};
use crate::scene::settings::{
    Estimator, FilterKind, Hemisphere, IntegratorKind, LightSamplerKind, MissPolicy,
    PathTerminationKind, SamplerKind,
};
use crate::scene::value_types::{
    Boolean, COORDINATES, Color, EnumValue, Integer, ListOf, NamedValue, NonEmptyString, Number,
    NumberRange, Vector,
};

use super::DefaultValue::{Derived, Required, Toml};
use super::{CliOption, DynKey, Key, key, key_with_option, option};

/// Maximum radiance.
pub(in crate::scene) const MAX_RADIANCE: f64 = 1e15;
/// Minimum radius; its square is still a normal f32 number.
pub(in crate::scene) const MIN_RADIUS: f64 = 1e-15;
/// Maximum number of pixels along one side.
pub(in crate::scene) const MAX_IMAGE_SIDE: u32 = 65_536;

const LENGTH: Number = Number(NumberRange::LeftOpen(0.0, MAX_COORDINATE));
const RADIANCE: Color = Color(NumberRange::Closed(0.0, MAX_RADIANCE));
/// Three channels in `[0, 1]`.
const UNIT_COLOR: Color = Color(NumberRange::Closed(0.0, 1.0));
/// A number in `[0, 1]`.
const UNIT_INTERVAL: Number = Number(NumberRange::Closed(0.0, 1.0));
const ANGLE: Number = Number(NumberRange::Closed(-360.0, 360.0));
const SCALE: Number = Number(NumberRange::Closed(0.0, 1e6));
const COORDINATE_VECTOR: Vector = COORDINATES;

macro_rules! keys {
    ($($(#[$doc:meta])* $id:ident: $kind:ty = $key:expr;)+) => {
        $($(#[$doc])* pub(in crate::scene) const $id: Key<$kind> = $key;)+
        pub(in crate::scene) const ALL: &[&dyn DynKey] = &[$(&$id),+];
    };
}

/// The document root.
pub(in crate::scene) mod root {
    use super::*;
    keys! {
        FORMAT: Integer<i64> = key("format", Integer(1..=i64::MAX), Required, "the version of this format: 1");
    }
}

/// `[image]`.
pub(in crate::scene) mod image {
    use super::*;
    keys! {
        WIDTH: Integer<u32> = key("width", Integer(1..=MAX_IMAGE_SIDE), Toml("640"), "pixels across");
        HEIGHT: Integer<u32> = key("height", Integer(1..=MAX_IMAGE_SIDE), Toml("480"), "pixels down");
        CROP: ListOf<Integer<u32>> = key_with_option("crop", ListOf(Integer(0..=MAX_IMAGE_SIDE)), Derived("the whole picture"),
            "the part that is rendered: [x0, y0, x1, y1], columns x0 to x1 - 1 and rows y0 to y1 - 1",
            CliOption {
                help: Some("Render this part of the picture only: its first column and row, and the ones behind its last"),
                ..option("crop", "X0,Y0,X1,Y1")
            });
        FILTER: EnumValue<FilterKind> = key("filter", EnumValue::NEW, Toml("\"box\""), "the weight function of a pixel");
        FILTER_RADIUS: Number = key("filter_radius", Number(NumberRange::LeftOpen(0.0, 64.0)), Derived("that of the filter"),
            "half the extent of the filter, in pixels");
    }
}

/// `[camera]`.
pub(in crate::scene) mod camera {
    use super::*;

    keys! {
        TYPE: EnumValue<ProjectionKind> = key("type", EnumValue::NEW, Toml("\"perspective\""), "how directions become places in the picture");
        POSITION: Vector = key("position", COORDINATE_VECTOR, Required, "where the camera is");
        LOOK_AT: Vector = key("look_at", COORDINATE_VECTOR, Required, "the point in the middle of the picture");
        UP: Vector = key("up", COORDINATE_VECTOR, Toml("[0, 1, 0]"), "the direction that is up in the picture, of any length");
        NEAR: Number = key("near", Number(NumberRange::Closed(0.0, MAX_COORDINATE)), Toml("0"),
            "camera rays start at this depth and look through what is nearer");
    }

    pub(in crate::scene) mod perspective {
        use super::*;
        keys! {
            FOV: Number = key("vertical_fov_degrees", Number(NumberRange::Open(0.0, 180.0)), Toml("36"),
                "the angle from the bottom to the top of the picture");
            APERTURE_RADIUS: Number = key("aperture_radius", Number(NumberRange::Closed(0.0, MAX_COORDINATE)), Toml("0"),
                "the opening of the lens, in scene units; 0 is a pinhole");
            FOCUS_DISTANCE: Number = key("focus_distance", LENGTH, Derived("that of look_at"),
                "from the lens, along the view axis, to the plane in focus");
            FOCUS_ON: NonEmptyString = key("focus_on", NonEmptyString, Derived("none"), "the name of a sphere to focus on, in place of a distance");
            BLADES: Integer<u32> = key("blades", Integer(0..=64), Toml("0"), "corners of the opening; 0 is a disk");
            ROTATION: Number = key("rotation_degrees", ANGLE, Toml("0"), "turns the opening counter-clockwise");
        }
    }

    pub(in crate::scene) mod orthographic {
        use super::*;
        keys! {
            HEIGHT: Number = key("height", LENGTH, Required, "what fits between the bottom and the top of the picture, in scene units");
        }
    }

    pub(in crate::scene) mod panoramic {
        use super::*;
        keys! {
            HORIZONTAL: Number = key("horizontal_extent_degrees", Number(NumberRange::LeftOpen(0.0, 360.0)), Toml("360"),
                "from the left to the right of the picture");
            VERTICAL: Number = key("vertical_extent_degrees", Number(NumberRange::LeftOpen(0.0, 180.0)), Toml("180"),
                "from the bottom to the top of the picture");
        }
    }
}

/// `[background]`.
pub(in crate::scene) mod background {
    use super::*;
    keys! {
        RADIANCE_EVERYWHERE: Color = key("radiance", RADIANCE, Toml("[0, 0, 0]"), "radiance from everywhere, in W/(sr m^2)");
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
            HORIZON: Color = key("horizon", RADIANCE, Required, "radiance from the sides");
            NADIR: Color = key("nadir", RADIANCE, Derived("horizon"), "radiance from straight below");
        }
    }

    pub(in crate::scene) mod image {
        use super::*;
        keys! {
            FILE: NonEmptyString = key("file", NonEmptyString, Required, "an .exr or .hdr picture in latitude and longitude");
            ROTATION: Number = key("rotation_degrees", ANGLE, Toml("0"), "turns the picture about up, counter-clockwise from above");
            FACTOR: Number = key("scale", SCALE, Toml("1"), "a factor on its radiance");
        }
    }

    pub(in crate::scene) mod sky {
        use super::*;
        keys! {
            TURBIDITY: Number = key("turbidity", Number(NumberRange::Closed(2.0, 10.0)), Toml("3"), "the air: 2 very clear, 10 hazy");
            GROUND_ALBEDO: Color = key("ground_albedo", UNIT_COLOR, Toml("[0.2, 0.2, 0.2]"), "of the ground below the horizon");
            FACTOR: Number = key("scale", SCALE, Toml("1"), "a factor on the sky's radiance");
        }
    }

    pub(in crate::scene) mod sun {
        use super::*;
        keys! {
            DIRECTION: Vector = key("direction", COORDINATE_VECTOR, Derived("from the angles"), "towards the sun, of any length");
            ELEVATION: Number = key("elevation_degrees", Number(NumberRange::Closed(-90.0, 90.0)), Toml("0"),
                "in place of direction: the angle above the horizon");
            AZIMUTH: Number = key("azimuth_degrees", ANGLE, Toml("0"), "in place of direction: the angle from -z to the right");
            DIAMETER: Number = key("angular_diameter_degrees", Number(NumberRange::Closed(1e-3, 180.0)), Toml("0.533"), "how wide it is seen");
            IRRADIANCE: Color = key("irradiance", RADIANCE, Required, "W/m^2 on a surface that faces it");
        }
    }
}

/// `[materials.NAME]`.
pub(in crate::scene) mod material {
    use super::*;

    keys! {
        TYPE: EnumValue<SurfaceKind> = key("type", EnumValue::NEW, Required, "the reflection model");
        EMISSION: Color = key("emission", RADIANCE, Toml("[0, 0, 0]"), "radiance that the surface emits on both sides, in W/(sr m^2)");
        OPACITY: Number = key("opacity", UNIT_INTERVAL, Toml("1"), "the probability that the surface is there for light");
    }

    pub(in crate::scene) mod diffuse {
        use super::*;
        keys! {
            ALBEDO: Color = key("albedo", UNIT_COLOR, Required, "the share of light that is scattered");
            ROUGHNESS: Number = key("roughness", UNIT_INTERVAL, Toml("0"), "0 is Lambert's law, 1 as flat as chalk");
        }
    }

    pub(in crate::scene) mod mirror {
        use super::*;
        keys! {
            REFLECTANCE: Color = key("reflectance", UNIT_COLOR, Required, "the share of light that is reflected");
        }
    }

    pub(in crate::scene) mod conductor {
        use super::*;
        const INDEX: Color = Color(NumberRange::Closed(0.0, 100.0));
        keys! {
            METAL: NamedValue<Metal> = key("metal", NamedValue(&Metal::NAMED), Derived("required, or ior and extinction"), "a metal by its name");
            IOR: Color = key("ior", INDEX, Derived("from metal"), "the real part of the complex index of refraction");
            EXTINCTION: Color = key("extinction", INDEX, Derived("from metal"), "the imaginary part of the index of refraction");
            ROUGHNESS: Number = key("roughness", UNIT_INTERVAL, Toml("0"), "the square root of the GGX distribution's alpha");
        }
    }

    pub(in crate::scene) mod dielectric {
        use super::*;
        keys! {
            IOR: Number = key("ior", Number(NumberRange::Closed(0.1, 10.0)), Derived("required, or glass"),
                "index of refraction relative to vacuum");
            GLASS: NamedValue<f64> = key("glass", NamedValue(&NAMED_IORS), Derived("from ior"), "a glass, crystal or liquid by its name, in place of ior");
            ROUGHNESS: Number = key("roughness", UNIT_INTERVAL, Toml("0"), "the square root of the GGX distribution's alpha");
            PRIORITY: Integer<i32> = key("priority", Integer(i32::MIN..=i32::MAX), Toml("0"),
                "where such spheres overlap, the higher priority fills the common part");
            ABSORPTION: Color = key("absorption", Color(NumberRange::Closed(0.0, 1e15)), Toml("[0, 0, 0]"), "what the inside absorbs per unit of length");
        }
    }

    /// Index of refraction of a coat, relative to its surroundings.
    const COAT_IOR: Number = Number(NumberRange::Closed(1.0, 10.0));

    pub(in crate::scene) mod plastic {
        use super::*;
        keys! {
            ALBEDO: Color = key("albedo", UNIT_COLOR, Required, "the share of light that the base under the coat scatters");
            IOR: Number = key("ior", COAT_IOR, Toml("1.5"), "index of refraction of the coat");
            ROUGHNESS: Number = key("roughness", UNIT_INTERVAL, Toml("0"), "the roughness of the coat");
        }
    }

    pub(in crate::scene) mod principled {
        use super::*;
        keys! {
            BASE_COLOR: Color = key("base_color", UNIT_COLOR, Required, "the colour of the diffuse part, of metal and of transmitted light");
            METALLIC: Number = key("metallic", UNIT_INTERVAL, Toml("0"), "the share that is metal");
            ROUGHNESS: Number = key("roughness", UNIT_INTERVAL, Toml("0.5"), "of metal, gloss and glass alike");
            SPECULAR: Number = key("specular", UNIT_INTERVAL, Toml("0.5"), "how strong the gloss is: 0.5 is what ior says");
            IOR: Number = key("ior", COAT_IOR, Toml("1.5"), "index of refraction of gloss and glass");
            COAT: Number = key("coat", UNIT_INTERVAL, Toml("0"), "how much there is of a clear coat");
            COAT_ROUGHNESS: Number = key("coat_roughness", UNIT_INTERVAL, Toml("0"), "the roughness of the coat");
            TRANSMISSION: Number = key("transmission", UNIT_INTERVAL, Toml("0"), "the share of what is not metal that is glass");
        }
    }

    pub(in crate::scene) mod phong {
        use super::*;
        keys! {
            ALBEDO: Color = key("albedo", UNIT_COLOR, Required, "the diffuse share");
            SPECULAR: Color = key("specular", UNIT_COLOR, Required, "the glossy share");
            EXPONENT: Number = key("exponent", Number(NumberRange::Closed(0.0, 1e5)), Required, "how narrow the highlight is");
            NORMALIZED: Boolean = key("normalized", Boolean, Toml("true"), "whether the highlight is scaled to conserve energy");
        }
    }
}

/// `[[spheres]]`.
pub(in crate::scene) mod sphere {
    use super::*;
    keys! {
        NAME: NonEmptyString = key("name", NonEmptyString, Derived("none"), "used in messages and to set keys of this sphere");
        CENTER: Vector = key("center", COORDINATE_VECTOR, Required, "the centre");
        RADIUS: Number = key("radius", Number(NumberRange::Closed(MIN_RADIUS, MAX_COORDINATE)), Required, "the radius");
        MATERIAL: NonEmptyString = key("material", NonEmptyString, Required, "the name of a material");
    }
}

/// `[[sphere_tables]]`.
pub(in crate::scene) mod table {
    use super::*;
    keys! {
        FILE: NonEmptyString = key("file", NonEmptyString, Required, "a file of raw little-endian f32 rows");
        NAME: NonEmptyString = key("name", NonEmptyString, Derived("the name of the file"), "used in the layers of Cryptomatte and to set keys of this table");
        COLUMNS: ListOf<EnumValue<Column>> = key("columns", ListOf(EnumValue::NEW), Required, "what each number of a row is");
        MATERIAL: NonEmptyString = key("material", NonEmptyString, Required, "the name of a material");
        COLORS: EnumValue<ColorStorage> = key("colors", EnumValue::NEW, Toml("\"exact\""), "how the colours of the rows are kept in memory");
    }
}

/// `[render]`.
pub(in crate::scene) mod render {
    use super::*;
    keys! {
        INTEGRATOR: EnumValue<IntegratorKind> = key_with_option("integrator", EnumValue::NEW, Toml("\"path\""), "what is computed",
            option("integrator", "NAME"));
        ESTIMATOR: EnumValue<Estimator> = key_with_option("estimator", EnumValue::NEW, Toml("\"mis\""), "how lights are found",
            option("estimator", "NAME"));
        SAMPLER: EnumValue<SamplerKind> = key_with_option("sampler", EnumValue::NEW, Derived("sobol; independent for paper"), "how random numbers are spread",
            option("sampler", "NAME"));
        SAMPLES: Integer<u32> = key_with_option("samples_per_pixel", Integer(1..=u32::MAX), Derived("64; 1 for normals and raycast; k^2 N for paper"),
            "samples of each pixel", CliOption { help: Some("Samples per pixel, from 1"), ..option("spp", "N") });
        SEED: Integer<i64> = key_with_option("seed", Integer(0..=i64::MAX), Toml("0"), "chooses the random numbers; equal seeds give equal pictures", option("seed", "S"));
        MAX_DEPTH: Integer<u32> = key_with_option("max_depth", Integer(1..=u32::MAX), Derived("no limit"),
            "the longest path in edges: 1 sees emitters only, 2 adds direct light, 3 one bounce", option("max-depth", "D"));
        CLAMP_INDIRECT: Number = key("clamp_indirect", Number(NumberRange::LeftOpen(0.0, MAX_RADIANCE)), Derived("no limit"),
            "the most that one path may add to a channel of indirect light: biased");
        LIGHT_CHOICE: EnumValue<LightSamplerKind> = key("light_choice", EnumValue::NEW, Toml("\"hierarchy\""), "which emitter is sampled at a point");
    }

    pub(in crate::scene) mod ambient_occlusion {
        use super::*;
        keys! {
            DISTANCE: Number = key("distance", LENGTH, Derived("no limit"), "only what is nearer than this occludes a point");
        }
    }

    pub(in crate::scene) mod paper {
        use super::*;
        keys! {
            SUBPIXELS: Integer<u32> = key("subpixels", Integer(1..=256), Toml("2"), "k: a pixel is k x k sub-pixels");
            SAMPLES: Integer<u32> = key("samples", Integer(1..=u32::MAX), Toml("4"), "N: paths of each sub-pixel");
            HEMISPHERE: EnumValue<Hemisphere> = key("hemisphere", EnumValue::NEW, Toml("\"cosine\""), "how directions are drawn");
            STOP: EnumValue<PathTerminationKind> = key("stop", EnumValue::NEW, Toml("\"roulette\""), "when a path ends");
            THRESHOLD: Number = key("threshold", Number(NumberRange::LeftOpen(0.0, 1.0)), Toml("0.01"),
                "with stop = \"threshold\": a path ends when its weight falls below this");
            MISS: EnumValue<MissPolicy> = key("miss", EnumValue::NEW, Toml("\"background\""), "what becomes of a camera ray that hits nothing");
            JITTER: Number = key("jitter", UNIT_INTERVAL, Toml("1"), "the size of the random shift in a sub-pixel");
        }
    }

    pub(in crate::scene) mod raycast {
        use super::*;
        keys! {
            SHADOWS: Boolean = key("shadows", Boolean, Toml("false"), "whether emitters cast shadows");
        }
    }
}
