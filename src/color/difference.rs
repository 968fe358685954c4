//! How different two colours look: CIEDE2000 (Sharma, Wu and Dalal 2005).

use super::Rgb;

/// A colour in CIELAB, relative to D65.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Lab {
    l: f64,
    a: f64,
    b: f64,
}

impl Lab {
    /// From linear Rec. 709, white being 1.
    fn from_linear(color: Rgb) -> Self {
        let [r, g, b] = color.to_array().map(f64::from);
        // The matrix of Rec. 709, divided by the white point.
        let x = (0.412_456_4 * r + 0.357_576_1 * g + 0.180_437_5 * b) / 0.950_47;
        let y = 0.212_672_9 * r + 0.715_152_2 * g + 0.072_175 * b;
        let z = (0.019_333_9 * r + 0.119_192 * g + 0.950_304_1 * b) / 1.088_83;
        let f = |t: f64| {
            if t > 216.0 / 24_389.0 { libm::cbrt(t) } else { (24_389.0 / 27.0 * t + 16.0) / 116.0 }
        };
        let [x, y, z] = [x, y, z].map(f);
        Self { l: 116.0 * y - 16.0, a: 500.0 * (x - y), b: 200.0 * (y - z) }
    }
}

/// The CIEDE2000 difference of two colours in linear Rec. 709, of which white is 1. About 1 is just
/// noticeable.
pub fn ciede2000(first: Rgb, second: Rgb) -> f64 {
    difference(Lab::from_linear(first), Lab::from_linear(second))
}

fn difference(first: Lab, second: Lab) -> f64 {
    let pow7 = |x: f64| libm::pow(x, 7.0);
    let chroma = |lab: Lab| lab.a.hypot(lab.b);
    let mean_chroma = 0.5 * (chroma(first) + chroma(second));
    let c7 = pow7(mean_chroma);
    let g = 0.5 * (1.0 - (c7 / (c7 + pow7(25.0))).sqrt());
    let primed = |lab: Lab| {
        let a = (1.0 + g) * lab.a;
        let hue = libm::atan2(lab.b, a).to_degrees().rem_euclid(360.0);
        (a.hypot(lab.b), if a == 0.0 && lab.b == 0.0 { 0.0 } else { hue })
    };
    let ((c1, h1), (c2, h2)) = (primed(first), primed(second));
    let is_grey = c1 * c2 == 0.0;
    let turn = match h2 - h1 {
        _ if is_grey => 0.0,
        turn if turn > 180.0 => turn - 360.0,
        turn if turn < -180.0 => turn + 360.0,
        turn => turn,
    };
    let (dl, dc) = (second.l - first.l, c2 - c1);
    let dh = 2.0 * (c1 * c2).sqrt() * libm::sin(0.5 * turn.to_radians());
    let (l, c) = (0.5 * (first.l + second.l), 0.5 * (c1 + c2));
    let h = match (h1 - h2).abs() {
        _ if is_grey => h1 + h2,
        apart if apart <= 180.0 => 0.5 * (h1 + h2),
        _ if h1 + h2 < 360.0 => 0.5 * (h1 + h2 + 360.0),
        _ => 0.5 * (h1 + h2 - 360.0),
    };
    let cos = |degrees: f64| libm::cos(degrees.to_radians());
    let t = 1.0 - 0.17 * cos(h - 30.0) + 0.24 * cos(2.0 * h) + 0.32 * cos(3.0 * h + 6.0)
        - 0.20 * cos(4.0 * h - 63.0);
    let squared = |x: f64| x * x;
    let theta = 30.0 * libm::exp(-squared((h - 275.0) / 25.0));
    let rc = 2.0 * (pow7(c) / (pow7(c) + pow7(25.0))).sqrt();
    let sl = 1.0 + 0.015 * squared(l - 50.0) / (20.0 + squared(l - 50.0)).sqrt();
    let (sc, sh) = (1.0 + 0.045 * c, 1.0 + 0.015 * c * t);
    let rt = -libm::sin((2.0 * theta).to_radians()) * rc;
    let (l, c, h) = (dl / sl, dc / sc, dh / sh);
    (l * l + c * c + h * h + rt * c * h).max(0.0).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rows of the table of Sharma, Wu and Dalal.
    #[test]
    fn published_pairs_have_their_difference() {
        for (first, second, expected) in [
            ([50.0, 2.6772, -79.7751], [50.0, 0.0, -82.7485], 2.0425),
            ([50.0, -1.3802, -84.2814], [50.0, 0.0, -82.7485], 1.0000),
            ([50.0, 0.0, 0.0], [50.0, -1.0, 2.0], 2.3669),
            ([50.0, 2.49, -0.001], [50.0, -2.49, 0.0009], 7.1792),
            ([50.0, 2.49, -0.001], [50.0, -2.49, 0.0011], 7.2195),
            ([50.0, 2.5, 0.0], [73.0, 25.0, -18.0], 27.1492),
            ([60.2574, -34.0099, 36.2677], [60.4626, -34.1751, 39.4387], 1.2644),
            ([22.7233, 20.0904, -46.694], [23.0331, 14.973, -42.5619], 2.0373),
            ([2.0776, 0.0795, -1.135], [0.9033, -0.0636, -0.5514], 0.9082),
        ] {
            let lab = |[l, a, b]: [f64; 3]| Lab { l, a, b };
            let found = difference(lab(first), lab(second));
            assert!((found - expected).abs() < 1e-4, "{first:?} {second:?}: {found}");
        }
    }

    #[test]
    fn white_is_white_and_equal_colours_do_not_differ() {
        let white = Lab::from_linear(Rgb::ONE);
        assert!((white.l - 100.0).abs() < 1e-3 && white.a.abs() < 0.01 && white.b.abs() < 0.01);
        assert_eq!(ciede2000(Rgb::new(0.1, 0.7, 0.3), Rgb::new(0.1, 0.7, 0.3)), 0.0);
    }
}
