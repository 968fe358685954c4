//! Colour spaces of FLIP: the linear opponent space YyCxCz (Flohr et al. 1993), used for blurring,
//! and L*a*b* with the Hunt effect, used for comparing colours.

use glam::DMat3;

use crate::math::DVec3;

/// XYZ of the Rec. 709 red, green and blue primaries with white D65, column by column.
const XYZ: DMat3 = DMat3::from_cols_array(&[
    10135552.0 / 24577794.0,
    2613072.0 / 12288897.0,
    1425312.0 / 73733382.0,
    8788810.0 / 24577794.0,
    8788810.0 / 12288897.0,
    8788810.0 / 73733382.0,
    4435075.0 / 24577794.0,
    887015.0 / 12288897.0,
    70074185.0 / 73733382.0,
]);

/// XYZ relative to white.
fn relative_xyz(linear: DVec3) -> DVec3 {
    XYZ * linear / (XYZ * DVec3::ONE)
}

/// Converts linear Rec. 709 to YyCxCz: L*a*b* without the cube root.
pub(super) fn opponent(linear: DVec3) -> DVec3 {
    spread(relative_xyz(linear))
}

/// Converts YyCxCz to linear Rec. 709.
pub(super) fn from_opponent(opponent: DVec3) -> DVec3 {
    let y = (opponent.x + 16.0) / 116.0;
    let relative = DVec3::new(y + opponent.y / 500.0, y, y - opponent.z / 200.0);
    XYZ.inverse() * (relative * (XYZ * DVec3::ONE))
}

/// Converts linear Rec. 709 to CIE L*a*b* with a and b scaled by lightness: dark colours look less
/// colourful (Hunt 1952).
pub(super) fn hunt_lab(linear: DVec3) -> DVec3 {
    let lab = spread(relative_xyz(linear).map(lightness));
    let hunt = 0.01 * lab.x;
    DVec3::new(lab.x, hunt * lab.y, hunt * lab.z)
}

/// HyAB distance, suited to large colour differences (Abasi et al. 2020).
pub(super) fn hyab(a: DVec3, b: DVec3) -> f64 {
    let d = a - b;
    d.x.abs() + libm::hypot(d.y, d.z)
}

fn spread(v: DVec3) -> DVec3 {
    DVec3::new(116.0 * v.y - 16.0, 500.0 * (v.x - v.y), 200.0 * (v.y - v.z))
}

fn lightness(t: f64) -> f64 {
    const DELTA: f64 = 6.0 / 29.0;
    if t > DELTA * DELTA * DELTA { libm::cbrt(t) } else { t / (3.0 * DELTA * DELTA) + 4.0 / 29.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_opponent_space_is_undone_and_white_is_white() {
        let color = DVec3::new(0.1, 0.7, 0.3);
        assert!((from_opponent(opponent(color)) - color).length() < 1e-12);
        assert!((hunt_lab(DVec3::ONE) - DVec3::new(100.0, 0.0, 0.0)).length() < 1e-9);
        // L*a*b* of the blue primary is (32.30, 79.19, -107.86) (Lindbloom's calculator).
        let blue = hunt_lab(DVec3::Z);
        assert!((blue - DVec3::new(32.30, 0.3230 * 79.19, -0.3230 * 107.86)).length() < 0.02);
    }
}
