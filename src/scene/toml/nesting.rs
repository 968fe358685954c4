//! Bounds how deeply a TOML text nests tables and lists, before it is parsed: parsing and freeing
//! values takes stack for each level. A scene needs four.

/// Maximum number of nested tables and lists.
pub(super) const MAX_DEPTH: usize = 64;

/// Returns the position at which a text nests more than [`MAX_DEPTH`] tables and lists, if any. The
/// parts of a dotted key count, too.
pub(super) fn too_deep(text: &str) -> Option<usize> {
    let bytes = text.as_bytes();
    // For each open bracket, the levels of the dotted key in front of it.
    let mut open: Vec<usize> = Vec::new();
    let (mut dots, mut depth, mut at) = (0, 0, 0);
    while let Some(&byte) = bytes.get(at) {
        match byte {
            b'#' => at = line_end(bytes, at),
            b'"' | b'\'' => at = string_end(bytes, at),
            b'.' => (dots, depth) = (dots + 1, depth + 1),
            b'[' | b'{' => {
                open.push(dots);
                (dots, depth) = (0, depth + 1);
            }
            b']' | b'}' => {
                if let Some(before) = open.pop() {
                    depth -= dots + 1;
                    dots = before;
                }
            }
            b',' | b'\n' => {
                depth -= dots;
                dots = 0;
            }
            _ => {}
        }
        if depth > MAX_DEPTH {
            return Some(at);
        }
        at += 1;
    }
    None
}

/// The position of the line break at or after `at`, or of the last byte.
fn line_end(bytes: &[u8], at: usize) -> usize {
    let rest = bytes[at..].iter().position(|&byte| byte == b'\n');
    // The line break itself still ends the key.
    rest.map_or(bytes.len(), |length| at + length - 1)
}

/// The position of the last quote of the string that starts at `at`. A string of one line ends with
/// its line, even if its quote is missing.
fn string_end(bytes: &[u8], start: usize) -> usize {
    let quote = bytes[start];
    let is_long = bytes[start..].starts_with(&[quote; 3]);
    let mut at = start + if is_long { 3 } else { 1 };
    while let Some(&byte) = bytes.get(at) {
        match byte {
            b'\\' if quote == b'"' => at += 1,
            b'\n' if !is_long => return at - 1,
            _ if byte == quote && !is_long => return at,
            _ if byte == quote && bytes[at..].starts_with(&[quote; 3]) => return at + 2,
            _ => {}
        }
        at += 1;
    }
    bytes.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_way_to_nest_counts() {
        let ways = [("[", "]"), ("{a=", "}"), ("[{b.c=", "}]"), ("{'a.\\'.\"b\\\".\" = [", "]}")];
        for (open, close) in ways {
            let levels = open.matches(['[', '{']).count()
                + usize::from(open.contains("b.c"))
                + usize::from(open.contains("'."));
            let nested =
                |times: usize| format!("a = {}{}\n", open.repeat(times), close.repeat(times));
            let most = MAX_DEPTH / levels;
            assert_eq!(too_deep(&nested(most)), None, "{open}");
            assert!(too_deep(&nested(most + 1)).is_some(), "{open}");
            assert!(too_deep(&nested(100_000)).is_some(), "{open}");
        }
        for (key, value) in [("a", " = 1"), ("[a", "]"), ("[[a", "]]")] {
            let dotted = |dots: usize| format!("{key}{}{value}\n", ".a".repeat(dots));
            assert_eq!(too_deep(&dotted(MAX_DEPTH - 2)), None, "{key}");
            assert!(too_deep(&dotted(MAX_DEPTH + 1)).is_some(), "{key}");
        }
    }

    #[test]
    fn long_lists_comments_and_strings_are_not_deep() {
        let list = format!("a = [{}]\n", "[0.5, -1.25e3], ".repeat(1000));
        let lines = "[a.b]\nc.d = 0.5 # [[[[ ....\n".repeat(1000);
        let strings = format!("a = '{0}'\nb = \"\\\"{0}\"\n", "[.{".repeat(100));
        let long = format!("a = '''{0}\n'{0}'''\nb = \"\"\"\\\"\"\"{0}\"\"\"\n", "[{.".repeat(100));
        for text in [list, lines, strings, long, "# [".to_owned(), "\"[".to_owned()] {
            assert_eq!(too_deep(&text), None, "{}", &text[..20.min(text.len())]);
        }
        assert!(too_deep(&format!("a = '' # '\n b = {}", "[".repeat(100))).is_some());
    }
}
