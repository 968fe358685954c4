//! The street is a test: a room of `src/` imports only rooms that ARCHITECTURE.md lets it use, all
//! that it lets it use, and no file itself through others; only `cli` prints, only `image_io` knows
//! pixels in files, and `unsafe` stays in its few places.
//!
//! The table "room, what lives there, may use" of ARCHITECTURE.md is the rule itself, read from the
//! document, so the two cannot differ. "May use" includes whatever the named rooms may use. This
//! reads text, not syntax trees: it knows comments, `use crate::` with and without braces, paths
//! written out, and `super::` chains that leave a room.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

mod files;

/// For each room, every room that it may use, directly or through others.
type Rules = BTreeMap<String, BTreeSet<String>>;

const HEADER: &str = "| room | what lives there | may use |";

#[test]
fn every_room_uses_only_what_it_may() {
    assert_clean(|file, code| forbidden_imports(file, code, &rules()));
}

#[test]
fn only_the_command_line_prints() {
    assert_clean(forbidden_printing);
}

#[test]
fn only_the_command_line_names_its_options() {
    assert_clean(forbidden_options);
}

#[test]
fn only_one_room_reads_and_writes_pixels() {
    assert_clean(forbidden_pixels);
}

#[test]
fn unsafe_code_stays_in_its_places() {
    assert_clean(forbidden_unsafe);
}

#[test]
fn the_table_names_every_room_and_no_other() {
    let rooms: BTreeSet<String> = sources().iter().filter_map(|(file, _)| room_of(file)).collect();
    assert_eq!(rooms, rules().into_keys().collect());
}

#[test]
fn nothing_walks_back() {
    for (room, usable) in rules() {
        assert!(!usable.contains(&room), "`{room}` may use itself through another room");
    }
}

#[test]
fn no_room_may_use_what_it_does_not_use() {
    let sources = sources();
    let unused = unused_edges(&direct_rules(), &sources);
    assert!(unused.is_empty(), "in the table of ARCHITECTURE.md:\n{}", unused.join("\n"));
}

#[test]
fn no_file_uses_itself_through_others() {
    let graph = graph_of(&sources());
    let circles = files::circles(&graph);
    let told: Vec<String> = circles.iter().map(|circle| circle_in_words(&graph, circle)).collect();
    assert!(told.is_empty(), "files in circles:\n{}", told.join("\n"));
}

#[test]
fn forbidden_imports_are_found_however_they_are_written() {
    let rules = closure(table("| `low` | | – |\n| `high` | | `low` |\n| `top` | | `high` |"));
    let found = |file: &str, code: &str| forbidden_imports(file, code, &rules);
    for code in [
        "use crate::high::Thing;",
        "pub use crate::high;",
        "use crate::{low::A, high::{B, C}};",
        "use crate::{\n    low::{A, B},\n    top::C,\n};",
        "fn f(x: &crate::top::X) {}",
        "use super::high::Thing;",
        "use crate::nowhere::Thing;",
    ] {
        assert_eq!(found("src/low/mod.rs", code).len(), 1, "{code}");
    }
    for code in [
        "use crate::low::Thing;\nuse crate::{high::{A, B}, low};",
        "use super::low; // unlike crate::nowhere",
        "mod tests {\n    use super::super::*;\n}",
        "//! See [`crate::nowhere`].",
        "use mycrate::nowhere;",
    ] {
        assert_eq!(found("src/top/inner.rs", code), Vec::<String>::new(), "{code}");
    }
    assert_eq!(found("src/high.rs", "\n\nuse crate::top;"), ["src/high.rs:3: `high` uses `top`"]);
    assert_eq!(found("src/high/a/b.rs", "use super::super::super::top::X;").len(), 1);
}

