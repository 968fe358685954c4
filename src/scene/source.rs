//! The source of a scene, and its identity: scenes with the same [`ContentHash`] are identical,
//! whether they come from a file or a program.
//!
//! The identity is the hash of a canonical encoding of the description: JSON with fields in
//! declaration order, in which each table and image is replaced by the hash of its numbers.
//! Equivalent values have the same encoding: a camera is encoded by its axes, independent of the
//! length of `up`, and -0 as 0. The encoding excludes the folders of files, the layout of the scene
//! file, the program version, and the render settings.

use std::fmt;
use std::io;
use std::path::PathBuf;

use blake3::Hasher;
use rayon::prelude::*;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use serde_json::ser::Formatter;

use crate::camera::axes;
use crate::error::Error;
use crate::geometry::SphereRows;
use crate::math::DVec3;

use super::data::SphereData;
use super::description::{
    BackgroundDescription, CameraDescription, CameraFit, ColorStorage, EnvironmentDescription,
    FocusTarget, MaterialDescription, ProjectionDescription, SceneDescription, SphereDescription,
    SphereTable,
};
use super::environment::EnvironmentPixels;
use super::import::RowGroup;

/// Version of the encoding; it changes with everything that the hash depends on.
const ENCODING: u32 = 4;

/// A BLAKE3 hash: 32 bytes, or 64 hexadecimal digits as text.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct ContentHash([u8; 32]);

/// A file of a scene, with a hash of its values.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct FileHash {
    /// Path of the file as it was opened.
    #[serde(with = "super::paths")]
    pub file: PathBuf,
    /// Hash of the values, not the bytes: the column order of a table does not matter.
    pub hash: ContentHash,
}

/// The scene file from which a scene was read.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct SceneSource {
    /// Name of the scene file in messages.
    pub name: String,
    /// Path of the file, if there is one.
    #[serde(default, with = "super::paths::optional")]
    pub file: Option<PathBuf>,
    /// Base folder of relative paths.
    #[serde(with = "super::paths")]
    pub folder: PathBuf,
    /// Text of the file; `None` if it is too long to embed in a picture.
    pub text: Option<String>,
    /// Hash of the text.
    pub text_hash: ContentHash,
    /// The keys that options set, with their values.
    pub overrides: Vec<(String, String)>,
}

/// Rows hashed at a time, in parallel.
const ROWS_PER_CHUNK: usize = 1 << 16;

/// The data whose hash is the scene identity.
#[derive(Serialize)]
struct CanonicalScene<'a> {
    encoding: u32,
    camera: CanonicalCamera,
    background: BackgroundDescription,
    materials: &'a [MaterialDescription],
    spheres: &'a [SphereDescription],
    tables: Vec<CanonicalTable>,
    environment: Option<ContentHash>,
}

/// Everything that a camera's rays depend on.
#[derive(Serialize)]
struct CanonicalCamera {
    position: DVec3,
    right: DVec3,
    forward: DVec3,
    near: f64,
    projection: ProjectionDescription,
    #[serde(skip_serializing_if = "Option::is_none")]
    fit: Option<CameraFit>,
    #[serde(skip_serializing_if = "Option::is_none")]
    focus_target: Option<FocusTarget>,
}

impl CanonicalCamera {
    fn of(camera: &CameraDescription) -> Self {
        let CameraDescription { position, look_at, up, near, projection, fit, focus_target } =
            *camera;
        let [right, _, forward] = match fit {
            // The axes follow from the direction, and from what is up.
            Some(_) => [up.normalize(), DVec3::ZERO, DVec3::ZERO],
            None => axes(look_at - position, up),
        };
        Self { position, right, forward, near, projection, fit, focus_target }
    }
}

#[derive(Serialize)]
struct CanonicalTable {
    name: String,
    material: usize,
    colors: Option<ColorStorage>,
    numbers: ContentHash,
}

