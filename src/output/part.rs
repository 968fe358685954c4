//! Parts: films as files, to be gone on with or added up. A checkpoint is a part too.
//!
//! All numbers are little-endian. A part is
//!
//! - the eight bytes `PHSPPART` and the version of this format, a u32;
//! - the length of the head, a u32, and the head, JSON: which pixels and samples, the layers, and
//!   [`Record`]s of how it was made;
//! - the BLAKE3 hash of all bytes so far;
//! - every tile of the film, as its length, a u32, and its bytes (`film::bytes` says which);
//! - the BLAKE3 hash of all bytes so far. Nothing follows.
//!
//! So no file that was cut off or changed is taken for a good one, and what it says of itself is
//! checked before it is believed.

use std::fs::File;
use std::io::{self, BufReader, Read, Write};
use std::ops::Range;
use std::path::{Path, PathBuf};

use blake3::Hasher;
use serde_json::{Value, json};

use crate::error::{Error, Result};
use crate::film::{BLOCK, Film, Format, Frame, Layer, Rect, Scale};

use super::{Record, WholeFile};

const MAGIC: [u8; 8] = *b"PHSPPART";

/// The version of the format; it grows with every change.
const VERSION: u32 = 1;

/// The longest head: a scene's text, and some.
const LONGEST_HEAD: u32 = 16 << 20;

/// The longest tile: its 64 pixels of some 30 numbers take a tenth of it.
const LONGEST_TILE: u32 = 1 << 20;

/// The most pixels along a picture.
const WIDEST: u64 = 1 << 24;

/// What a part says of itself.
#[derive(Clone, Debug, PartialEq)]
pub struct PartHead {
    /// What the film holds.
    pub format: Format,
    /// The indices of the samples that every pixel is to have in the end.
    pub samples: Range<u32>,
    /// How it was made.
    pub records: Vec<Record>,
}

/// A part that is being read: its head is good.
#[derive(Debug)]
pub struct PartFile {
    path: PathBuf,
    head: PartHead,
    from: Hashing<BufReader<File>>,
    bytes: u64,
}

/// Whether a file begins as a part does.
pub fn is_part_file(path: &Path) -> bool {
    let mut magic = [0; 8];
    let read = |mut file: File| file.read_exact(&mut magic);
    // Nothing else is opened: reading from a pipe would take from it.
    path.is_file() && File::open(path).and_then(read).is_ok() && magic == MAGIC
}

/// Writes a part. The film may be added to meanwhile: every tile is written as it then is.
///
/// # Errors
/// When the disk refuses; a file that was there before is then unchanged.
pub fn write_part(
    file: &WholeFile,
    film: &Film,
    samples: &Range<u32>,
    records: &[Record],
) -> Result<()> {
    let head = head(&film.format(), samples, records);
    file.write(|sink| {
        let mut to = Hashing { inner: sink, hasher: Hasher::new(), bytes: 0 };
        to.write_all(&MAGIC)?;
        to.write_all(&VERSION.to_le_bytes())?;
        to.write_all(&length(&head)?.to_le_bytes())?;
        to.write_all(head.as_bytes())?;
        to.write_hash()?;
        let mut bytes = Vec::new();
        for tile in 0..film.frame().tiles() {
            bytes.clear();
            film.write_tile(tile, &mut bytes);
            to.write_all(&length(&bytes)?.to_le_bytes())?;
            to.write_all(&bytes)?;
        }
        to.write_hash()
    })
}

fn length(of: impl AsRef<[u8]>) -> io::Result<u32> {
    of.as_ref().len().try_into().map_err(io::Error::other)
}

impl PartFile {
    /// Opens a part and reads its head.
    ///
    /// # Errors
    /// When it cannot be read, is no part, or one of a newer version, or is damaged.
    pub fn open(path: &Path) -> Result<Self> {
        let trouble = |e: io::Error| Error::file("read", path, e);
        let file = File::open(path).map_err(trouble)?;
        let metadata = file.metadata().map_err(trouble)?;
        if metadata.is_dir() {
            return Err(Error::file("read", path, "it is a folder"));
        }
        let bytes = metadata.len();
        let inner = BufReader::with_capacity(1 << 16, file);
        let mut from = Hashing { inner, hasher: Hasher::new(), bytes: 0 };
        let head = read_head(&mut from, bytes).map_err(|bad| bad.told(path))?;
        Ok(Self { path: path.to_path_buf(), head, from, bytes })
    }