#[test]
fn an_edge_that_nobody_uses_is_found() {
    let direct = table("| `low` | | – |\n| `mid` | | `low` |\n| `top` | | `low`, `mid` |");
    let unused = |top: &str| {
        let files = [
            ("src/low.rs", "pub struct Thing;"),
            ("src/mid/mod.rs", "pub use crate::low::Thing;\npub struct Own;"),
            ("src/top/mod.rs", top),
        ];
        let files = files.map(|(file, code)| (file.to_owned(), code.to_owned()));
        unused_edges(&direct, &files)
    };
    let both = "use crate::low::Thing;\nfn f(_: Thing, _: crate::mid::Own) {}";
    assert_eq!(unused(both), Vec::<String>::new());
    let handed_on = "use crate::mid::{Own, Thing};\nfn f(_: Thing, _: Own) {}";
    assert_eq!(unused(handed_on), Vec::<String>::new());
    assert_eq!(unused("fn f(_: crate::mid::Own) {}"), ["`top` may use `low` and does not"]);
    let in_words = "// crate::low\nfn f() -> &'static str { \"low\" }";
    assert_eq!(unused(in_words).len(), 2);
}

#[test]
fn circles_of_files_are_found_and_what_is_handed_on_is_none() {
    let circles = |files: &[(&str, &str)]| files::circles(&files::graph(files.iter().copied()));
    let child = ("src/room/child.rs", "use super::Kind;\npub struct Child(Kind);");
    let kind = ("src/room/kind.rs", "pub struct Kind;");
    // A parent that hands on, whatever it is called by.
    let hands_on = "mod child;\nmod kind;\npub use child::Child;\npub use self::kind::{Kind, *};";
    assert!(circles(&[("src/room/mod.rs", hands_on), child, kind]).is_empty());
    // One that defines what its child uses, and uses the child.
    for defines in [
        "mod child;\npub struct Kind;\nfn f() -> child::Child { todo!() }",
        "mod child;\nuse child::Child;\npub enum Kind { One(Child) }",
        "mod child;\npub use child::Child as Name;\npub enum Kind { One(Name) }",
        "mod child;\npub struct Kind(pub(super) crate::room::child::Child);",
    ] {
        let found = circles(&[("src/room/mod.rs", defines), child]);
        let both = ["src/room/child.rs", "src/room/mod.rs"].map(str::to_owned);
        assert_eq!(found, [BTreeSet::from(both)], "{defines}");
    }
    // Three in a row, through names that others hand on; the fourth is not of them.
    let a = ("src/a.rs", "use crate::b::Out;\npub struct A(Out);");
    let b = ("src/b/mod.rs", "mod inner;\npub use inner::Out;");
    let inner =
        ("src/b/inner.rs", "use crate::{c::{self as last}, d::D};\npub struct Out(last::C, D);");
    let c = ("src/c.rs", "pub struct C(Option<Box<crate::a::A>>);");
    let d = ("src/d.rs", "pub struct D;");
    let found = circles(&[a, b, inner, c, d]);
    assert_eq!(found, [["src/a.rs", "src/b/inner.rs", "src/c.rs"].map(str::to_owned).into()]);
    // Tests, comments, other crates and a file's own modules are no uses.
    let free = "mod keys {\n    use super::Kind;\n    fn f(_: Kind) {}\n}\nuse kind::Name;\n\
                /// [`super::Kind`]\npub struct Kind(Name);\n#[cfg(test)]\nmod tests {\n    use
                /// super::super::Kind;\n    \
                fn f(_: crate::room::Kind) {}\n}";
    let user = ("src/room/mod.rs", "mod kind;\npub struct Kind;\nfn f() -> kind::Kind { todo!() }");
    assert!(circles(&[user, ("src/room/kind.rs", free)]).is_empty());
}

