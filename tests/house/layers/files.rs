//! Which file of `src/` uses which, read from the sources.
//!
//! A path leads to the file that defines what it names: a `use` on its way is followed, so a
//! `mod.rs` that only hands on what its children define stands between nobody, and uses none of
//! them. What tests use does not count. As text is read and not syntax trees, names that macros
//! make are not seen.

use std::collections::{BTreeMap, BTreeSet};

use super::{is_word, occurrences, without_comments};

/// For each file the files that it uses, and the names that it takes from each.
pub(super) type Graph = BTreeMap<String, BTreeMap<String, BTreeSet<String>>>;

type Path = Vec<String>;

/// A file as the others see it.
struct File {
    name: String,
    /// What its `use` items name, and where that is.
    names: BTreeMap<String, Path>,
    /// All paths in it.
    paths: Vec<Path>,
}

/// The files by the paths of their modules.
struct Files(BTreeMap<Path, File>);

/// Where a path leads.
enum Place {
    Module(Path),
    /// To something that this file defines.
    File(String),
}

/// The graph of some files, given as names and texts.
pub(super) fn graph<'a>(sources: impl IntoIterator<Item = (&'a str, &'a str)>) -> Graph {
    let sources = sources.into_iter().filter(|(file, _)| !file.ends_with("/tests.rs"));
    let files = Files(sources.map(|(file, code)| (module_of(file), read(file, code))).collect());
    let mut graph = Graph::new();
    for (module, file) in &files.0 {
        let used = graph.entry(file.name.clone()).or_default();
        for path in &file.paths {
            match files.find(module, path, 0) {
                Some(Place::File(of)) if of != file.name => {
                    used.entry(of).or_default().extend(path.last().cloned());
                }
                _ => {}
            }
        }
    }
    graph
}

/// The circles of a graph: files each of which can be reached from all others.
pub(super) fn circles(graph: &Graph) -> Vec<BTreeSet<String>> {
    let reached: BTreeMap<&String, BTreeSet<&String>> =
        graph.keys().map(|file| (file, reached_from(graph, file))).collect();
    let mut circles = BTreeSet::new();
    for (file, others) in reached.iter().filter(|(file, others)| others.contains(*file)) {
        let around = others.iter().filter(|other| reached[**other].contains(*file));
        circles.insert(around.map(|other| (*other).clone()).collect());
    }
    circles.into_iter().collect()
}

fn reached_from<'a>(graph: &'a Graph, file: &str) -> BTreeSet<&'a String> {
    let mut found = BTreeSet::new();
    let mut left: Vec<&String> = graph[file].keys().collect();
    while let Some(next) = left.pop() {
        if found.insert(next) {
            left.extend(graph.get(next).into_iter().flat_map(BTreeMap::keys));
        }
    }
    found
}

impl Files {
    /// Where a path leads that stands in this module; `None` for what is not of this crate, or of
    /// the file itself.
    fn find(&self, from: &[String], path: &[String], depth: usize) -> Option<Place> {
        let mut module = from.to_vec();
        let mut rest = path;
        while let Some(first) = rest.first() {
            match first.as_str() {
                "crate" => module.clear(),
                "super" => drop(module.pop()),
                "self" => {}
                _ => break,
            }
            rest = &rest[1..];
        }
        let is_local = rest.len() == path.len();
        for (at, name) in rest.iter().enumerate() {
            let inner = [&module[..], std::slice::from_ref(name)].concat();
            if self.0.contains_key(&inner) {
                module = inner;
                continue;
            }
            let file = self.0.get(&module)?;
            match file.names.get(name) {
                Some(to) if depth < 8 => match self.find(&module, to, depth + 1)? {
                    Place::Module(found) => module = found,
                    Place::File(found) => return Some(Place::File(found)),
                },
                _ if at == 0 && is_local => return None,
                _ => return Some(Place::File(file.name.clone())),
            }
        }
        Some(Place::Module(module))
    }
}

/// `src/film/tile.rs` is the module `into_film::tile`, and so would be `src/film/tile/mod.rs`.
fn module_of(file: &str) -> Path {
    let path = file.trim_start_matches("src/").trim_end_matches(".rs");
    let path = path.trim_end_matches("/mod");
    if path == "lib" { Path::new() } else { path.split('/').map(str::to_owned).collect() }
}