    /// What it says of itself.
    pub fn head(&self) -> &PartHead {
        &self.head
    }

    /// Its place.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Reads the film.
    ///
    /// # Errors
    /// When it cannot be read, or is damaged.
    pub fn film(mut self) -> Result<Film> {
        self.read_film().map_err(|bad| bad.told(&self.path))
    }

    fn read_film(&mut self) -> std::result::Result<Film, Bad> {
        let format = &self.head.format;
        let tiles = format.frame.tiles();
        // A tile takes five bytes at least.
        if tiles as u64 > self.bytes / 5 {
            return Err(Bad::CutOff(self.bytes));
        }
        let mut film = Film::without_memory(format);
        let mut bytes = Vec::new();
        for tile in 0..tiles {
            let length = self.from.u32()?;
            if length > LONGEST_TILE {
                return Err(Bad::Damaged("a length makes no sense"));
            }
            bytes.resize(length as usize, 0);
            self.from.fill(&mut bytes)?;
            if !film.read_tile(tile, &bytes) {
                return Err(Bad::Damaged("some sums make no sense"));
            }
        }
        self.from.check_hash()?;
        match self.from.inner.read(&mut [0]) {
            Ok(0) => Ok(film),
            Ok(_) => Err(Bad::Damaged("something follows its end")),
            Err(e) => Err(Bad::Unreadable(e)),
        }
    }
}

/// What keeps a file from being read as a part.
#[derive(Debug)]
enum Bad {
    Unreadable(io::Error),
    NoPart,
    Newer(u32),
    CutOff(u64),
    Damaged(&'static str),
    Unknown(String),
}

impl Bad {
    fn told(self, path: &Path) -> Error {
        let refused = |reason: String| Error::file("read", path, reason);
        match self {
            Self::Unreadable(e) => refused(e.to_string()),
            Self::NoPart => refused("it is no part and no checkpoint".to_owned())
                .with_help("name a file that `photosphere render` wrote with -o FILE.part or --checkpoint FILE"),
            Self::Newer(version) => refused(format!(
                "it is written in version {version} of the format, and this program knows versions up \
                 to {VERSION}"
            ))
            .with_help("use the photosphere that wrote it, or a newer one"),
            Self::CutOff(at) => refused(format!("it is cut off after {at} bytes"))
                .with_help("copy it again, or render this part again"),
            Self::Damaged(what) => refused(format!("it is damaged: {what}"))
                .with_help("copy it again, or render this part again"),
            Self::Unknown(what) => refused(what).with_help("use the photosphere that wrote it"),
        }
    }
}

impl From<io::Error> for Bad {
    fn from(error: io::Error) -> Self {
        Self::Unreadable(error)
    }
}

fn head(format: &Format, samples: &Range<u32>, records: &[Record]) -> String {
    let Rect { x, y, width, height } = format.frame.window;
    let records: Vec<Value> =
        records.iter().map(|record| json!([record.name, record.text])).collect();
    json!({
        "full_size": format.frame.full_size,
        "window": [x, y, width, height],
        "samples": [samples.start, samples.end],
        "brightest": format.scale.exponent(),
        "layers": format.layers.iter().map(|layer| layer.name()).collect::<Vec<_>>(),
        "squares": format.squares,
        "records": records,
    })
    .to_string()
}

fn read_head(
    from: &mut Hashing<BufReader<File>>,
    bytes: u64,
) -> std::result::Result<PartHead, Bad> {
    let mut magic = [0; 8];
    match from.fill(&mut magic) {
        Ok(()) if magic == MAGIC => {}
        Ok(()) | Err(Bad::CutOff(_)) => return Err(Bad::NoPart),
        Err(other) => return Err(other),
    }
    let version = from.u32()?;
    if version > VERSION {
        return Err(Bad::Newer(version));
    }
    let length = from.u32()?;
    if length > LONGEST_HEAD {
        return Err(Bad::Damaged("its head is too long"));
    }
    if u64::from(length) > bytes {
        return Err(Bad::CutOff(bytes));
    }
    let mut text = vec![0; length as usize];
    from.fill(&mut text)?;
    from.check_hash()?;
    let value: Value =
        serde_json::from_slice(&text).map_err(|_| Bad::Damaged("its head is no JSON"))?;
    parse_head(&value)
}

fn parse_head(value: &Value) -> std::result::Result<PartHead, Bad> {
    let incomplete = || Bad::Damaged("its head says something impossible");
    let layers = value.get("layers").and_then(Value::as_array).ok_or_else(incomplete)?;
    let layer = |name: &Value| {
        let name = name.as_str().ok_or_else(incomplete)?;
        let known = Layer::ALL.iter().find(|layer| layer.name() == name).copied();
        known
            .ok_or_else(|| Bad::Unknown(format!("it holds the layer `{name}`, which is not known")))
    };
    let layers: Vec<Layer> = layers.iter().map(layer).collect::<std::result::Result<_, Bad>>()?;
    let read = || -> Option<PartHead> {
        let full_size: [u32; 2] = numbers(value.get("full_size")?)?;
        let [x, y, width, height] = numbers(value.get("window")?)?;
        let [first_sample, end] = numbers(value.get("samples")?)?;
        let fits = |first: u32, length: u32, full: u32| {
            length > 0
                && u64::from(first) + u64::from(length) <= u64::from(full)
                && u64::from(full) <= WIDEST
        };
        let is_twice = |(at, layer): (usize, &Layer)| layers[..at].contains(layer);
        let is_good = fits(x, width, full_size[0])
            && fits(y, height, full_size[1])
            && first_sample % BLOCK == 0
            && first_sample <= end
            && !layers.iter().enumerate().any(is_twice);
        let format = Format {
            frame: Frame { full_size, window: Rect { x, y, width, height } },
            first_sample,
            scale: Scale::of_exponent(value.get("brightest")?.as_i64()?.try_into().ok()?)?,
            layers: layers.clone(),
            squares: value.get("squares")?.as_bool()?,
        };
        let record =
            |pair: &Value| Some(Record::new(pair.get(0)?.as_str()?, pair.get(1)?.as_str()?));
        let records =
            value.get("records")?.as_array()?.iter().map(record).collect::<Option<_>>()?;
        is_good.then_some(PartHead { format, samples: first_sample..end, records })
    };
    read().ok_or_else(incomplete)
}

fn numbers<const N: usize>(value: &Value) -> Option<[u32; N]> {
    let number = |value: &Value| value.as_u64()?.try_into().ok();
    let numbers: Option<Vec<u32>> = value.as_array()?.iter().map(number).collect();
    numbers?.try_into().ok()
}

/// A stream whose bytes are hashed as they go by.
#[derive(Debug)]
struct Hashing<S> {
    inner: S,
    hasher: Hasher,
    bytes: u64,
}

impl<S: Write> Hashing<S> {
    fn write_all(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.hasher.update(bytes);
        self.inner.write_all(bytes)
    }

