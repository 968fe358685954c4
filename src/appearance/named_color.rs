//! Colours by name, or as `#rrggbb` and `#rgb`.

use crate::color::{Rgb, linear_from_srgb};

/// Names of CSS with their sRGB values.
const NAMED: [(&str, u32); 28] = [
    ("white", 0xff_ffff),
    ("whitesmoke", 0xf5_f5f5),
    ("silver", 0xc0_c0c0),
    ("lightgray", 0xd3_d3d3),
    ("gray", 0x80_8080),
    ("grey", 0x80_8080),
    ("dimgray", 0x69_6969),
    ("black", 0x00_0000),
    ("red", 0xff_0000),
    ("crimson", 0xdc_143c),
    ("tomato", 0xff_6347),
    ("salmon", 0xfa_8072),
    ("coral", 0xff_7f50),
    ("orange", 0xff_a500),
    ("gold", 0xff_d700),
    ("yellow", 0xff_ff00),
    ("khaki", 0xf0_e68c),
    ("olive", 0x80_8000),
    ("green", 0x00_8000),
    ("seagreen", 0x2e_8b57),
    ("teal", 0x00_8080),
    ("turquoise", 0x40_e0d0),
    ("skyblue", 0x87_ceeb),
    ("steelblue", 0x46_82b4),
    ("blue", 0x00_00ff),
    ("navy", 0x00_0080),
    ("purple", 0x80_0080),
    ("orchid", 0xda_70d6),
];

/// The linear Rec. 709 colour with this name or hexadecimal sRGB value.
pub fn named_color(text: &str) -> Option<Rgb> {
    let value = match text.strip_prefix('#') {
        Some(digits) if digits.bytes().all(|b| b.is_ascii_hexdigit()) => match digits.len() {
            6 => u32::from_str_radix(digits, 16).ok()?,
            3 => {
                let short = u32::from_str_radix(digits, 16).ok()?;
                [8, 4, 0].iter().fold(0, |all, bits| (all << 8) | (((short >> bits) & 15) * 17))
            }
            _ => return None,
        },
        Some(_) => return None,
        None => NAMED.iter().find(|(name, _)| name.eq_ignore_ascii_case(text))?.1,
    };
    let [_, srgb @ ..] = value.to_be_bytes();
    Some(Rgb::from_array(srgb.map(|channel| linear_from_srgb(f32::from(channel) / 255.0))))
}

/// The names of all colours.
pub(super) fn color_names() -> impl Iterator<Item = &'static str> {
    NAMED.iter().map(|(name, _)| *name)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::color::srgb_from_linear;

    #[test]
    fn names_and_digits_are_srgb() {
        for (text, expected) in [
            ("white", [255.0; 3]),
            ("SteelBlue", [70.0, 130.0, 180.0]),
            ("#f80", [255.0, 136.0, 0.0]),
            ("#102030", [16.0, 32.0, 48.0]),
        ] {
            let found = named_color(text).unwrap().to_array().map(|c| srgb_from_linear(c) * 255.0);
            for (found, expected) in found.into_iter().zip(expected) {
                assert!((found - expected).abs() < 1e-2, "{text}: {found}");
            }
        }
        for wrong in ["", "#", "#12", "#12345g", "#+12345", "c_pe", "#1234567"] {
            assert_eq!(named_color(wrong), None, "{wrong}");
        }
    }
}