impl ContentHash {
    /// The 32 bytes.
    pub fn as_bytes(&self) -> &[u8; 32] {
        &self.0
    }

    /// Hashes these bytes.
    pub fn of_bytes(bytes: &[u8]) -> Self {
        Self(blake3::hash(bytes).into())
    }
}

impl Default for ContentHash {
    /// The hash of the empty byte string.
    fn default() -> Self {
        Self::of_bytes(&[])
    }
}

impl Serialize for ContentHash {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        to.collect_str(self)
    }
}

impl<'de> Deserialize<'de> for ContentHash {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        let digits = String::deserialize(from)?;
        digits.parse().map_err(serde::de::Error::custom)
    }
}

impl From<[u8; 32]> for ContentHash {
    fn from(bytes: [u8; 32]) -> Self {
        Self(bytes)
    }
}

impl fmt::Display for ContentHash {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&blake3::Hash::from_bytes(self.0).to_hex())
    }
}

impl std::str::FromStr for ContentHash {
    type Err = Error;

    /// Parses 64 hexadecimal digits.
    fn from_str(digits: &str) -> Result<Self, Error> {
        let hash = blake3::Hash::from_hex(digits);
        hash.map(|hash| Self(hash.into())).map_err(|error| {
            let message = format!("an identity is 64 hexadecimal digits, not {digits:?}");
            Error::input(message).with_source(error)
        })
    }
}

/// The files of a scene with their hashes, and the hash of each table.
pub(super) struct SceneHashes {
    tables: Vec<ContentHash>,
    environment: Option<ContentHash>,
    pub(super) files: Vec<FileHash>,
}

impl SceneHashes {
    /// Hashes the tables and the environment map.
    pub(super) fn new(
        description: &SceneDescription,
        rows: &SphereRows,
        groups: &[RowGroup],
        environment: Option<&EnvironmentPixels>,
    ) -> Self {
        let tables: Vec<ContentHash> = groups.iter().map(|group| hash_group(rows, group)).collect();
        let environment = environment.map(|pixels| ContentHash(pixels.hash().into()));
        let of_table = |(table, hash): (&SphereTable, &ContentHash)| match &table.data {
            SphereData::File { path, .. } => Some(FileHash { file: path.clone(), hash: *hash }),
            SphereData::Particles(particles) => {
                Some(FileHash { file: particles.path.clone(), hash: *hash })
            }
            SphereData::Memory(_) => None,
        };
        let mut files: Vec<FileHash> =
            description.tables.iter().zip(&tables).filter_map(of_table).collect();
        if let (EnvironmentDescription::Image { file, .. }, Some(hash)) =
            (&description.background.dome, environment)
        {
            files.push(FileHash { file: file.clone(), hash });
        }
        Self { tables, environment, files }
    }

    /// The identity of the scene.
    pub(super) fn scene_hash(&self, description: &SceneDescription) -> ContentHash {
        let SceneDescription { camera, background, materials, spheres, tables } = description;
        let mut background = background.clone();
        if let EnvironmentDescription::Image { file, .. } = &mut background.dome {
            file.clear();
        }
        let table = |(index, (table, numbers)): (usize, (&SphereTable, &ContentHash))| {
            let SphereTable { name: _, data, material, colors, color_space: _, offset: _ } = table;
            let name = description.name_of_table(index);
            let colors = data.has_colors().then_some(*colors);
            CanonicalTable { name, material: *material, colors, numbers: *numbers }
        };
        let canonical = CanonicalScene {
            encoding: ENCODING,
            camera: CanonicalCamera::of(camera),
            background,
            materials,
            spheres,
            tables: tables.iter().zip(&self.tables).enumerate().map(table).collect(),
            environment: self.environment,
        };
        let mut hasher = Hasher::new();
        let mut json = serde_json::Serializer::with_formatter(&mut hasher, OneZero);
        let written = canonical.serialize(&mut json);
        written.expect("plain values with names as their keys are JSON");
        ContentHash(hasher.finalize().into())
    }
}

