//! Breaks the long lines of a path's description.

/// Columns of a terminal.
const WIDTH: usize = 80;

/// Breaks each line longer than a terminal at the last comma, semicolon, plus or remark outside of
/// brackets that fits, never between a symbol and its value; what follows is indented further.
pub(super) fn fold(text: &str) -> String {
    let mut folded = String::with_capacity(text.len() + text.len() / 16);
    for line in text.lines() {
        let indent = line.len() - line.trim_start_matches([' ', '+']).len() + 2;
        let mut rest = line.to_owned();
        while let Some(at) = break_of(&rest, indent) {
            folded += rest[..at].trim_end();
            folded.push('\n');
            rest = " ".repeat(indent) + rest[at..].trim_start();
        }
        folded += &rest;
        folded.push('\n');
    }
    folded
}

/// Where a line that is too long is broken: a byte after its indent.
fn break_of(line: &str, indent: usize) -> Option<usize> {
    if line.chars().count() <= WIDTH {
        return None;
    }
    let (mut depth, mut found) = (0, None);
    let mut before = [' '; 2];
    for (column, (at, c)) in line.char_indices().enumerate() {
        if column > WIDTH {
            break;
        }
        let is_free = depth == 0 && at > indent;
        match (before, c) {
            ([_, ',' | ';' | ':'], ' ') | ([_, ' '], '+') | ([')', ' '], '(') if is_free => {
                found = Some(at);
            }
            _ => {}
        }
        match c {
            '(' => depth += 1,
            ')' => depth -= 1,
            _ => {}
        }
        before = [before[1], c];
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_lines_are_broken_outside_of_brackets() {
        let number = "(0.123456, 0.123456, 0.123456)";
        let line =
            format!("   + T f_r |cos| L_e w / p = {number}, {number} (direct), more: {number}");
        let folded = fold(&line);
        assert!(folded.lines().all(|line| line.len() <= WIDTH), "{folded}");
        assert!(folded.lines().skip(1).all(|line| line.starts_with("       ")), "{folded}");
        let joined: Vec<&str> = folded.split_whitespace().collect();
        assert_eq!(joined, line.split_whitespace().collect::<Vec<_>>());
        let line = format!("     n = {number}, w_o = {number}, T = (1, 1, 1)");
        assert!(fold(&line).ends_with(",\n       T = (1, 1, 1)\n"), "{}", fold(&line));
        assert_eq!(fold("short\n\nlines\n"), "short\n\nlines\n");
    }
}
