//! Decodes base64 in which several parts, each with its padding, may follow each other.

/// Decodes up to a character that is none of the alphabet; white space is left out. `most` limits
/// the bytes.
pub(super) fn decode(text: &[u8], most: usize) -> Vec<u8> {
    let mut bytes = Vec::with_capacity((text.len() / 4 * 3).min(most));
    let (mut bits, mut count) = (0u32, 0);
    for &c in text {
        if bytes.len() >= most {
            break;
        }
        let value = match c {
            b'A'..=b'Z' => c - b'A',
            b'a'..=b'z' => c - b'a' + 26,
            b'0'..=b'9' => c - b'0' + 52,
            b'+' => 62,
            b'/' => 63,
            b'=' => {
                // The bits that are left belong to no byte.
                (bits, count) = (0, 0);
                continue;
            }
            c if c.is_ascii_whitespace() => continue,
            _ => break,
        };
        bits = bits << 6 | u32::from(value);
        count += 6;
        if count >= 8 {
            count -= 8;
            bytes.push((bits >> count) as u8);
        }
    }
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_follow_each_other() {
        assert_eq!(decode(b"aGVsbG8=", 100), b"hello");
        assert_eq!(decode(b" aGk=\n aGVsbG8 ", 100), b"hihello");
        assert_eq!(decode(b"QQ==QkM=", 100), b"ABC");
        assert_eq!(decode(b"QUJD<", 2), b"AB");
        assert_eq!(decode(b"", 9), b"");
    }
}
