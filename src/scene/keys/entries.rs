//! The keys of the tables that have no file of their own here, in the order of the manual.

use crate::math::MAX_COORDINATE;
use crate::scene::columns::ColumnValue;
use crate::scene::description::{ColorSpace, ColorStorage, LightPreset, ProjectionKind};
use crate::scene::direction_value::DirectionValue;
use crate::scene::settings::FilterKind;
use crate::scene::value_types::{
    Boolean, COORDINATES as COORDINATE_VECTOR, EnumValue, Integer, ListOf, NonEmptyString, Number,
    NumberRange, Vector,
};

use super::key::DefaultValue::{Derived, Required, Toml};
use super::key::{CliOption, DefaultValue, DynKey, Key, key, key_with_option, keys, option};
use super::limits::{ANGLE, LENGTH, MAX_IMAGE_SIDE, MIN_RADIUS};

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
        WIDTH: Integer<u32> = key("width", Integer(1..=MAX_IMAGE_SIDE), Toml("640"), "width in pixels");
        HEIGHT: Integer<u32> = key("height", Integer(1..=MAX_IMAGE_SIDE), Toml("480"), "height in pixels");
        CROP: ListOf<Integer<u32>> = key_with_option("crop", ListOf(Integer(0..=MAX_IMAGE_SIDE)), Derived("the whole picture"),
            "the part to render: [x0, y0, x1, y1], columns x0 to x1 - 1 and rows y0 to y1 - 1",
            CliOption {
                help: Some("Render only this part of the picture: columns X0 to X1 - 1 and rows Y0 to Y1 - 1"),
                ..option("crop", "X0,Y0,X1,Y1")
            });
        FILTER: EnumValue<FilterKind> = key("filter", EnumValue::NEW, Toml("\"box\""), "the pixel filter");
        FILTER_RADIUS: Number = key("filter_radius", Number(NumberRange::LeftOpen(0.0, 64.0)), Derived("that of the filter"),
            "the radius of the filter, in pixels");
    }
}

/// `[camera]`.
pub(in crate::scene) mod camera {
    use super::*;

    const UNLESS_FITTED: DefaultValue = Derived("required, unless fitted");

    keys! {
        TYPE: EnumValue<ProjectionKind> = key("type", EnumValue::NEW, Toml("\"perspective\""), "the projection");
        FIT: Boolean = key("fit", Boolean, Toml("false"), "places the camera so that it sees all that the scene shows, as large as fits");
        DIRECTION: DirectionValue = key("direction", DirectionValue, Derived("iso"), "with fit: from where the camera looks");
        MARGIN: Number = key("margin", Number(NumberRange::Closed(0.0, 0.49)), Derived("0.05"), "with fit: the share of the picture that stays free on each side");
        RIGHT_MARGIN: Number = key("right_margin", Number(NumberRange::Closed(0.0, 0.49)), Derived("margin, and room for a colour bar or legend of particles"), "with fit: the share of the width that stays free at the right");
        POSITION: Vector = key("position", COORDINATE_VECTOR, UNLESS_FITTED, "the centre of the lens or, for parallel rays, of the image plane");
        LOOK_AT: Vector = key("look_at", COORDINATE_VECTOR, UNLESS_FITTED, "the point in the middle of the picture");
        UP: Vector = key("up", COORDINATE_VECTOR, Toml("[0, 1, 0]"), "the direction that points up in the picture, of any length");
        NEAR: Number = key("near", Number(NumberRange::Closed(0.0, MAX_COORDINATE)), Toml("0"),
            "camera rays start at this depth and ignore everything nearer");
    }