    fn write_hash(&mut self) -> io::Result<()> {
        let hash = self.hasher.finalize();
        self.write_all(hash.as_bytes())
    }
}

impl<S: Read> Hashing<S> {
    fn fill(&mut self, bytes: &mut [u8]) -> std::result::Result<(), Bad> {
        let mut filled = 0;
        while filled < bytes.len() {
            match self.inner.read(&mut bytes[filled..]) {
                Ok(0) => return Err(Bad::CutOff(self.bytes + filled as u64)),
                Ok(count) => filled += count,
                Err(e) if e.kind() == io::ErrorKind::Interrupted => {}
                Err(e) => return Err(Bad::Unreadable(e)),
            }
        }
        self.bytes += filled as u64;
        self.hasher.update(bytes);
        Ok(())
    }

    fn u32(&mut self) -> std::result::Result<u32, Bad> {
        let mut bytes = [0; 4];
        self.fill(&mut bytes)?;
        Ok(u32::from_le_bytes(bytes))
    }

    fn check_hash(&mut self) -> std::result::Result<(), Bad> {
        let expected = self.hasher.finalize();
        let mut hash = [0; 32];
        self.fill(&mut hash)?;
        let is_same = expected == hash;
        is_same.then_some(()).ok_or(Bad::Damaged("its checksum is wrong"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::color::{Radiance, Rgb, Seen};
    use crate::film::Run;
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
                .map(|i| Radiance {
                    direct: Rgb::splat((i % 97) as f32 * 0.013),
                    ..Default::default()
                })
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
}
