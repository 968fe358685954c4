//! Colours for categories.

use std::sync::LazyLock;

use crate::color::{Rgb, linear_from_srgb};

/// Ten colours that are told apart, also by most people with colour vision deficiencies: Petroff
/// 2021, "Accessible color sequences for data visualization", with a lighter grey.
const COLORS: [[u8; 3]; 10] = [
    [63, 144, 218],
    [255, 169, 14],
    [189, 31, 1],
    [148, 164, 162],
    [131, 45, 182],
    [169, 107, 89],
    [231, 99, 0],
    [185, 172, 112],
    [113, 117, 129],
    [146, 218, 221],
];

/// The colour of a category in linear Rec. 709. After ten, the colours repeat.
pub fn palette(index: usize) -> Rgb {
    LINEAR[index % COLORS.len()]
}

/// The colours in linear Rec. 709, computed once for all particles.
static LINEAR: LazyLock<[Rgb; COLORS.len()]> = LazyLock::new(|| {
    COLORS.map(|srgb| Rgb::from_array(srgb.map(|value| linear_from_srgb(f32::from(value) / 255.0))))
});
