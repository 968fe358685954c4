//! What decides the pixels.

use std::path::{Path, PathBuf};

use serde_json::{Value, json};

use crate::accel::Backend;
use crate::error::{Error, Result};
use crate::output::Record;
use crate::scene::description::Window;
use crate::scene::{Identity, Ingredient, Override, Scene};

use super::shares::{corners, read_window};
use super::{COMMIT, Counts, Shares, VERSION};

/// All that decides the pixels of a picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Made {
    /// The program's version.
    pub version: String,
    /// The commit that it was built from.
    pub commit: String,
    /// What may be added up: see [`Scene::identity`].
    pub identity: Identity,
    /// The intersector with its version, as in `embree 4.3.3`.
    pub intersector: String,
    /// The scene.
    pub source: Source,
    /// Pixels of the whole picture, across and down.
    pub size: [u32; 2],
    /// The part of it that this is.
    pub crop: Option<Window>,
    /// Which samples of each pixel.
    pub samples: Samples,
    /// How many of them in each tile, where that differs.
    pub counts: Counts,
    /// The samples of each of its parts, where those two do not tell it.
    pub shares: Shares,
    /// The number of samples per pixel that the samples are spread over, where it changes each of them.
    pub spread_over: Option<u32>,
    /// Chooses the random numbers.
    pub seed: u64,
    /// The options that bias the picture.
    pub biased: Vec<String>,
}

/// What the scene was read from.
#[derive(Clone, Debug, PartialEq)]
pub struct Source {
    /// The text of the scene file; `None` where it is too long to go along.
    pub text: Option<String>,
    /// The hash of that text.
    pub hash: Identity,
    /// The keys that options set, with their values, but for those that say which samples of which
    /// pixels are taken.
    pub options: Vec<(String, String)>,
    /// The files that it needs, as the scene names them, with the hashes of what is in them.
    pub files: Vec<Ingredient>,
}

/// The indices of the samples that a picture holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Samples {
    /// The first of every pixel.
    pub first: u32,
    /// The number of samples of the pixel that has the fewest.
    pub fewest: u32,
    /// The number of samples of the pixel that has the most.
    pub most: u32,
}

/// The keys of options that are told as numbers of their own, or are not needed.
const TOLD_ELSEWHERE: [&str; 3] = ["image.crop", "render.samples_per_pixel", "render.seed"];

impl Made {
    /// Of a picture of the scene that holds these samples.
    pub fn new(scene: &Scene, backend: Backend, samples: Samples) -> Self {
        let intersector = backend.name_and_version();
        let description = scene.description();
        let render = &description.render;
        Self {
            version: VERSION.to_owned(),
            commit: COMMIT.to_owned(),
            identity: scene.identity(&intersector),
            intersector,
            source: Source::of(scene),
            size: [description.image.width, description.image.height],
            crop: description.image.crop,
            samples,
            counts: Counts::default(),
            shares: Shares::default(),
            spread_over: render.sampler.depends_on_count().then_some(render.samples_per_pixel),
            seed: render.seed,
            biased: render.biases(),
        }
    }

    /// As records of a file.
    pub fn records(&self) -> Vec<Record> {
        let [width, height] = self.size;
        let mut records = vec![
            Record::new("version", &self.version),
            Record::new("commit", &self.commit),
            Record::new("identity", self.identity.to_string()),
            Record::new("intersector", &self.intersector),
            Record::new("size", format!("{width}x{height}")),
            Record::new("samples", self.samples_in_words()),
            Record::new("seed", self.seed.to_string()),
            Record::new("scene-hash", self.source.hash.to_string()),
        ];
        records.extend(self.crop.map(|crop| Record::new("crop", corners(&crop))));
        if !self.counts.0.is_empty() {
            records.push(Record::new("counts", self.counts.to_string()));
        }
        if !self.shares.is_empty() {
            records.push(Record::new("parts", self.shares.to_string()));
        }
        let spread_over = self.spread_over.map(|count| count.to_string());
        records.extend(spread_over.map(|count| Record::new("spread-over", count)));
        if !self.biased.is_empty() {
            records.push(Record::new("biased", self.biased.join(", ")));
        }
        let Source { text, options, files, .. } = &self.source;
        if !options.is_empty() {
            let options = options.iter().map(|(key, value)| format!("{key}={value}"));
            records.push(Record::new("options", Value::from_iter(options).to_string()));
        }
        if !files.is_empty() {
            let file = |Ingredient { file, hash }: &Ingredient| json!({ "file": file, "hash": hash.to_string() });
            records
                .push(Record::new("files", Value::from_iter(files.iter().map(file)).to_string()));
        }
        records.extend(text.as_ref().map(|text| Record::new("scene", text)));
        records
    }

    /// From the records of a file.
    ///
    /// # Errors
    /// When one is missing or makes no sense; the message names the picture.
    pub fn read(picture: &Path, records: &[Record]) -> Result<Self> {
        let from = Reader { picture, records };
        let shares = from.optional("parts", Shares::read)?.unwrap_or_default();
        Ok(Self {
            version: from.text("version")?.to_owned(),
            commit: from.text("commit")?.to_owned(),
            identity: from.parsed("identity", |text| text.parse().ok())?,
            intersector: from.text("intersector")?.to_owned(),
            source: Source {
                text: from.get("scene").map(str::to_owned),
                hash: from.parsed("scene-hash", |text| text.parse().ok())?,
                options: from.optional("options", options)?.unwrap_or_default(),
                files: from.optional("files", files)?.unwrap_or_default(),
            },
            size: from.parsed("size", |text| numbers(&text.replace('x', ",")))?,
            crop: from.optional("crop", read_window)?,
            samples: match shares.is_empty() {
                true => from.parsed("samples", Samples::read)?,
                false => shares.samples(),
            },
            counts: from.optional("counts", Counts::read)?.unwrap_or_default(),
            shares,
            spread_over: from.optional("spread-over", |text| text.parse().ok())?,
            seed: from.parsed("seed", |text| text.parse().ok())?,
            biased: from
                .get("biased")
                .map(|text| text.split(", ").map(str::to_owned).collect())
                .unwrap_or_default(),
        })
    }

