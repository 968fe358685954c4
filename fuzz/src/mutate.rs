//! Mutations of text that keep its form: numbers become other numbers, words other words, and lines
//! come and go. Random bytes alone rarely make another scene of a scene.

use std::ops::Range;
use std::sync::OnceLock;

use libfuzzer_sys::fuzzer_mutate;
use photosphere::scene::keys;
use serde_json::Value;

/// Numbers at the edges of what types and formulas can do.
const NUMBERS: [&str; 44] = [
    "0",
    "-0.0",
    "1",
    "-1",
    "2",
    "3",
    "4",
    "16",
    "0.5",
    "0.1",
    "0.25",
    "0.999999",
    "1.000001",
    "1e-3",
    "1e-7",
    "1e-15",
    "1e-30",
    "1e-38",
    "1e-45",
    "1e-300",
    "5e-324",
    "10",
    "100",
    "1e3",
    "1e5",
    "1e7",
    "1e15",
    "1e19",
    "1e30",
    "3.4e38",
    "1e39",
    "1e100",
    "1e154",
    "1e300",
    "1.7976931348623157e308",
    "nan",
    "inf",
    "-inf",
    "255",
    "65536",
    "2147483648",
    "4294967295",
    "9007199254740993",
    "18446744073709551615",
];

/// Changes the first `size` bytes of `data`, and returns how many there are now.
pub fn text(data: &mut [u8], size: usize, max_size: usize, seed: u32) -> usize {
    let mut rng = Rng(u64::from(seed).wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1);
    if rng.below(3) == 0 {
        return fuzzer_mutate(data, size, max_size);
    }
    let input = data[..size].to_vec();
    let edit = match rng.below(6) {
        0 => edit_lines(&input, &mut rng),
        _ => edit_token(&input, &mut rng),
    };
    let Some((range, new)) = edit else { return fuzzer_mutate(data, size, max_size) };
    let output = [&input[..range.start], &new, &input[range.end..]].concat();
    if output.len() > max_size {
        return fuzzer_mutate(data, size, max_size);
    }
    data[..output.len()].copy_from_slice(&output);
    output.len()
}

/// Replaces a number or a word.
fn edit_token(input: &[u8], rng: &mut Rng) -> Option<(Range<usize>, Vec<u8>)> {
    let tokens = tokens(input);
    let range = rng.pick(&tokens)?.clone();
    let old = std::str::from_utf8(&input[range.clone()]).ok()?;
    let new = match old.parse::<f64>() {
        Ok(number) => other_number(number, rng),
        Err(_) if rng.below(2) == 0 => rng.pick(words())?.as_bytes().to_vec(),
        Err(_) => input[rng.pick(&tokens)?.clone()].to_vec(),
    };
    Some((range, new))
}

fn other_number(number: f64, rng: &mut Rng) -> Vec<u8> {
    let is_whole = number.fract() == 0.0 && number.abs() < 1e18;
    let changed = match rng.below(9) {
        0 => -number,
        1 => number * 2.0,
        2 => number / 2.0,
        3 => number * 1e-3,
        4 => number + 1.0,
        5 if !is_whole => f64::from_bits(number.to_bits().wrapping_add(1)),
        6 => (rng.next() as f64) / (u64::MAX as f64),
        _ => return rng.pick(&NUMBERS).map_or(Vec::new(), |text| text.as_bytes().to_vec()),
    };
    match is_whole && changed.fract() == 0.0 {
        true => format!("{changed:.0}").into_bytes(),
        false => format!("{changed:?}").into_bytes(),
    }
}

/// Copies a few lines to another place, or removes them.
fn edit_lines(input: &[u8], rng: &mut Rng) -> Option<(Range<usize>, Vec<u8>)> {
    let breaks = input.iter().enumerate().filter(|(_, byte)| matches!(byte, b'\n' | 0));
    let starts: Vec<usize> = std::iter::once(0).chain(breaks.map(|(at, _)| at + 1)).collect();
    let first = rng.below(starts.len());
    let last = (first + 1 + rng.below(4)).min(starts.len() - 1);
    let lines = starts[first]..starts[last.max(first)];
    if lines.is_empty() {
        return None;
    }
    if rng.below(2) == 0 {
        return Some((lines, Vec::new()));
    }
    let to = *rng.pick(&starts)?;
    Some((to..to, input[lines].to_vec()))
}

/// Where the numbers and words are.
fn tokens(input: &[u8]) -> Vec<Range<usize>> {
    let is_part =
        |byte: u8| byte.is_ascii_alphanumeric() || matches!(byte, b'_' | b'.' | b'-' | b'+');
    let mut tokens = Vec::new();
    let mut start = None;
    for (at, byte) in input.iter().enumerate() {
        match (start, is_part(*byte)) {
            (None, true) => start = Some(at),
            (Some(begin), false) => {
                tokens.push(begin..at);
                start = None;
            }
            _ => {}
        }
    }
    tokens.extend(start.map(|begin| begin..input.len()));
    tokens
}

/// The keys of scenes, and the names that they accept.
fn words() -> &'static [String] {
    static WORDS: OnceLock<Vec<String>> = OnceLock::new();
    WORDS.get_or_init(|| {
        let mut words = Vec::new();
        collect(&keys::schema(), &mut words);
        words.sort();
        words.dedup();
        words
    })
}

fn collect(value: &Value, words: &mut Vec<String>) {
    match value {
        Value::String(text) if !text.contains(' ') => words.push(text.clone()),
        Value::Array(list) => list.iter().for_each(|value| collect(value, words)),
        Value::Object(fields) => fields.iter().for_each(|(name, value)| {
            words.push(name.clone());
            collect(value, words);
        }),
        _ => {}
    }
}

/// A small generator, seeded by libFuzzer.
struct Rng(u64);

impl Rng {
    fn next(&mut self) -> u64 {
        // xorshift64* (Vigna 2016).
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        self.0.wrapping_mul(0x2545_F491_4F6C_DD1D)
    }

    fn below(&mut self, end: usize) -> usize {
        ((u128::from(self.next()) * end as u128) >> 64) as usize
    }

    fn pick<'a, T>(&mut self, list: &'a [T]) -> Option<&'a T> {
        if list.is_empty() { None } else { Some(&list[self.below(list.len())]) }
    }
}