#[test]
fn forbidden_printing_and_unsafe_code_are_found() {
    for code in ["println!(\"x\");", "eprint!()", "dbg!(x)", "let out = io::stdout();"] {
        assert_eq!(forbidden_printing("src/film/mod.rs", code).len(), 1, "{code}");
        assert_eq!(forbidden_printing("src/cli/mod.rs", code).len(), 0, "{code}");
    }
    assert_eq!(
        forbidden_printing("src/film/mod.rs", "// println!\noutput.stdout; blueprint!()").len(),
        0
    );
    for code in [r#"with_help("try --accel native")"#, r#"let flag = "--spp";"#] {
        assert_eq!(forbidden_options("src/film/mod.rs", code).len(), 1, "{code}");
        assert_eq!(forbidden_options("src/cli/mod.rs", code).len(), 0, "{code}");
    }
    for code in ["let x = y--z;", r#"let line = "a -- b";"#, "// as in --spp 16"] {
        assert_eq!(forbidden_options("src/film/mod.rs", code).len(), 0, "{code}");
    }
    for code in ["use exr::meta::MetaData;", "exr::prelude::read()", "use image::ImageFormat;"] {
        assert_eq!(forbidden_pixels("src/scene/scene.rs", code).len(), 1, "{code}");
        assert_eq!(forbidden_pixels("src/image_io/png.rs", code).len(), 0, "{code}");
    }
    assert_eq!(forbidden_pixels("src/scene/scene.rs", "keys::image::WIDTH").len(), 0);
    for code in
        ["unsafe { f() }", "unsafe fn f() {}", "unsafe impl Send for X {}", "#[unsafe(no_mangle)]"]
    {
        assert_eq!(forbidden_unsafe("src/accel/mod.rs", code).len(), 1, "{code}");
    }
    assert_eq!(forbidden_unsafe("src/accel/mod.rs", "#![deny(unsafe_code)] // unsafe {").len(), 0);
    assert_eq!(forbidden_unsafe("src/accel/embree/scene.rs", "unsafe { f() }").len(), 0);
    assert_eq!(forbidden_unsafe("src/accel/native/kernel/slot.rs", "unsafe { f() }").len(), 0);
    assert_eq!(forbidden_unsafe("src/accel/native/tree.rs", "unsafe { f() }").len(), 1);
    assert_eq!(forbidden_unsafe("src/math/isa.rs", "unsafe { f() }").len(), 0);
    assert_eq!(forbidden_unsafe("src/denoise/oidn/device.rs", "unsafe { f() }").len(), 0);
    assert_eq!(forbidden_unsafe("src/denoise/picture.rs", "unsafe { f() }").len(), 1);
    assert_eq!(forbidden_unsafe("src/accel/embree_like.rs", "unsafe { f() }").len(), 1);
}

// ---- The rules ----

fn rules() -> Rules {
    closure(direct_rules())
}

/// What the table says, word by word.
fn direct_rules() -> Rules {
    let document = read(Path::new("ARCHITECTURE.md"));
    let (_, after) = document.split_once(HEADER).expect("ARCHITECTURE.md has the table of rooms");
    let rows: Vec<&str> =
        after.trim_start().lines().take_while(|row| row.starts_with('|')).collect();
    table(&rows.join("\n"))
}

/// The direct edges of the table's rows: the names in backquotes in the first and last column.
fn table(rows: &str) -> Rules {
    let mut direct = Rules::new();
    for row in rows.lines() {
        let cells: Vec<&str> = row.trim_matches('|').split('|').collect();
        let usable: BTreeSet<String> = quoted(cells[cells.len() - 1]).collect();
        for room in quoted(cells[0]) {
            direct.insert(room, usable.clone());
        }
    }
    direct
}

fn quoted(cell: &str) -> impl Iterator<Item = String> {
    cell.split('`').skip(1).step_by(2).map(str::to_owned)
}

fn closure(direct: Rules) -> Rules {
    let mut rules = direct;
    loop {
        let before = rules.clone();
        for usable in rules.values_mut() {
            let through: Vec<_> =
                usable.iter().filter_map(|room| before.get(room)).flatten().cloned().collect();
            usable.extend(through);
        }
        if rules == before {
            return rules;
        }
    }
}

// ---- The checks: each returns its findings, as `file:line: what` ----

fn forbidden_imports(file: &str, code: &str, rules: &Rules) -> Vec<String> {
    let Some(room) = room_of(file) else { return Vec::new() };
    let nothing = BTreeSet::new();
    let usable = rules.get(&room).unwrap_or(&nothing);
    let code = without_comments(code);
    let mut findings = Vec::new();
    for (at, name) in imports(file, &code, rules) {
        if name != room && !usable.contains(&name) {
            findings.push(format!("{file}:{}: `{room}` uses `{name}`", line_of(&code, at)));
        }
    }
    findings
}

