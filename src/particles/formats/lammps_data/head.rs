//! The head of a LAMMPS data file, and the sections before its atoms.

use crate::math::DVec3;
use crate::particles::model::Cell;
use crate::particles::text::{Input, float, integer, tokens};
use crate::particles::trouble::{Outcome, Trouble, shown};

/// What stands before the atoms.
#[derive(Debug, Default)]
pub(super) struct Head {
    pub(super) title: Option<String>,
    pub(super) count: u64,
    pub(super) cell: Option<Cell>,
    /// The style that the section of the atoms names.
    pub(super) style: Option<String>,
    /// Types with their masses.
    pub(super) masses: Vec<(String, f64)>,
    /// Types with their names.
    pub(super) labels: Vec<(String, String)>,
}

/// Bounds, tilts and vectors of the box.
#[derive(Default)]
struct Bounds {
    low: [Option<f64>; 3],
    high: [f64; 3],
    tilts: Option<[f64; 3]>,
    vectors: [Option<DVec3>; 3],
    origin: DVec3,
}

/// The most types that are remembered.
const MAX_TYPES: usize = 1 << 16;

/// Reads up to the first atom.
pub(super) fn read_head(input: &mut Input) -> Outcome<Head> {
    let title = input.expect_line("a title")?;
    let title = title.trim();
    let mut head =
        Head { title: Some(title.to_owned()).filter(|title| !title.is_empty()), ..Head::default() };
    let mut bounds = Bounds::default();
    let (mut count, mut section) = (None, String::new());
    loop {
        let Some(line) = input.next_line()? else {
            let message = "expected a section `Atoms`, found the end of the file";
            return Err(Trouble::at(input.line_number(), message).into());
        };
        let number = input.line_number() - 1;
        let (text, comment) = line.split_once('#').unwrap_or((&line, ""));
        let words: Vec<&str> = text.split_whitespace().collect();
        let Some(first) = words.first() else { continue };
        if first.starts_with(|c: char| c.is_ascii_alphabetic()) && section_of(&words) {
            section = words.join(" ");
            if section == "Atoms" {
                head.style = comment.split_whitespace().next().map(str::to_owned);
                head.count = count.ok_or_else(|| {
                    Trouble::at(number, "expected the number of `atoms` before the atoms")
                })?;
                head.cell = bounds.cell();
                skip_empty(input)?;
                return Ok(head);
            }
            continue;
        }
        match &*section {
            "" => {
                if let Some(atoms) = bounds.read(&words, number)? {
                    count = Some(atoms);
                }
            }
            "Masses" => {
                if let ([kind, mass], true) = (&words[..], head.masses.len() < MAX_TYPES) {
                    let mass = float(mass.as_bytes()).unwrap_or(f64::NAN);
                    head.masses.push(((*kind).to_owned(), mass));
                    if let Some(name) = comment.split_whitespace().next() {
                        head.labels.push(((*kind).to_owned(), name.to_owned()));
                    }
                }
            }
            "Atom Type Labels" => {
                if let ([kind, label], true) = (&words[..], head.labels.len() < MAX_TYPES) {
                    head.labels.push(((*kind).to_owned(), (*label).to_owned()));
                }
            }
            _ => {}
        }
    }
}

/// Returns true if the words are the name of a section: sections begin with a capital letter, and
/// lines in them with a number or, with type labels, with a name and numbers.
fn section_of(words: &[&str]) -> bool {
    words[0].starts_with(|c: char| c.is_ascii_uppercase())
        && words.iter().all(|word| word.chars().all(|c| c.is_ascii_alphabetic()))
}

/// Moves past empty lines.
pub(super) fn skip_empty(input: &mut Input) -> Outcome<()> {
    while input.peek_line()?.is_some_and(|line| line.trim_ascii().is_empty()) {
        input.skip_lines(1)?;
    }
    Ok(())
}

impl Bounds {
    /// Takes up a line of the head; returns the number of atoms if it says that.
    fn read(&mut self, words: &[&str], line: u64) -> Outcome<Option<u64>> {
        let wrong = |expected: &str| {
            let found = shown(words.join(" ").as_bytes());
            Trouble::at(line, format!("expected {expected}, found {found}"))
        };
        let numbers = |count: usize, expected: &str| -> Result<Vec<f64>, Trouble> {
            let all = words.iter().take(count).map(|word| float(word.as_bytes()));
            let all: Option<Vec<f64>> = all.map(|x| x.filter(|x| x.is_finite())).collect();
            all.filter(|all| all.len() == count).ok_or_else(|| wrong(expected))
        };
        match *words {
            [count, "atoms"] => {
                let count = integer(count.as_bytes()).and_then(|count| u64::try_from(count).ok());
                return Ok(Some(count.ok_or_else(|| wrong("the number of atoms"))?));
            }
            [.., "xlo", "xhi"] | [.., "ylo", "yhi"] | [.., "zlo", "zhi"] => {
                let axis = match words[words.len() - 1] {
                    "xhi" => 0,
                    "yhi" => 1,
                    _ => 2,
                };
                let bounds = numbers(2, "two bounds of the box")?;
                (self.low[axis], self.high[axis]) = (Some(bounds[0]), bounds[1]);
            }
            [.., "xy", "xz", "yz"] => {
                let tilts = numbers(3, "three tilts of the box")?;
                self.tilts = Some([tilts[0], tilts[1], tilts[2]]);
            }
            [.., name @ ("avec" | "bvec" | "cvec")] => {
                let vector = DVec3::from_slice(&numbers(3, "a vector of the box")?);
                self.vectors[usize::from(name.as_bytes()[0] - b'a')] = Some(vector);
            }
            [.., "abc", "origin"] => {
                self.origin = DVec3::from_slice(&numbers(3, "the origin of the box")?);
            }
            _ => {}
        }
        Ok(None)
    }

    /// The cell; `None` if its bounds are not all there.
    fn cell(&self) -> Option<Cell> {
        if let [Some(a), Some(b), Some(c)] = self.vectors {
            return Some(Cell { origin: self.origin, vectors: [a, b, c], periodic: [true; 3] });
        }
        let [Some(x), Some(y), Some(z)] = self.low else { return None };
        let origin = DVec3::new(x, y, z);
        let size = DVec3::from_array(self.high) - origin;
        let [xy, xz, yz] = self.tilts.unwrap_or_default();
        let vectors =
            [DVec3::new(size.x, 0.0, 0.0), DVec3::new(xy, size.y, 0.0), DVec3::new(xz, yz, size.z)];
        Some(Cell { origin, vectors, periodic: [true; 3] })
    }
}

/// The values of a line before a comment.
pub(super) fn values(line: &[u8]) -> Vec<&[u8]> {
    tokens(line.split(|&byte| byte == b'#').next().unwrap_or_default()).collect()
}