    pub(in crate::scene) mod perspective {
        use super::*;
        keys! {
            FOV: Number = key("vertical_fov_degrees", Number(NumberRange::Open(0.0, 180.0)), Toml("36"),
                "the vertical field of view");
            APERTURE_RADIUS: Number = key("aperture_radius", Number(NumberRange::Closed(0.0, MAX_COORDINATE)), Toml("0"),
                "the radius of the aperture, in scene units; 0 is a pinhole");
            F_NUMBER: Number = key("f_number", Number(NumberRange::LeftOpen(0.0, 1e6)), Derived("none"),
                "instead of aperture_radius: that of a lens in front of a film 24 mm high");
            METERS_PER_UNIT: Number = key("meters_per_unit", Number(NumberRange::LeftOpen(0.0, 1e30)), Derived("1"),
                "with f_number: the length of a scene unit in metres");
            FOCUS_DISTANCE: Number = key("focus_distance", LENGTH, Derived("that of look_at"),
                "the distance from the lens to the plane in focus, along the view axis");
            FOCUS_ON: NonEmptyString = key("focus_on", NonEmptyString, Derived("none"), "instead of focus_distance: the name of a sphere to focus on, or \"TABLE:ROW\"");
            FOCUS_ON_PIXEL: ListOf<Integer<u32>> = key("focus_on_pixel", ListOf(Integer(0..=MAX_IMAGE_SIDE)), Derived("none"),
                "instead of focus_distance: focuses on what this pixel shows");
            BLADES: Integer<u32> = key("blades", Integer(0..=64), Toml("0"), "the number of corners of the aperture; 0 is a disk");
            ROTATION: Number = key("rotation_degrees", ANGLE, Toml("0"), "rotates the aperture counterclockwise");
        }
    }

    pub(in crate::scene) mod orthographic {
        use super::*;
        keys! {
            HEIGHT: Number = key("height", LENGTH, Derived("what 36 degrees show at look_at"), "the height of the visible area, in scene units");
        }
    }

    pub(in crate::scene) mod panoramic {
        use super::*;
        keys! {
            HORIZONTAL: Number = key("horizontal_extent_degrees", Number(NumberRange::LeftOpen(0.0, 360.0)), Toml("360"),
                "the horizontal extent of the picture");
            VERTICAL: Number = key("vertical_extent_degrees", Number(NumberRange::LeftOpen(0.0, 180.0)), Toml("180"),
                "the vertical extent of the picture");
        }
    }
}

/// `[light]`.
pub(in crate::scene) mod light {
    use super::*;
    keys! {
        PRESET: EnumValue<LightPreset> = key("preset", EnumValue::NEW, Required, "light that suits most scenes, beside the camera");
        STRENGTH: Number = key("strength", Number(NumberRange::LeftOpen(0.0, 1e6)), Derived("1"), "multiplies its radiance");
    }
}

/// `[[spheres]]`.
pub(in crate::scene) mod sphere {
    use super::*;
    keys! {
        NAME: NonEmptyString = key("name", NonEmptyString, Derived("none"), "used in messages and to address the sphere");
        CENTER: Vector = key("center", COORDINATE_VECTOR, Required, "the centre");
        RADIUS: Number = key("radius", Number(NumberRange::Closed(MIN_RADIUS, MAX_COORDINATE)), Required, "the radius");
        MATERIAL: NonEmptyString = key("material", NonEmptyString, Required, "the name of a material");
        SHADOW_CATCHER: Boolean = key("shadow_catcher", Boolean, Toml("false"), "whether the camera sees only the shadow that others cast on it");
    }
}

/// `[[sphere_tables]]`.
pub(in crate::scene) mod table {
    use super::*;
    keys! {
        FILE: NonEmptyString = key("file", NonEmptyString, Required, "a file of raw little-endian rows, or a NumPy file (.npy)");
        NAME: NonEmptyString = key("name", NonEmptyString, Derived("the name of the file"), "used in the layers of Cryptomatte and to address the table");
        COLUMNS: ListOf<ColumnValue> = key("columns", ListOf(ColumnValue), Derived("the names of the fields"),
            "the meaning and type of each number in a row; may be left out for a NumPy file of records");
        MATERIAL: NonEmptyString = key("material", NonEmptyString, Required, "the name of a material");
        COLORS: EnumValue<ColorStorage> = key("colors", EnumValue::NEW, Toml("\"exact\""), "how colours are stored in memory");
        COLOR_SPACE: EnumValue<ColorSpace> = key("color_space", EnumValue::NEW, Toml("\"linear\""), "whether the columns r, g and b are linear, or sRGB as on screens");
        OFFSET: Vector = key("offset", COORDINATE_VECTOR, Toml("[0, 0, 0]"), "added to each centre, in f64");
        SKIP_ROWS: Integer<i64> = key("skip_rows", Integer(0..=i64::MAX), Toml("0"), "rows to skip at the beginning");
        SKIP_BYTES: Integer<i64> = key("skip_bytes", Integer(0..=i64::MAX), Toml("0"), "bytes before the first row of a raw file");
    }
}