/// The entries of the table that nobody would miss. A name that another room hands on is that of
/// the room that defines it.
fn unused_edges(direct: &Rules, sources: &[(String, String)]) -> Vec<String> {
    let mut used = BTreeSet::new();
    for (file, others) in &graph_of(sources) {
        used.extend(others.keys().filter_map(|other| Some((room_of(file)?, room_of(other)?))));
    }
    for (file, code) in sources {
        let imports = imports(file, &without_comments(code), direct).into_iter();
        used.extend(imports.filter_map(|(_, name)| Some((room_of(file)?, name))));
    }
    let mut unused = Vec::new();
    for (room, others) in direct {
        let is_unused = |other: &&String| !used.contains(&(room.clone(), (*other).clone()));
        let told = others.iter().filter(is_unused);
        unused.extend(told.map(|other| format!("`{room}` may use `{other}` and does not")));
    }
    unused
}

fn graph_of(sources: &[(String, String)]) -> files::Graph {
    files::graph(sources.iter().map(|(file, code)| (file.as_str(), code.as_str())))
}

fn forbidden_printing(file: &str, code: &str) -> Vec<String> {
    if file.starts_with("src/cli/") || file == "src/main.rs" {
        return Vec::new();
    }
    let printing = ["print!", "println!", "eprint!", "eprintln!", "dbg!", "stdout()", "stderr()"];
    findings(file, code, &printing, "only `cli` prints")
}

/// A program that uses the library has other names for what the command line calls `--spp`.
fn forbidden_options(file: &str, code: &str) -> Vec<String> {
    if file.starts_with("src/cli/") {
        return Vec::new();
    }
    let code = without_comments(code);
    let is_option = |at: &usize| {
        let before = code[..*at].chars().next_back();
        let after = code[at + 2..].chars().next();
        before.is_none_or(|c| c.is_whitespace() || c == '"' || c == '`')
            && after.is_some_and(|c| c.is_ascii_lowercase())
    };
    let places = code.match_indices("--").map(|(at, _)| at).filter(is_option);
    places.map(|at| format!("{file}:{}: only `cli` names options", line_of(&code, at))).collect()
}

/// What knows the formats of pictures is called in `image_io` alone.
fn forbidden_pixels(file: &str, code: &str) -> Vec<String> {
    if file.starts_with("src/image_io/") {
        return Vec::new();
    }
    let calls = ["exr::", "use image::", "use png::", "ImageReader", "image::open"];
    findings(file, code, &calls, "only `image_io` reads and writes pixels")
}

/// Where `unsafe` may be: the fences around Embree and Open Image Denoise, the native kernel, and
/// the modules that call vector instructions found at run time, and advice about memory.
const UNSAFE: [&str; 6] = [
    "src/accel/embree/",
    "src/accel/native/kernel/",
    "src/math/isa.rs",
    "src/math/bytes.rs",
    "src/task/pages.rs",
    "src/denoise/oidn/",
];

fn forbidden_unsafe(file: &str, code: &str) -> Vec<String> {
    if UNSAFE.iter().any(|place| file.starts_with(place)) {
        return Vec::new();
    }
    // The keyword and what may follow it, so that the word in a text is none.
    let forms = ["{", "fn", "impl", "trait", "extern"].map(|next| format!("unsafe {next}"));
    let forms: Vec<&str> = forms.iter().map(String::as_str).chain(["unsafe("]).collect();
    findings(file, code, &forms, "`unsafe` is not for this place")
}

fn findings(file: &str, code: &str, words: &[&str], rule: &str) -> Vec<String> {
    let code = without_comments(code);
    let places = words.iter().flat_map(|word| occurrences(&code, word));
    places.map(|at| format!("{file}:{}: {rule}", line_of(&code, at))).collect()
}

fn assert_clean(check: impl Fn(&str, &str) -> Vec<String>) {
    let found: Vec<String> = sources().iter().flat_map(|(file, code)| check(file, code)).collect();
    assert!(found.is_empty(), "against ARCHITECTURE.md:\n{}", found.join("\n"));
}

/// Who takes what from whom.
fn circle_in_words(graph: &files::Graph, circle: &BTreeSet<String>) -> String {
    let mut lines = vec![format!("a circle of {} files", circle.len())];
    for file in circle {
        for (from, names) in graph[file].iter().filter(|(from, _)| circle.contains(*from)) {
            let names: Vec<&str> = names.iter().map(String::as_str).collect();
            lines.push(format!("  {file} uses {from}: {}", names.join(", ")));
        }
    }
    lines.join("\n")
}

