//! Numbers, vectors and colours of a path's description.

use crate::color::Rgb;
use crate::math::DVec3;

pub(super) fn vector(v: DVec3) -> String {
    format!("({}, {}, {})", number(v.x), number(v.y), number(v.z))
}

pub(super) fn color(color: Rgb) -> String {
    vector(color.as_dvec3())
}

/// Formats four significant digits, as short as possible.
pub(super) fn number(value: f64) -> String {
    let size = value.abs();
    if value == 0.0 {
        return "0".to_owned();
    }
    if !(1e-4..1e6).contains(&size) {
        return format!("{value:.3e}");
    }
    let decimals = (3 - libm::log10(size).floor() as i32).max(0) as usize;
    let text = format!("{value:.decimals$}");
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        let shown =
            [0.0, 1.0, -0.5, 12.3456, 123456.7, 1e-7, 0.00123456, f64::INFINITY].map(number);
        assert_eq!(shown, ["0", "1", "-0.5", "12.35", "123457", "1.000e-7", "0.001235", "inf"]);
    }
}
