//! The keys of `[[particles]]`.

use crate::appearance::{Appearance, ColorMap};
use crate::particles::Format;
use crate::scene::description::ColorStorage;
use crate::scene::value_types::{
    Boolean, EnumValue, Integer, ListOf, NonEmptyString, Number, NumberRange, TextOrNumber,
};

use super::key::DefaultValue::{Derived, Required, Toml};
use super::key::{CliOption, DynKey, Key, KeyVisitor, key, key_with_option, keys, option};
use super::limits::{LENGTH, MAX_RADIANCE, UNIT_INTERVAL};

keys! {
    FILE: NonEmptyString = key("file", NonEmptyString, Required, "a file of particles, in a format of other programs");
    NAME: NonEmptyString = key("name", NonEmptyString, Derived("the name of the file"), "used in the layers of Cryptomatte and to address the particles");
    MATERIAL: NonEmptyString = key("material", NonEmptyString, Required, "the name of a material; the particles replace its colour");
    COLORS: EnumValue<ColorStorage> = key("colors", EnumValue::NEW, Toml("\"packed\""), "how colours are stored in memory");
    FORMAT: EnumValue<Format> = key_with_option("format", EnumValue::NEW, Derived("by content"), "the format of the file", option("input-format", "NAME"));
    FRAME: Integer<i64> = key_with_option("frame", Integer(i64::MIN..=i64::MAX), Toml("0"), "the frame: 0 is the first, -1 the last", option("frame", "N"));
    COLUMNS: TextOrNumber = key_with_option("columns", TextOrNumber, Derived("as the file says"),
        "names for the columns of a file that names none, such as \"x,y,z,radius\"; _ leaves one out", option("columns", "LIST"));
    TOPOLOGY: NonEmptyString = key_with_option("topology", NonEmptyString, Derived("none"), "the file with names and types for a trajectory without", option("topology", "FILE"));
    SELECT: TextOrNumber = key_with_option("select", TextOrNumber, Derived("all"), "a condition, such as \"type == 2 && z < 10\": other particles are left out", option("select", "EXPR"));
    SLICE: TextOrNumber = key_with_option("slice", TextOrNumber, Derived("none"), "a condition: particles that fulfil it are hidden, and the view stays", option("slice", "EXPR"));
    RADIUS: TextOrNumber = key_with_option("radius", TextOrNumber, Toml("\"auto\""), "auto, spacing, vdw, covalent, a number, a column or an expression", option("radius", "WHAT"));
    RADIUS_SCALE: Number = key_with_option("radius_scale", LENGTH, Toml("1"), "multiplies all radii", option("radius-scale", "X"));
    COLOR: TextOrNumber = key_with_option("color", TextOrNumber, Toml("\"auto\""), "auto, element, type, rgb, position, a colour, a column or an expression; \"auto:gold\" is gold where auto finds nothing", option("color", "WHAT"));
    COLORMAP: EnumValue<ColorMap> = key_with_option("colormap", EnumValue::NEW, Toml("\"viridis\""), "the colour map for numbers", option("colormap", "NAME"));
    RANGE: TextOrNumber = key_with_option("range", TextOrNumber, Toml("\"p0,p100\""), "the numbers at the ends of the map: \"LO,HI\", each a number or a percentile such as p1", option("range", "LO,HI"));
    LOG: Boolean = key_with_option("log", Boolean, Toml("false"), "whether the map goes with the logarithm", CliOption { help: Some("Map the logarithm of the numbers"), ..option("log", "") });
    WRAP: Boolean = key_with_option("wrap", Boolean, Toml("false"), "whether particles move to their periodic images in the cell", CliOption { help: Some("Move particles to their periodic images in the cell"), ..option("wrap", "") });
    UNWRAP: Boolean = key_with_option("unwrap", Boolean, Toml("false"), "whether image flags undo periodic boundaries", CliOption { help: Some("Undo periodic boundaries with the image flags ix, iy and iz"), ..option("unwrap", "") });
    CENTER: Boolean = key_with_option("center", Boolean, Toml("false"), "whether the middle of the particles moves to that of the cell, or to the origin", CliOption { help: Some("Move the middle of the particles to that of the cell, or to the origin"), ..option("center", "") });
    REPLICATE: ListOf<Integer<u32>> = key_with_option("replicate", ListOf(Integer(1..=1000)), Toml("[1, 1, 1]"), "periodic copies along each edge of the cell",
        CliOption { help: Some("Periodic copies along each edge of the cell, such as 3,3,1"), ..option("replicate", "A,B,C") });
    GLOW: Number = key_with_option("glow", Number(NumberRange::Closed(0.0, MAX_RADIANCE)), Toml("0"), "the emission of a white particle, in W/(sr m^2); others emit their colour times it", option("glow", "L"));
    SHADE: Number = key("shade", UNIT_INTERVAL, Toml("1"), "the share of the colours that is reflected");
    CELL: Boolean = key_with_option("cell", Boolean, Toml("false"), "whether the edges of the cell are drawn", CliOption { help: Some("Draw the edges of the cell"), ..option("cell", "") });
}

/// Visits the keys whose values depend on no other key.
pub(in crate::scene) fn visit_keys(of: &mut Appearance, visitor: &mut impl KeyVisitor) {
    visitor.visit_option(&SELECT, &mut of.select);
    visitor.visit_option(&SLICE, &mut of.slice);
    visitor.visit(&RADIUS_SCALE, &mut of.radius_scale);
    visitor.visit(&COLORMAP, &mut of.colormap);
    visitor.visit(&LOG, &mut of.log);
    visitor.visit(&WRAP, &mut of.wrap);
    visitor.visit(&UNWRAP, &mut of.unwrap);
    visitor.visit(&CENTER, &mut of.center);
    visitor.visit(&GLOW, &mut of.glow);
    visitor.visit(&SHADE, &mut of.shade);
    visitor.visit(&CELL, &mut of.cell);
}
