//! The entries of the table of keys, section by section, in the order of the manual.

use crate::material::{GLASSES, Metal};
use crate::math::MAX_COORDINATE;
use crate::scene::data::Column;
use crate::scene::description::{ColorStorage, ProjectionKind, SurfaceKind};
use crate::scene::kinds::{
    COORDINATES, Choice, Color, Each, Flag, Limits, Number, Text, Triple, Whole, Word,
};
use crate::scene::settings::{
    Estimator, FilterKind, Hemisphere, IntegratorKind, LightChoice, Miss, SamplerKind, StopKind,
};

use super::Fallback::{Depends, Is, Required};
use super::{AnyKey, Key, SceneOption, key, option, optional};

/// The largest radiance.
pub(in crate::scene) const BRIGHTEST: f64 = 1e15;
/// The smallest radius; its square is still a normal f32 number.
pub(in crate::scene) const SMALLEST_RADIUS: f64 = 1e-15;
/// The most pixels along one side.
pub(in crate::scene) const WIDEST: u32 = 65_536;

const LENGTH: Number = Number(Limits::AboveTo(0.0, MAX_COORDINATE));
const RADIANCE: Color = Color(Limits::FromTo(0.0, BRIGHTEST));
/// Three shares of light.
const SHARES: Color = Color(Limits::FromTo(0.0, 1.0));
/// A share that is one number.
const SHARE: Number = Number(Limits::FromTo(0.0, 1.0));
const ANGLE: Number = Number(Limits::FromTo(-360.0, 360.0));
const SCALE: Number = Number(Limits::FromTo(0.0, 1e6));
const COORDINATE_TRIPLE: Triple = COORDINATES;