    /// The indices of the samples: `0..64`, or `0..16, 32..64` where some are missing in between, and
    /// whether every pixel has them.
    pub fn samples_in_words(&self) -> String {
        if self.shares.is_empty() {
            return self.samples.to_string();
        }
        let [width, height] = self.size;
        let whole = self.crop.unwrap_or(Window { x: 0, y: 0, width, height });
        let ranges = self.shares.ranges();
        if self.shares.are_all_of(&whole) {
            ranges
        } else {
            format!("{ranges} (some pixels lack some)")
        }
    }

    /// The options that make the same picture of the same scene file.
    pub fn overrides(&self) -> Vec<Override> {
        let setting = |key: &str, value: String| Override {
            option: format!("--set {key}={value}"),
            key: key.to_owned(),
            value,
        };
        let Samples { first, most, .. } = self.samples;
        let samples = self.spread_over.unwrap_or(first + most);
        let mut overrides: Vec<_> =
            self.source.options.iter().map(|(key, value)| setting(key, value.clone())).collect();
        overrides.push(setting("render.seed", self.seed.to_string()));
        overrides.push(setting("render.samples_per_pixel", samples.to_string()));
        if let Some(Window { x, y, width, height }) = self.crop {
            let corners = format!("[{x}, {y}, {}, {}]", x + width, y + height);
            overrides.push(setting("image.crop", corners));
        }
        overrides
    }
}

impl Source {
    fn of(scene: &Scene) -> Self {
        let of = scene.ingredients();
        let is_told_here = |option: &&Override| !TOLD_ELSEWHERE.contains(&&*option.key);
        let option = |option: &Override| (option.key.clone(), option.value.clone());
        let file = |file: &Ingredient| {
            let name = file.file.strip_prefix(&of.folder).unwrap_or(&file.file);
            Ingredient { file: name.to_path_buf(), hash: file.hash }
        };
        Self {
            text: of.text.clone(),
            hash: of.text_hash,
            options: of.options.iter().filter(is_told_here).map(option).collect(),
            files: of.files.iter().map(file).collect(),
        }
    }
}

impl Samples {
    /// All samples of the whole picture up to this number.
    pub fn all(count: u32) -> Self {
        Self { first: 0, fewest: count, most: count }
    }

    /// What [`Display`](std::fmt::Display) writes.
    pub(super) fn read(text: &str) -> Option<Self> {
        let (range, most) = text.split_once(" to ").unwrap_or((text, ""));
        let (first, end) = range.split_once("..")?;
        let first: u32 = first.parse().ok()?;
        let fewest = end.parse::<u32>().ok()?.checked_sub(first)?;
        let most = if most.is_empty() { end.parse().ok()? } else { most.parse::<u32>().ok()? };
        Some(Self { first, fewest, most: most.checked_sub(first)? })
    }
}

/// `0..64`, and `0..64 to 512` where pixels have from 64 to 512 samples.
impl std::fmt::Display for Samples {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { first, fewest, most } = self;
        write!(f, "{first}..{}", first + fewest)?;
        if most > fewest { write!(f, " to {}", first + most) } else { Ok(()) }
    }
}

/// Looks records up by their names.
struct Reader<'a> {
    picture: &'a Path,
    records: &'a [Record],
}

impl<'a> Reader<'a> {
    fn get(&self, name: &str) -> Option<&'a str> {
        self.records.iter().find(|record| record.name == name).map(|record| &*record.text)
    }

    fn text(&self, name: &str) -> Result<&'a str> {
        let picture = self.picture.display();
        self.get(name).ok_or_else(|| {
            Error::input(format!("`{picture}` does not say how it was made: `{name}` is missing"))
                .with_help(
                    "pictures say it since version 0.2; other programs may drop it on saving",
                )
        })
    }

    fn parsed<T>(&self, name: &str, parse: impl Fn(&str) -> Option<T>) -> Result<T> {
        let text = self.text(name)?;
        parse(text).ok_or_else(|| {
            let picture = self.picture.display();
            Error::input(format!(
                "`{picture}` says `{name}` in a way that is not understood: {text}"
            ))
            .with_help("it may be of a newer version of photosphere")
        })
    }

    fn optional<T>(&self, name: &str, parse: impl Fn(&str) -> Option<T>) -> Result<Option<T>> {
        self.get(name).map(|_| self.parsed(name, parse)).transpose()
    }
}

fn numbers<const N: usize>(text: &str) -> Option<[u32; N]> {
    let numbers: Option<Vec<u32>> = text.split(',').map(|number| number.parse().ok()).collect();
    numbers?.try_into().ok()
}

fn options(text: &str) -> Option<Vec<(String, String)>> {
    let list: Vec<String> = serde_json::from_str(text).ok()?;
    let split = |option: String| {
        let (key, value) = option.split_once('=')?;
        Some((key.to_owned(), value.to_owned()))
    };
    list.into_iter().map(split).collect()
}

fn files(text: &str) -> Option<Vec<Ingredient>> {
    let list: Vec<Value> = serde_json::from_str(text).ok()?;
    let file = |value: Value| {
        let text = |key: &str| value.get(key).and_then(Value::as_str);
        Some(Ingredient { file: PathBuf::from(text("file")?), hash: text("hash")?.parse().ok()? })
    };
    list.into_iter().map(file).collect()
}