// ---- Reading source text ----

/// The first name of every path that starts at the crate's root, with its place. A `super::` chain
/// counts where it reaches the root and goes on to a room.
fn imports(file: &str, code: &str, rules: &Rules) -> Vec<(usize, String)> {
    // `super` once for each folder, and once more from a file that is not its folder's `mod.rs`.
    let depth = file.matches('/').count() - usize::from(file.ends_with("/mod.rs"));
    let is_room = |(_, name): &(usize, String)| rules.contains_key(name);
    let mut found = names_after(code, "crate::");
    found.extend(names_after(code, &"super::".repeat(depth)).into_iter().filter(is_room));
    found
}

fn names_after(code: &str, root: &str) -> Vec<(usize, String)> {
    let mut found = Vec::new();
    for at in occurrences(code, root) {
        let start = at + root.len();
        let names = first_names(&code[start..]).into_iter();
        found.extend(names.map(|(offset, name)| (start + offset, without_re_export(name))));
    }
    found
}

/// `crate::Error` and `crate::Result` are the room `error` under the names that `lib.rs` gives
/// them.
fn without_re_export(name: String) -> String {
    if name == "Error" || name == "Result" { "error".to_owned() } else { name }
}

/// The name at the start of `rest`, or those in a group in braces, with their offsets.
fn first_names(rest: &str) -> Vec<(usize, String)> {
    let mut names = Vec::new();
    let mut nesting = 0;
    let mut expected = true;
    for (offset, c) in rest.char_indices() {
        match c {
            '{' => nesting += 1,
            '}' => nesting -= 1,
            ',' => expected = nesting == 1,
            _ if c.is_whitespace() => {}
            _ if expected => {
                names.push((offset, rest[offset..].chars().take_while(|c| is_word(*c)).collect()));
                expected = false;
            }
            _ => {}
        }
        if nesting == 0 && (c == '}' || !expected) {
            break;
        }
    }
    names
}

/// Where `word` stands in the code as a word of its own.
fn occurrences(code: &str, word: &str) -> Vec<usize> {
    let is_whole = |at: &usize| {
        let continues = |c: Option<char>| c.is_some_and(is_word);
        let before = continues(code[..*at].chars().next_back());
        let after = continues(code[at + word.len()..].chars().next());
        !(before || after && word.ends_with(is_word))
    };
    code.match_indices(word).map(|(at, _)| at).filter(is_whole).collect()
}

fn is_word(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

/// The code with its comments blanked: a `//` in a string ends the line too, which hides nothing
/// that these checks look for.
fn without_comments(code: &str) -> String {
    let lines = code.lines().map(|line| line.split("//").next().unwrap_or_default());
    lines.collect::<Vec<_>>().join("\n")
}

pub(super) fn line_of(code: &str, at: usize) -> usize {
    code[..at].matches('\n').count() + 1
}

/// `src/film/mod.rs` and `src/film.rs` are in the room `film`; the crate's two roots are in none.
fn room_of(file: &str) -> Option<String> {
    let inside = file.strip_prefix("src/")?;
    let room = inside.split('/').next()?.trim_end_matches(".rs");
    (room != "lib" && room != "main").then(|| room.to_owned())
}

/// Every Rust file below `src`, with its text.
fn sources() -> Vec<(String, String)> {
    sources_in("src")
}

/// Every Rust file below a folder, with its text.
pub(super) fn sources_in(folder: &str) -> Vec<(String, String)> {
    let mut found = Vec::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(folder) = folders.pop() {
        let entries = fs::read_dir(root().join(&folder)).expect("folders can be listed");
        for entry in entries {
            let entry = entry.expect("folders can be listed");
            let name = format!("{folder}/{}", entry.file_name().to_string_lossy());
            if entry.path().is_dir() {
                folders.push(name);
            } else if name.ends_with(".rs") {
                found.push((name.clone(), read(Path::new(&name))));
            }
        }
    }
    found.sort();
    found
}

fn read(file: &Path) -> String {
    fs::read_to_string(root().join(file)).expect("the repository's files can be read")
}

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}