macro_rules! keys {
    ($($(#[$doc:meta])* $id:ident: $kind:ty = $key:expr;)+) => {
        $($(#[$doc])* pub(in crate::scene) const $id: Key<$kind> = $key;)+
        pub(in crate::scene) const ALL: &[&dyn AnyKey] = &[$(&$id),+];
    };
}

/// The document itself.
pub(in crate::scene) mod root {
    use super::*;
    keys! {
        FORMAT: Whole<i64> = key("format", Whole(1..=i64::MAX), Required, "the version of this format: 1");
    }
}

/// `[image]`.
pub(in crate::scene) mod image {
    use super::*;
    keys! {
        WIDTH: Whole<u32> = key("width", Whole(1..=WIDEST), Is("640"), "pixels across");
        HEIGHT: Whole<u32> = key("height", Whole(1..=WIDEST), Is("480"), "pixels down");
        CROP: Each<Whole<u32>> = optional("crop", Each(Whole(0..=WIDEST)), Depends("the whole picture"),
            "the part that is rendered: [x0, y0, x1, y1], columns x0 to x1 - 1 and rows y0 to y1 - 1",
            SceneOption {
                help: Some("Render this part of the picture only: its first column and row, and the ones behind its last"),
                ..option("crop", "X0,Y0,X1,Y1")
            });
        FILTER: Choice<FilterKind> = key("filter", Choice::NEW, Is("\"box\""), "the weight function of a pixel");
        FILTER_RADIUS: Number = key("filter_radius", Number(Limits::AboveTo(0.0, 64.0)), Depends("that of the filter"),
            "half the extent of the filter, in pixels");
    }
}

/// `[camera]`.
pub(in crate::scene) mod camera {
    use super::*;

    keys! {
        TYPE: Choice<ProjectionKind> = key("type", Choice::NEW, Is("\"perspective\""), "how directions become places in the picture");
        POSITION: Triple = key("position", COORDINATE_TRIPLE, Required, "where the camera is");
        LOOK_AT: Triple = key("look_at", COORDINATE_TRIPLE, Required, "the point in the middle of the picture");
        UP: Triple = key("up", COORDINATE_TRIPLE, Is("[0, 1, 0]"), "the direction that is up in the picture, of any length");
        NEAR: Number = key("near", Number(Limits::FromTo(0.0, MAX_COORDINATE)), Is("0"),
            "camera rays start at this depth and look through what is nearer");
    }

    pub(in crate::scene) mod perspective {
        use super::*;
        keys! {
            FOV: Number = key("vertical_fov_degrees", Number(Limits::Between(0.0, 180.0)), Is("36"),
                "the angle from the bottom to the top of the picture");
            APERTURE_RADIUS: Number = key("aperture_radius", Number(Limits::FromTo(0.0, MAX_COORDINATE)), Is("0"),
                "the opening of the lens, in scene units; 0 is a pinhole");
            FOCUS_DISTANCE: Number = key("focus_distance", LENGTH, Depends("that of look_at"),
                "from the lens, along the view axis, to the plane in focus");
            FOCUS_ON: Text = key("focus_on", Text, Depends("none"), "the name of a sphere to focus on, in place of a distance");
            BLADES: Whole<u32> = key("blades", Whole(0..=64), Is("0"), "corners of the opening; 0 is a disk");
            ROTATION: Number = key("rotation_degrees", ANGLE, Is("0"), "turns the opening counter-clockwise");
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
            HORIZONTAL: Number = key("horizontal_extent_degrees", Number(Limits::AboveTo(0.0, 360.0)), Is("360"),
                "from the left to the right of the picture");
            VERTICAL: Number = key("vertical_extent_degrees", Number(Limits::AboveTo(0.0, 180.0)), Is("180"),
                "from the bottom to the top of the picture");
        }
    }
}

/// `[background]`.
pub(in crate::scene) mod background {
    use super::*;
    keys! {
        RADIANCE_EVERYWHERE: Color = key("radiance", RADIANCE, Is("[0, 0, 0]"), "radiance from everywhere, in W/(sr m^2)");
        UP: Triple = key("up", COORDINATE_TRIPLE, Is("[0, 1, 0]"), "the direction of the zenith, of any length");
        CAMERA_VISIBLE: Flag = key("camera_visible", Flag, Depends("true, unless transparent"),
            "whether camera rays that hit nothing see the background");
        TRANSPARENT: Flag = key("transparent", Flag, Is("false"),
            "whether pictures get an alpha channel that is 0 where camera rays hit nothing");
    }

    pub(in crate::scene) mod gradient {
        use super::*;
        keys! {
            ZENITH: Color = key("zenith", RADIANCE, Required, "radiance from straight above");
            HORIZON: Color = key("horizon", RADIANCE, Required, "radiance from the sides");
            NADIR: Color = key("nadir", RADIANCE, Depends("horizon"), "radiance from straight below");
        }
    }

    pub(in crate::scene) mod image {
        use super::*;
        keys! {
            FILE: Text = key("file", Text, Required, "an .exr or .hdr picture in latitude and longitude");
            ROTATION: Number = key("rotation_degrees", ANGLE, Is("0"), "turns the picture about up, counter-clockwise from above");
            FACTOR: Number = key("scale", SCALE, Is("1"), "a factor on its radiance");
        }
    }

    pub(in crate::scene) mod sky {
        use super::*;
        keys! {
            TURBIDITY: Number = key("turbidity", Number(Limits::FromTo(2.0, 10.0)), Is("3"), "the air: 2 very clear, 10 hazy");
            GROUND_ALBEDO: Color = key("ground_albedo", SHARES, Is("[0.2, 0.2, 0.2]"), "of the ground below the horizon");
            FACTOR: Number = key("scale", SCALE, Is("1"), "a factor on the sky's radiance");
        }
    }

    pub(in crate::scene) mod sun {
        use super::*;
        keys! {
            DIRECTION: Triple = key("direction", COORDINATE_TRIPLE, Depends("from the angles"), "towards the sun, of any length");
            ELEVATION: Number = key("elevation_degrees", Number(Limits::FromTo(-90.0, 90.0)), Is("0"),
                "in place of direction: the angle above the horizon");
            AZIMUTH: Number = key("azimuth_degrees", ANGLE, Is("0"), "in place of direction: the angle from -z to the right");
            DIAMETER: Number = key("angular_diameter_degrees", Number(Limits::FromTo(1e-3, 180.0)), Is("0.533"), "how wide it is seen");
            IRRADIANCE: Color = key("irradiance", RADIANCE, Required, "W/m^2 on a surface that faces it");
        }
    }
}

/// `[materials.NAME]`.
pub(in crate::scene) mod material {
    use super::*;

    keys! {
        TYPE: Choice<SurfaceKind> = key("type", Choice::NEW, Required, "the reflection model");
        EMISSION: Color = key("emission", RADIANCE, Is("[0, 0, 0]"), "radiance that the surface emits on both sides, in W/(sr m^2)");
        OPACITY: Number = key("opacity", SHARE, Is("1"), "the probability that the surface is there for light");
    }

    pub(in crate::scene) mod diffuse {
        use super::*;
        keys! {
            ALBEDO: Color = key("albedo", SHARES, Required, "the share of light that is scattered");
            ROUGHNESS: Number = key("roughness", SHARE, Is("0"), "0 is Lambert's law, 1 as flat as chalk");
        }
    }

    pub(in crate::scene) mod mirror {
        use super::*;
        keys! {
            REFLECTANCE: Color = key("reflectance", SHARES, Required, "the share of light that is reflected");
        }
    }

    pub(in crate::scene) mod conductor {
        use super::*;
        const INDEX: Color = Color(Limits::FromTo(0.0, 100.0));
        keys! {
            METAL: Word<Metal> = key("metal", Word(&Metal::NAMED), Depends("required, or ior and extinction"), "a metal by its name");
            IOR: Color = key("ior", INDEX, Depends("from metal"), "the real part of the complex index of refraction");
            EXTINCTION: Color = key("extinction", INDEX, Depends("from metal"), "the imaginary part of the index of refraction");
            ROUGHNESS: Number = key("roughness", SHARE, Is("0"), "the square root of the GGX distribution's alpha");
        }
    }

    pub(in crate::scene) mod dielectric {
        use super::*;
        keys! {
            IOR: Number = key("ior", Number(Limits::FromTo(0.1, 10.0)), Depends("required, or glass"),
                "index of refraction relative to vacuum");
            GLASS: Word<f64> = key("glass", Word(&GLASSES), Depends("from ior"), "a glass, crystal or liquid by its name, in place of ior");
            ROUGHNESS: Number = key("roughness", SHARE, Is("0"), "the square root of the GGX distribution's alpha");
            PRIORITY: Whole<i32> = key("priority", Whole(i32::MIN..=i32::MAX), Is("0"),
                "where such spheres overlap, the higher priority fills the common part");
            ABSORPTION: Color = key("absorption", Color(Limits::FromTo(0.0, 1e15)), Is("[0, 0, 0]"), "what the inside absorbs per unit of length");
        }
    }

    /// The index of a coat, relative to what is around it.
    const COAT_IOR: Number = Number(Limits::FromTo(1.0, 10.0));

    pub(in crate::scene) mod plastic {
        use super::*;
        keys! {
            ALBEDO: Color = key("albedo", SHARES, Required, "the share of light that the base under the coat scatters");
            IOR: Number = key("ior", COAT_IOR, Is("1.5"), "index of refraction of the coat");
            ROUGHNESS: Number = key("roughness", SHARE, Is("0"), "the roughness of the coat");
        }
    }

    pub(in crate::scene) mod principled {
        use super::*;
        keys! {
            BASE_COLOR: Color = key("base_color", SHARES, Required, "the colour of the diffuse part, of metal and of transmitted light");
            METALLIC: Number = key("metallic", SHARE, Is("0"), "the share that is metal");
            ROUGHNESS: Number = key("roughness", SHARE, Is("0.5"), "of metal, gloss and glass alike");
            SPECULAR: Number = key("specular", SHARE, Is("0.5"), "how strong the gloss is: 0.5 is what ior says");
            IOR: Number = key("ior", COAT_IOR, Is("1.5"), "index of refraction of gloss and glass");
            COAT: Number = key("coat", SHARE, Is("0"), "how much there is of a clear coat");
            COAT_ROUGHNESS: Number = key("coat_roughness", SHARE, Is("0"), "the roughness of the coat");
            TRANSMISSION: Number = key("transmission", SHARE, Is("0"), "the share of what is not metal that is glass");
        }
    }

    pub(in crate::scene) mod phong {
        use super::*;
        keys! {
            ALBEDO: Color = key("albedo", SHARES, Required, "the diffuse share");
            SPECULAR: Color = key("specular", SHARES, Required, "the glossy share");
            EXPONENT: Number = key("exponent", Number(Limits::FromTo(0.0, 1e5)), Required, "how narrow the highlight is");
            NORMALIZED: Flag = key("normalized", Flag, Is("true"), "whether the highlight is scaled to conserve energy");
        }
    }
}

/// `[[spheres]]`.
pub(in crate::scene) mod sphere {
    use super::*;
    keys! {
        NAME: Text = key("name", Text, Depends("none"), "used in messages and to set keys of this sphere");
        CENTER: Triple = key("center", COORDINATE_TRIPLE, Required, "the centre");
        RADIUS: Number = key("radius", Number(Limits::FromTo(SMALLEST_RADIUS, MAX_COORDINATE)), Required, "the radius");
        MATERIAL: Text = key("material", Text, Required, "the name of a material");
    }
}

/// `[[sphere_tables]]`.
pub(in crate::scene) mod table {
    use super::*;
    keys! {
        FILE: Text = key("file", Text, Required, "a file of raw little-endian f32 rows");
        NAME: Text = key("name", Text, Depends("the name of the file"), "used in the layers of Cryptomatte and to set keys of this table");
        COLUMNS: Each<Choice<Column>> = key("columns", Each(Choice::NEW), Required, "what each number of a row is");
        MATERIAL: Text = key("material", Text, Required, "the name of a material");
        COLORS: Choice<ColorStorage> = key("colors", Choice::NEW, Is("\"exact\""), "how the colours of the rows are kept in memory");
    }
}

/// `[render]`.
pub(in crate::scene) mod render {
    use super::*;
    keys! {
        INTEGRATOR: Choice<IntegratorKind> = optional("integrator", Choice::NEW, Is("\"path\""), "what is computed",
            option("integrator", "NAME"));
        ESTIMATOR: Choice<Estimator> = optional("estimator", Choice::NEW, Is("\"mis\""), "how lights are found",
            option("estimator", "NAME"));
        SAMPLER: Choice<SamplerKind> = optional("sampler", Choice::NEW, Depends("sobol; independent for paper"), "how random numbers are spread",
            option("sampler", "NAME"));
        SAMPLES: Whole<u32> = optional("samples_per_pixel", Whole(1..=u32::MAX), Depends("64; 1 for normals and raycast; k^2 N for paper"),
            "samples of each pixel", SceneOption { help: Some("Samples per pixel, from 1"), ..option("spp", "N") });
        SEED: Whole<i64> = optional("seed", Whole(0..=i64::MAX), Is("0"), "chooses the random numbers; equal seeds give equal pictures", option("seed", "S"));
        MAX_DEPTH: Whole<u32> = optional("max_depth", Whole(1..=u32::MAX), Depends("no limit"),
            "the longest path in edges: 1 sees emitters only, 2 adds direct light, 3 one bounce", option("max-depth", "D"));
        CLAMP_INDIRECT: Number = key("clamp_indirect", Number(Limits::AboveTo(0.0, BRIGHTEST)), Depends("no limit"),
            "the most that one path may add to a channel of indirect light: biased");
        LIGHT_CHOICE: Choice<LightChoice> = key("light_choice", Choice::NEW, Is("\"hierarchy\""), "which emitter is sampled at a point");
    }

    pub(in crate::scene) mod ambient_occlusion {
        use super::*;
        keys! {
            DISTANCE: Number = key("distance", LENGTH, Depends("no limit"), "only what is nearer than this occludes a point");
        }
    }

    pub(in crate::scene) mod paper {
        use super::*;
        keys! {
            SUBPIXELS: Whole<u32> = key("subpixels", Whole(1..=256), Is("2"), "k: a pixel is k x k sub-pixels");
            SAMPLES: Whole<u32> = key("samples", Whole(1..=u32::MAX), Is("4"), "N: paths of each sub-pixel");
            HEMISPHERE: Choice<Hemisphere> = key("hemisphere", Choice::NEW, Is("\"cosine\""), "how directions are drawn");
            STOP: Choice<StopKind> = key("stop", Choice::NEW, Is("\"roulette\""), "when a path ends");
            THRESHOLD: Number = key("threshold", Number(Limits::AboveTo(0.0, 1.0)), Is("0.01"),
                "with stop = \"threshold\": a path ends when its weight falls below this");
            MISS: Choice<Miss> = key("miss", Choice::NEW, Is("\"background\""), "what becomes of a camera ray that hits nothing");
            JITTER: Number = key("jitter", SHARE, Is("1"), "the size of the random shift in a sub-pixel");
        }
    }

    pub(in crate::scene) mod raycast {
        use super::*;
        keys! {
            SHADOWS: Flag = key("shadows", Flag, Is("false"), "whether emitters cast shadows");
        }
    }
}
