//! The comment line of extended XYZ.

use crate::math::DVec3;
use crate::particles::column::component_name;
use crate::particles::frames::FrameHead;
use crate::particles::model::Cell;
use crate::particles::text::{Field, FieldUse, Fields, Kind, float, tokens};
use crate::particles::trouble::shown;

/// The most columns that a line may have.
const MAX_COLUMNS: u64 = 4096;

/// Reads the comment: what the columns are, the cell, the time. A comment without `Lattice` and
/// `Properties` is a title.
pub(super) fn head(comment: &str) -> Result<FrameHead, String> {
    let pairs = pairs(comment);
    let get = |key: &str| {
        let found = pairs.iter().find(|(name, _)| name.eq_ignore_ascii_case(key));
        found.map(|(_, value)| value.as_deref().unwrap_or_default())
    };
    let (lattice, properties) = (get("Lattice"), get("Properties"));
    let mut head = FrameHead::default();
    if lattice.is_none() && properties.is_none() {
        let title = comment.trim();
        head.title = (!title.is_empty()).then(|| title.to_owned());
        return Ok(head);
    }
    if let Some(text) = lattice {
        head.cell = Some(cell(text, get("Origin"), get("pbc"))?);
    }
    if let Some(text) = properties {
        head.fields = fields(text)?;
    }
    let time = ["Time", "Timestep", "step"].iter().find_map(|key| get(key));
    head.time = time.and_then(|time| float(time.as_bytes()));
    Ok(head)
}

/// Keys with their values. A value, or a key, may be in quotes or brackets; a backslash takes the
/// meaning off the next character.
fn pairs(comment: &str) -> Vec<(String, Option<String>)> {
    let mut pairs = Vec::new();
    let mut rest = comment.chars().peekable();
    loop {
        while rest.next_if(|c| c.is_whitespace()).is_some() {}
        if rest.peek().is_none() {
            return pairs;
        }
        let key = word(&mut rest, true);
        let mut ahead = rest.clone();
        while ahead.next_if(|c| c.is_whitespace()).is_some() {}
        let value = ahead.next_if_eq(&'=').map(|_| {
            rest = ahead;
            while rest.next_if(|c| c.is_whitespace()).is_some() {}
            word(&mut rest, false)
        });
        if key.is_empty() && value.is_none() {
            rest.next();
        }
        pairs.push((key, value));
    }
}

/// A word, in quotes or brackets or up to white space. A key also ends before `=`.
fn word(rest: &mut std::iter::Peekable<std::str::Chars<'_>>, is_key: bool) -> String {
    let mut word = String::new();
    let close = match rest.peek() {
        Some('"') => Some('"'),
        Some('\'') => Some('\''),
        Some('{') => Some('}'),
        Some('[') => Some(']'),
        _ => None,
    };
    if let Some(close) = close {
        let open = rest.next();
        let mut depth = 1;
        while let Some(c) = rest.next() {
            match c {
                '\\' => word.extend(rest.next()),
                c if c == close => {
                    depth -= 1;
                    if depth == 0 {
                        return word;
                    }
                    word.push(c);
                }
                c => {
                    depth += u32::from(Some(c) == open);
                    word.push(c);
                }
            }
        }
        return word;
    }
    while let Some(c) = rest.next_if(|&c| !(c.is_whitespace() || is_key && c == '=')) {
        match c {
            '\\' => word.extend(rest.next()),
            c => word.push(c),
        }
    }
    word
}

/// The cell: the vectors a, b and c one after the other, or three edge lengths.
fn cell(lattice: &str, origin: Option<&str>, pbc: Option<&str>) -> Result<Cell, String> {
    let expected =
        || format!("expected nine numbers in `Lattice`, found {}", shown(lattice.as_bytes()));
    let numbers = numbers(lattice).ok_or_else(expected)?;
    let vector = |at: usize| DVec3::new(numbers[at], numbers[at + 1], numbers[at + 2]);
    let vectors = match numbers.len() {
        9 => [vector(0), vector(3), vector(6)],
        3 => [DVec3::X * numbers[0], DVec3::Y * numbers[1], DVec3::Z * numbers[2]],
        _ => return Err(expected()),
    };
    let origin = match origin {
        None => DVec3::ZERO,
        Some(text) => match self::numbers(text).as_deref() {
            Some(&[x, y, z]) => DVec3::new(x, y, z),
            _ => {
                let found = shown(text.as_bytes());
                return Err(format!("expected three numbers in `Origin`, found {found}"));
            }
        },
    };
    Ok(Cell { origin, vectors, periodic: periodic(pbc.unwrap_or("T T T"))? })
}

/// Numbers between white space, commas or brackets; all of them finite.
fn numbers(text: &str) -> Option<Vec<f64>> {
    let text = text.replace([',', '[', ']'], " ");
    tokens(text.as_bytes()).map(|token| float(token).filter(|x| x.is_finite())).collect()
}

