//! Digits of measured figures.

/// Formats three significant digits.
pub(super) fn significant(value: f64) -> String {
    let digits = if value > 0.0 { 2 - libm::log10(value).floor() as i32 } else { 0 };
    format!("{value:.*}", digits.clamp(0, 9) as usize)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_have_three_digits() {
        let visible = [0.0, 0.001_234, 9.876, 123.4, 98_765.0].map(significant);
        assert_eq!(visible, ["0", "0.00123", "9.88", "123", "98765"]);
    }
}
