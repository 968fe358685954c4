//! Makes text from elsewhere safe to print.
//!
//! File names, metadata and excerpts may hold any character. Control characters among them would
//! command the terminal, and bidirectional overrides would reorder what it shows, so both are
//! replaced by their escapes.

use std::borrow::Cow;
use std::fmt::Write;

/// Escapes control characters and bidirectional formatting as `\u{1b}`; line breaks and tabs stay.
pub fn printable(text: &str) -> Cow<'_, str> {
    escape(text, |c| is_active(c) && !matches!(c, '\n' | '\t'))
}

/// Like [`printable`], and escapes line breaks and tabs as well: the result is one line.
pub fn printable_line(text: &str) -> Cow<'_, str> {
    escape(text, is_active)
}

/// Escapes what [`printable`] escapes in a JSON text. All of it is within strings, where the
/// escapes mean the characters themselves.
pub fn printable_json(text: &str) -> String {
    let mut safe = String::with_capacity(text.len());
    for c in text.chars() {
        if is_active(c) && !matches!(c, '\n' | '\t') {
            // Every such character is in the basic plane.
            let _ = write!(safe, "\\u{:04x}", u32::from(c));
        } else {
            safe.push(c);
        }
    }
    safe
}

/// Returns true for characters that do something instead of being shown: C0, DEL, C1, and the
/// marks, embeddings, overrides and isolates of the bidirectional algorithm.
fn is_active(c: char) -> bool {
    c.is_control()
        || matches!(
            c,
            '\u{61c}'
                | '\u{200e}'
                | '\u{200f}'
                | '\u{2028}'..='\u{202e}'
                | '\u{2066}'..='\u{2069}'
        )
}

fn escape(text: &str, is_escaped: impl Fn(char) -> bool) -> Cow<'_, str> {
    if !text.contains(&is_escaped) {
        return Cow::Borrowed(text);
    }
    let mut safe = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            _ if !is_escaped(c) => safe.push(c),
            '\n' | '\r' | '\t' => safe.extend(c.escape_default()),
            _ => safe.extend(c.escape_unicode()),
        }
    }
    Cow::Owned(safe)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_that_acts_on_a_terminal_is_left() {
        let hostile = "a\u{1b}[31m\u{7}\r\u{7f}\u{9b}1m\u{202e}\u{2066}\u{200f}b\n\tc";
        let shown = r"a\u{1b}[31m\u{7}\r\u{7f}\u{9b}1m\u{202e}\u{2066}\u{200f}b";
        assert_eq!(printable(hostile), format!("{shown}\n\tc"));
        assert_eq!(printable_line(hostile), format!(r"{shown}\n\tc"));
        let plain = "Grün, 緑, \u{1f7e2}";
        assert!(matches!(printable_line(plain), Cow::Borrowed(text) if text == plain));
    }

    #[test]
    fn json_means_the_same_text() {
        let hostile = "a\u{1b}\u{7f}\u{9b}\u{202e}\n";
        let json = printable_json(&serde_json::to_string(hostile).unwrap());
        assert_eq!(json, r#""a\u001b\u007f\u009b\u202e\n""#);
        assert_eq!(serde_json::from_str::<String>(&json).unwrap(), hostile);
    }
}
