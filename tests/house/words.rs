//! How comments are written: a doc comment stands alone, because a reader meets it without its
//! neighbours, and lines fit a screen.

use super::layers::{line_of, sources_in};

/// Words that point at something that a reader of one doc comment does not see.
const POINTERS: [&str; 5] = ["The same", "It ", "They ", "Its ", "Whether "];

/// Columns of a line of comment.
const WIDTH: usize = 100;

/// The folders with code.
const FOLDERS: [&str; 6] = ["src", "tests", "benches", "examples", "fuzz/src", "python/src"];

#[test]
fn doc_comments_stand_alone() {
    let mut found = Vec::new();
    for (file, code) in FOLDERS.into_iter().flat_map(sources_in) {
        let begins = beginnings(&code).into_iter();
        let pointing = begins.filter(|(_, text)| POINTERS.iter().any(|p| text.starts_with(p)));
        found.extend(pointing.map(|(line, text)| format!("{file}:{line}: {text}")));
    }
    assert!(found.is_empty(), "these begin with {POINTERS:?}:\n{}", found.join("\n"));
}

#[test]
fn comments_wrap() {
    let mut found = Vec::new();
    for (file, code) in FOLDERS.into_iter().flat_map(sources_in) {
        let long = code.lines().enumerate().filter(|(_, line)| is_long_comment(line));
        found.extend(long.map(|(at, _)| format!("{file}:{}", at + 1)));
    }
    assert!(found.is_empty(), "comments beyond column {WIDTH}:\n{}", found.join("\n"));
}

#[test]
fn both_are_found() {
    let code = "/// One.\n/// It is two.\nfn a() {}\n\n/// It is three.\nfn b() {}\n//! The same.";
    let texts: Vec<_> = beginnings(code);
    assert_eq!(texts, [(1, "One."), (5, "It is three."), (7, "The same.")]);
    let long = format!("    // {}", "word ".repeat(20));
    assert!(is_long_comment(&long) && !is_long_comment(&long.replace("//", "  ")));
    let link = format!("//! <https://{}>", "a".repeat(100));
    assert!(!is_long_comment(&link), "what cannot be broken may be long");
    assert_eq!(line_of("a\nb", 2), 2);
}

/// The first line of each doc comment, with its number.
fn beginnings(code: &str) -> Vec<(usize, &str)> {
    let doc = |line: &str| {
        let line = line.trim_start();
        line.starts_with("/// ") || line.starts_with("//! ")
    };
    let lines: Vec<&str> = code.lines().collect();
    let is_first = |at: usize| {
        let before = at.checked_sub(1).map_or("", |before| lines[before].trim_start());
        doc(lines[at]) && !before.starts_with("///") && !before.starts_with("//!")
    };
    let firsts = (0..lines.len()).filter(|at| is_first(*at));
    firsts.map(|at| (at + 1, &lines[at].trim_start()[4..])).collect()
}

fn is_long_comment(line: &str) -> bool {
    let text = line.trim_start();
    let has_gap = text.trim_start_matches('/').trim_start_matches('!').trim().contains(' ');
    text.starts_with("//") && line.chars().count() > WIDTH && has_gap
}