fn read(file: &str, code: &str) -> File {
    let code = without_tests(&without_comments(code));
    let inner = inner_modules(&code);
    // In a module within the file, the first `super` is the file.
    let of_file = |at: usize, path: Path| {
        let within = inner.iter().filter(|(begin, end)| (*begin..*end).contains(&at)).count();
        let out = path.iter().take(within).take_while(|name| *name == "super").count();
        if out == 0 { path } else { [&["self".to_owned()], &path[out..]].concat() }
    };
    let (mut names, mut elsewhere) = (BTreeMap::new(), code.clone());
    for at in occurrences(&code, "use").into_iter().filter(|at| code[at + 3..].starts_with(' ')) {
        let Some(length) = code[at..].find(';') else { continue };
        let tree = named(&code[at + 3..at + length], &[]).into_iter();
        names.extend(tree.map(|(name, path)| (name, of_file(at, path))));
        elsewhere.replace_range(at..at + length, &" ".repeat(length));
    }
    let paths = written_out(&elsewhere).into_iter().map(|(at, path)| of_file(at, path));
    // Handing on is no use.
    let used = names.iter().filter(|(name, _)| !occurrences(&elsewhere, name).is_empty());
    let paths = paths.chain(used.map(|(_, path)| path.clone())).collect();
    File { name: file.to_owned(), names, paths }
}

/// The names that a `use` brings, and their paths; `before` is the path that leads to this tree.
fn named(tree: &str, before: &[String]) -> Vec<(String, Path)> {
    let tree = tree.trim();
    let (stem, group) = match tree.split_once('{') {
        Some((stem, group)) => (stem, Some(group.trim_end().trim_end_matches('}'))),
        None => (tree, None),
    };
    let (stem, other_name) = match stem.split_once(" as ") {
        Some((stem, name)) => (stem, Some(name.trim())),
        None => (stem, None),
    };
    let stem = stem.split("::").map(str::trim).filter(|name| !name.is_empty() && *name != "*");
    let mut path: Path = before.iter().cloned().chain(stem.map(str::to_owned)).collect();
    match group {
        Some(group) => parts(group).into_iter().flat_map(|part| named(part, &path)).collect(),
        None => {
            if path.len() > 1 && path.last().is_some_and(|name| name == "self") {
                path.pop();
            }
            let name = other_name.or(path.last().map(String::as_str)).unwrap_or_default();
            if name.is_empty() { Vec::new() } else { vec![(name.to_owned(), path.clone())] }
        }
    }
}

/// What stands between the commas that are in no braces.
fn parts(group: &str) -> Vec<&str> {
    let mut nesting = 0;
    let is_comma = |c: char| {
        nesting += i32::from(c == '{') - i32::from(c == '}');
        c == ',' && nesting == 0
    };
    group.split(is_comma).filter(|part| !part.trim().is_empty()).collect()
}

/// The paths of more than one name, and where they stand; those of macros (`$crate::...`) are left
/// out.
fn written_out(code: &str) -> Vec<(usize, Path)> {
    let mut found = Vec::new();
    let mut end = 0;
    for (at, _) in code.match_indices("::") {
        let begin = code[..at].rfind(|c: char| !is_word(c)).map_or(0, |before| before + 1);
        if at < end || begin == at || code[..begin].ends_with(['$', ':']) {
            continue;
        }
        let rest = &code[begin..];
        let length = rest.find(|c: char| !is_word(c) && c != ':').unwrap_or(rest.len());
        end = begin + length;
        let names = rest[..length].split("::").filter(|name| !name.is_empty());
        found.push((begin, names.map(str::to_owned).collect()));
    }
    found
}

/// The code with its modules of tests blanked.
fn without_tests(code: &str) -> String {
    let mut code = code.to_owned();
    for (begin, end) in inner_modules(&code) {
        if code[..begin].trim_end().ends_with("#[cfg(test)]") {
            let blank: String = code[begin..end].chars().map(|_| ' ').collect();
            code.replace_range(begin..end, &blank);
        }
    }
    code
}

/// Where the modules begin and end that are written out in a file.
fn inner_modules(code: &str) -> Vec<(usize, usize)> {
    let mut found = Vec::new();
    for at in occurrences(code, "mod") {
        let name = code[at + 3..].trim_start_matches(|c: char| c == ' ' || is_word(c));
        if !name.starts_with('{') {
            continue;
        }
        let mut nesting = 0;
        let closes = |c: char| {
            nesting += i32::from(c == '{') - i32::from(c == '}');
            c == '}' && nesting == 0
        };
        let open = code.len() - name.len();
        found.push((at, code[open..].find(closes).map_or(code.len(), |length| open + length)));
    }
    found
}
