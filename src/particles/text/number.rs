//! Numbers in bytes.

/// Longest number that may need to be rewritten before it is parsed.
const LONGEST: usize = 64;

/// The nearest f64 of a decimal number; also `nan`, `inf`, and exponents of Fortran (`1.5D+02`).
#[inline]
pub(in crate::particles) fn float(token: &[u8]) -> Option<f64> {
    fast_float2::parse(token).ok().or_else(|| with_replaced(token, b"dD", b'e'))
}

/// Like [`float`], with a comma for the decimal point.
pub(in crate::particles) fn float_with_comma(token: &[u8]) -> Option<f64> {
    if token.contains(&b',') { with_replaced(token, b",", b'.') } else { float(token) }
}

/// An integer that fits into 64 bits.
#[inline]
pub(in crate::particles) fn integer(token: &[u8]) -> Option<i64> {
    let (is_negative, digits) = match token {
        [b'-', digits @ ..] => (true, digits),
        [b'+', digits @ ..] => (false, digits),
        digits => (false, digits),
    };
    if digits.is_empty() || digits.len() > 18 {
        return std::str::from_utf8(token).ok()?.parse().ok();
    }
    let mut value = 0i64;
    for &digit in digits {
        let digit = digit.wrapping_sub(b'0');
        if digit > 9 {
            return None;
        }
        value = value * 10 + i64::from(digit);
    }
    Some(if is_negative { -value } else { value })
}

/// Returns true for what stands for a missing number.
pub(in crate::particles) fn is_missing(token: &[u8]) -> bool {
    const WORDS: [&[u8]; 8] = [b"", b"NA", b"N/A", b"null", b"NULL", b"None", b".", b"?"];
    WORDS.contains(&token)
}

/// The parts of a line between white space.
pub(in crate::particles) fn tokens(line: &[u8]) -> impl Iterator<Item = &[u8]> {
    line.split(|&byte| byte <= b' ').filter(|token| !token.is_empty())
}

fn with_replaced(token: &[u8], any: &[u8], by: u8) -> Option<f64> {
    let mut copy = [0; LONGEST];
    let copy = copy.get_mut(..token.len())?;
    for (to, &from) in copy.iter_mut().zip(token) {
        *to = if any.contains(&from) { by } else { from };
    }
    fast_float2::parse(copy).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_those_that_the_text_says() {
        for (text, value) in [
            ("1", 1.0),
            ("-0.1", -0.1),
            ("+2.5e-3", 2.5e-3),
            ("1.5D+02", 150.0),
            ("1.5d-2", 0.015),
            ("1e400", f64::INFINITY),
            ("0.1000000000000000055511151231257827", 0.1),
            (".5", 0.5),
            ("5.", 5.0),
        ] {
            assert_eq!(float(text.as_bytes()), Some(value), "{text}");
        }
        assert!(float(b"NaN").is_some_and(f64::is_nan));
        for text in ["", "-", "1,5", "1.0x", "0x10", "1 2", "D", "abc", "--1"] {
            assert_eq!(float(text.as_bytes()), None, "{text}");
        }
        assert_eq!(float_with_comma(b"-1,25e1"), Some(-12.5));
        assert_eq!(float_with_comma(b"1,2,3"), None);
    }

    #[test]
    fn integers_fit_or_are_none() {
        for text in ["0", "-12", "+7", "9223372036854775807", "-9223372036854775808"] {
            assert_eq!(integer(text.as_bytes()), text.parse().ok(), "{text}");
        }
        for text in ["", "-", "1.0", "9223372036854775808", "1e3", "12a"] {
            assert_eq!(integer(text.as_bytes()), None, "{text}");
        }
    }
}