fn periodic(text: &str) -> Result<[bool; 3], String> {
    let plain = text.replace([',', '[', ']'], " ");
    let flag = |word: &str| match word.to_ascii_lowercase().as_str() {
        "t" | "true" | ".true." | "1" => Some(true),
        "f" | "false" | ".false." | "0" => Some(false),
        _ => None,
    };
    let flags: Option<Vec<bool>> = plain.split_whitespace().map(flag).collect();
    match flags.as_deref() {
        Some(&[a, b, c]) => Ok([a, b, c]),
        Some(&[all]) => Ok([all; 3]),
        _ => {
            let found = shown(text.as_bytes());
            Err(format!("expected three of T and F in `pbc`, found {found}"))
        }
    }
}

/// The columns: name, type and number of values, three parts each.
fn fields(properties: &str) -> Result<Fields, String> {
    let parts: Vec<&str> = properties.split(':').collect();
    let mut fields = Vec::new();
    for part in parts.chunks(3) {
        let wrong = || {
            let found = shown(part.join(":").as_bytes());
            format!("expected name, type (S, R, I or L) and number in `Properties`, found {found}")
        };
        let &[name, letter, count] = part else { return Err(wrong()) };
        let kind = match letter {
            "S" | "L" => Kind::Text,
            "R" => Kind::F64,
            "I" => Kind::I32,
            _ => return Err(wrong()),
        };
        let count: u64 = count.parse().map_err(|_| wrong())?;
        if count == 0 || count > MAX_COLUMNS - fields.len() as u64 {
            return Err(format!("`Properties` has more than {MAX_COLUMNS} columns, or empty ones"));
        }
        let is_position = count == 3 && matches!(name, "pos" | "position" | "positions");
        fields.extend((0..count).map(|at| match is_position {
            true => Field::position(at as usize),
            false => Field::column(component_name(name, at as usize, count as usize), kind),
        }));
    }
    if !fields.iter().any(|field| matches!(field.is, FieldUse::Position(_))) {
        return Err("`Properties` has no positions: expected `pos:R:3`".to_owned());
    }
    Ok(Fields(fields))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pair<'a>(key: &'a str, value: &'a str) -> (String, Option<String>) {
        (key.to_owned(), Some(value.to_owned()))
    }

    #[test]
    fn pairs_are_split_at_any_delimiter() {
        let text = r#"a=1 b="two words" 'c d'={3 4} e=[[1, 2], [3, 4]] flag f=x\ y g = 7 h="q\"r""#;
        let found = pairs(text);
        let flag = ("flag".to_owned(), None);
        let expected = [
            pair("a", "1"),
            pair("b", "two words"),
            pair("c d", "3 4"),
            pair("e", "[1, 2], [3, 4]"),
            flag,
            pair("f", "x y"),
            pair("g", "7"),
            pair("h", "q\"r"),
        ];
        assert_eq!(found, expected);
        for odd in ["=", "==", "= =", "a==b", "\"", "\\", "[", "a=[", "=a", "\u{e9}=\u{fc}"] {
            pairs(odd);
        }
    }

    #[test]
    fn cells_and_columns_are_read() {
        let comment = "Lattice=\"1 0 0 0.5 2 0 0 0 3\" Properties=species:S:1:pos:R:3:forces:R:3:\
                       stress:R:2 pbc=\"T F T\" Origin=\"1 2 3\" Time=1.5";
        let head = head(comment).expect("a head");
        let cell = head.cell.expect("a cell");
        assert_eq!(cell.vectors[1], DVec3::new(0.5, 2.0, 0.0));
        assert_eq!((cell.origin, cell.periodic), (DVec3::new(1.0, 2.0, 3.0), [true, false, true]));
        assert_eq!(head.time, Some(1.5));
        let names: Vec<&str> = head.fields.names().collect();
        assert_eq!(names, ["species", "forces_x", "forces_y", "forces_z", "stress_1", "stress_2"]);
    }

    #[test]
    fn mistakes_are_named() {
        for (comment, message) in [
            ("Lattice=\"1 2\"", "expected nine numbers in `Lattice`, found `1 2`"),
            ("Lattice=\"1 0 0 0 x 0 0 0 1\"", "expected nine numbers in `Lattice`"),
            ("Properties=pos:R", "expected name, type"),
            ("Properties=pos:Q:3", "expected name, type"),
            ("Properties=pos:R:99999999999999999999", "expected name, type"),
            ("Properties=a:R:5000:pos:R:3", "more than 4096 columns"),
            ("Properties=species:S:1", "has no positions"),
            ("Lattice=\"1 1 1\" pbc=\"T T\"", "expected three of T and F"),
        ] {
            let error = head(comment).expect_err("a mistake");
            assert!(error.contains(message), "{error}");
        }
    }
}
