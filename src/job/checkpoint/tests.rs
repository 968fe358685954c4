//! Parts come back as they were, or are refused.

use serde_json::{Value, json};

use super::*;
use crate::color::{Radiance, Rgb, Seen};
use crate::film::{Format, Frame};
use crate::film::{Layer, Rect, Run, Scale};
use rand::{RngExt, SeedableRng, rngs::StdRng};

/// A part with finished and unfinished blocks and an empty tile, and its bytes.
fn part() -> (Film, Vec<Record>, Vec<u8>) {
    let window = Rect { x: 3, y: 2, width: 20, height: 7 };
    let format = Format {
        frame: Frame { full_size: [31, 17], window },
        first_sample: 32,
        scale: Scale::of_brightest(5.0),
        layers: Layer::ALL.to_vec(),
        squares: true,
    };
    let film = Film::new(&format).unwrap();
    for tile in 1..film.frame().tiles() {
        let count = 9 * tile as u32;
        let counts = vec![count; film.frame().tile(tile).pixels()];
        let samples: Vec<Radiance> = (0..counts.len() as u32 * count)
            .map(|i| Radiance { direct: Rgb::splat((i % 97) as f32 * 0.013), ..Default::default() })
            .collect();
        let seen = vec![Seen { row: 7, ..Seen::NOTHING }; samples.len()];
        film.add(tile, &counts, Run { light: &samples, seen: &seen }).unwrap();
    }
    let records = vec![Record::new("seed", "7"), Record::new("scene", "format = 1\n\"x\"")];
    let (_folder, path) = written(&film, &records);
    let bytes = std::fs::read(path).unwrap();
    (film, records, bytes)
}

fn written(film: &Film, records: &[Record]) -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.part");
    write_part(&WholeFile::new(&path).unwrap(), film, &(32..64), records).unwrap();
    (folder, path)
}

fn read(path: &Path) -> Result<(PartHead, Film)> {
    let part = PartFile::open(path)?;
    Ok((part.head().clone(), part.film()?))
}

/// What reading such bytes gives.
fn read_bytes(bytes: &[u8]) -> Result<(PartHead, Film)> {
    let file = tempfile::NamedTempFile::new().unwrap();
    std::fs::write(file.path(), bytes).unwrap();
    read(file.path())
}

#[test]
fn a_part_comes_back_as_it_was() {
    let (film, records, bytes) = part();
    let (head, back) = read_bytes(&bytes).unwrap();
    let format = film.format();
    assert_eq!(head, PartHead { format: format.clone(), samples: 32..64, records });
    assert_eq!(back.format(), format);
    assert_eq!((back.counts(), back.picture()), (film.counts(), film.picture()));
    // And is written again with the same bytes.
    let (_folder, path) = written(&back, &head.records);
    assert!(std::fs::read(path).unwrap() == bytes);
}

#[test]
fn cut_off_at_any_byte_a_part_is_refused() {
    let (_, _, bytes) = part();
    let lengths = (0..200).chain((200..bytes.len()).step_by(37)).chain([bytes.len() - 1]);
    for length in lengths {
        let error = read_bytes(&bytes[..length]).unwrap_err().to_string();
        let words = if length < 8 { "it is no part" } else { "it is cut off after" };
        assert!(error.contains(words), "{length}: {error}");
    }
    let error = read_bytes(&[&bytes[..], b"x"].concat()).unwrap_err().to_string();
    assert!(error.ends_with("it is damaged: something follows its end"), "{error}");
}

#[test]
fn thousands_of_random_changes_are_all_refused() {
    let (_, _, bytes) = part();
    let mut rng = StdRng::seed_from_u64(5);
    for round in 0..3000 {
        let mut changed = bytes.clone();
        for _ in 0..rng.random_range(1..4) {
            let at = match round % 3 {
                // The head's beginning has the numbers that are believed first.
                0 => rng.random_range(0..16),
                _ => rng.random_range(0..bytes.len()),
            };
            changed[at] = rng.random();
        }
        if changed == bytes {
            continue;
        }
        let error = read_bytes(&changed).unwrap_err().to_string();
        let reasons = ["no part", "version", "cut off", "damaged"];
        assert!(reasons.iter().any(|reason| error.contains(reason)), "{error}");
    }
}

#[test]
fn a_part_with_good_checksums_and_impossible_numbers_is_refused() {
    let (_, _, bytes) = part();
    let length = u32::from_le_bytes(bytes[12..16].try_into().unwrap()) as usize;
    let head: Value = serde_json::from_slice(&bytes[16..16 + length]).unwrap();
    let forged = |key: &str, value: Value| {
        let mut head = head.clone();
        head[key] = value;
        let head = head.to_string();
        let mut bytes = MAGIC.to_vec();
        bytes.extend(VERSION.to_le_bytes());
        bytes.extend((head.len() as u32).to_le_bytes());
        bytes.extend(head.as_bytes());
        bytes.extend(blake3::hash(&bytes).as_bytes());
        read_bytes(&bytes).unwrap_err().to_string()
    };
    let huge = u32::MAX;
    for (key, value, words) in [
        ("full_size", json!([huge, huge]), "impossible"),
        ("window", json!([3, 2, 40, 7]), "impossible"),
        ("window", json!([3, 2, 0, 7]), "impossible"),
        ("window", json!([huge, 2, huge, 7]), "impossible"),
        ("samples", json!([33, 64]), "impossible"),
        ("samples", json!([64, 32]), "impossible"),
        ("samples", json!([32]), "impossible"),
        ("brightest", json!(1000), "impossible"),
        ("layers", json!(["direct", "direct"]), "impossible"),
        ("layers", json!(["beauty of tomorrow"]), "`beauty of tomorrow`, which is not known"),
        ("layers", json!("direct"), "impossible"),
        ("records", json!([["name"]]), "impossible"),
        // No memory is taken for pixels whose bytes are not there.
        ("full_size", json!([1 << 24, 1 << 24]), "cut off"),
    ] {
        let error = forged(key, value);
        assert!(error.contains(words), "{key}: {error}");
    }
    let error = read_bytes(&[&bytes[..8], &2u32.to_le_bytes(), &bytes[12..]].concat());
    let error = error.unwrap_err();
    assert!(error.to_string().contains("version 2 of the format"), "{error}");
    assert!(error.help().unwrap().contains("newer"));
}