/// JSON without whitespace, in which -0 is written as 0.
struct OneZero;

impl Formatter for OneZero {
    fn write_f32<W: ?Sized + io::Write>(&mut self, to: &mut W, value: f32) -> io::Result<()> {
        serde_json::ser::CompactFormatter.write_f32(to, value + 0.0)
    }

    fn write_f64<W: ?Sized + io::Write>(&mut self, to: &mut W, value: f64) -> io::Result<()> {
        serde_json::ser::CompactFormatter.write_f64(to, value + 0.0)
    }
}

/// Hash of a table's numbers, in f32 if the table is, so that equal numbers have equal hashes
/// wherever they come from.
fn hash_group(rows: &SphereRows, group: &RowGroup) -> ContentHash {
    let (first, count) = (group.first_row as usize, group.count as usize);
    let mut hasher = Hasher::new();
    hasher.update(&(count as u64).to_le_bytes());
    match first.checked_sub(rows.exact.len()) {
        Some(first) => {
            hash_rows(&mut hasher, count, |row| rows.table[first + row].map(f32::to_le_bytes))
        }
        None => {
            let exact = &rows.exact[first..first + count];
            let numbers = |row: usize| {
                let [x, y, z] = exact[row].center.to_array();
                [x, y, z, exact[row].radius]
            };
            let fits = |row: usize| numbers(row).iter().all(|x| f64::from(*x as f32) == *x);
            if (0..count).into_par_iter().all(fits) {
                let narrow = |row| numbers(row).map(|x| (x as f32).to_le_bytes());
                hash_rows(&mut hasher, count, narrow);
            } else {
                hash_rows(&mut hasher, count, |row| numbers(row).map(f64::to_le_bytes));
            }
        }
    }
    if let Some(colors) = &group.colors {
        let color = |row| colors.get(row).to_array().map(f32::to_le_bytes);
        hash_rows(&mut hasher, colors.len(), color);
    }
    if let Some(emission) = &group.emission {
        // Tells emission from colours; tables without emission keep the hash that they had.
        hasher.update(b"emission");
        hash_rows(&mut hasher, emission.len(), |row| emission[row].map(f32::to_le_bytes));
    }
    if let Some(ids) = &group.ids {
        let ids = ids.as_slice();
        hash_rows(&mut hasher, ids.len(), |row| [ids[row].to_le_bytes()]);
    }
    ContentHash(hasher.finalize().into())
}

fn hash_rows<const N: usize, const B: usize>(
    hasher: &mut Hasher,
    count: usize,
    numbers: impl Fn(usize) -> [[u8; B]; N] + Sync,
) {
    let hash_of_piece = |piece: usize| {
        let rows = piece * ROWS_PER_CHUNK..count.min((piece + 1) * ROWS_PER_CHUNK);
        let mut bytes = Vec::with_capacity(rows.len() * N * B);
        rows.for_each(|row| bytes.extend_from_slice(numbers(row).as_flattened()));
        blake3::hash(&bytes)
    };
    let pieces = (0..count.div_ceil(ROWS_PER_CHUNK)).into_par_iter();
    let hashes: Vec<blake3::Hash> = pieces.map(hash_of_piece).collect();
    for hash in hashes {
        hasher.update(hash.as_bytes());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_identity_is_read_back_from_its_digits() {
        let identity = ContentHash::of_bytes(b"abc");
        // The first digits of the BLAKE3 hash of "abc", as printed by `b3sum`.
        assert!(identity.to_string().starts_with("6437b3ac38465133ffb63b75273a8db5"));
        assert_eq!(identity.to_string().parse::<ContentHash>().ok(), Some(identity));
        let error = "6437".parse::<ContentHash>().expect_err("too few digits");
        assert_eq!(error.to_string(), "an identity is 64 hexadecimal digits, not \"6437\"");
        assert!(std::error::Error::source(&error).is_some());
    }
}
