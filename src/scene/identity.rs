//! What a picture of this scene depends on, as hashes: two pictures with one [`Identity`] show the
//! same thing to the bit where they hold the same samples, so their samples may be added up.
//!
//! In it are all keys of the scene as they stand after the options, all values of the sphere tables
//! and of the background's image, the seed, the program's version and the intersector. Not in it are
//! which samples of which pixels are taken, where files lie, how the scene file is laid out, threads,
//! and where the picture goes.

use std::fmt;
use std::path::{Path, PathBuf};

use blake3::Hasher;
use rayon::prelude::*;
use toml::de::{DeTable, DeValue};

use crate::geometry::SphereRows;

use super::colors::Colors;
use super::description::{Description, Dome, Integrator};
use super::environment::Pixels;
use super::import::RowGroup;
use super::overrides::Override;
use super::values::Node;

/// A BLAKE3 hash: 32 bytes, 64 hexadecimal digits in words.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Identity([u8; 32]);

/// A file beside the scene file, and a hash of what was read from it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Ingredient {
    /// The file, as it was opened.
    pub file: PathBuf,
    /// Of its values, not of its bytes: the order of a table's columns does not count.
    pub hash: Identity,
}

/// All that a scene is made of: enough to make it again, and to tell whether it is the same.
#[derive(Clone, Debug)]
pub struct Ingredients {
    /// The scene file's name, as it was given.
    pub name: String,
    /// The folder in which relative paths of the scene start.
    pub folder: PathBuf,
    /// The scene file's text; `None` where that is longer than a picture should carry.
    pub text: Option<String>,
    /// The hash of that text.
    pub text_hash: Identity,
    /// The options that changed it.
    pub options: Vec<Override>,
    /// The sphere tables in the order of the file, then the background's image.
    pub files: Vec<Ingredient>,
    /// Of the keys and values after the options.
    document: Identity,
}

/// What the command line and the scene file said, before anything was looked up.
pub(super) struct Words<'a> {
    pub(super) name: &'a str,
    pub(super) folder: &'a Path,
    pub(super) text: &'a str,
    pub(super) options: &'a [Override],
    pub(super) document: Identity,
}

/// The longest scene text, in bytes, that goes along with a scene.
const LONGEST_TEXT: usize = 1 << 20;

/// Rows that are hashed at a time, in parallel.
const ROWS: usize = 1 << 16;

/// The keys that the document's hash leaves out: which samples of which pixels are taken (where that
/// says more, [`Ingredients::identity`] adds it), the seed, which may be set later, and where files
/// lie, whose contents count instead. A `*` is any entry of a list.
const LEFT_OUT: [&[&str]; 6] = [
    &["image", "crop"],
    &["render", "samples_per_pixel"],
    &["render", "paper", "samples"],
    &["render", "seed"],
    &["background", "image", "file"],
    &["sphere_tables", "*", "file"],
];

impl Identity {
    /// The 32 bytes.
    pub fn as_bytes(&self) -> &[u8; 32] {
        &self.0
    }

    /// The hash of these bytes.
    pub fn of_bytes(bytes: &[u8]) -> Self {
        Self(blake3::hash(bytes).into())
    }
}

impl From<[u8; 32]> for Identity {
    fn from(bytes: [u8; 32]) -> Self {
        Self(bytes)
    }
}

impl fmt::Display for Identity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&blake3::Hash::from_bytes(self.0).to_hex())
    }
}

impl std::str::FromStr for Identity {
    type Err = ();

    fn from_str(digits: &str) -> Result<Self, ()> {
        blake3::Hash::from_hex(digits).map(|hash| Self(hash.into())).map_err(|_| ())
    }
}

impl Ingredients {
    /// Hashes what was read.
    pub(super) fn new(
        words: &Words<'_>,
        description: &Description,
        rows: &SphereRows,
        groups: &[RowGroup],
        environment: Option<&Pixels>,
    ) -> Self {
        let exact = rows.exact.len();
        let table = |(file, group): (&Path, &RowGroup)| {
            let begin = group.first_row as usize - exact;
            let rows = &rows.table[begin..begin + group.count as usize];
            Ingredient { file: file.to_path_buf(), hash: hash_of_rows(rows, group.colors.as_ref()) }
        };
        let tables = description.tables.iter().map(|table| table.file.as_path()).zip(groups);
        let mut files: Vec<Ingredient> = tables.map(table).collect();
        if let (Dome::Image { file, .. }, Some(pixels)) =
            (&description.background.dome, environment)
        {
            files.push(Ingredient { file: file.clone(), hash: Identity(pixels.hash().into()) });
        }
        let Words { name, folder, text, options, document } = *words;
        Self {
            name: name.to_owned(),
            folder: folder.to_path_buf(),
            text: (text.len() <= LONGEST_TEXT).then(|| text.to_owned()),
            text_hash: Identity::of_bytes(text.as_bytes()),
            options: options.to_vec(),
            files,
            document,
        }
    }

    /// The identity of pictures of this scene by the intersector that is named.
    pub(super) fn identity(&self, description: &Description, intersector: &str) -> Identity {
        let mut hasher = Hasher::new();
        let render = &description.render;
        for text in ["photosphere", env!("CARGO_PKG_VERSION"), intersector] {
            add_text(&mut hasher, text);
        }
        hasher.update(&self.document.0);
        for file in &self.files {
            hasher.update(&file.hash.0);
        }
        hasher.update(&render.seed.to_le_bytes());
        // Where the samples' number changes each of them.
        let samples = match (render.sampler.depends_on_count(), render.integrator) {
            (true, _) => render.samples_per_pixel,
            (_, Integrator::Normals | Integrator::Raycast { .. }) => {
                u32::from(render.samples_per_pixel == 1)
            }
            _ => 0,
        };
        hasher.update(&samples.to_le_bytes());
        Identity(hasher.finalize().into())
    }
}

/// The hash of a document's keys and values, whatever their order and layout.
pub(super) fn hash_of_document(root: &DeTable<'_>) -> Identity {
    let mut hasher = Hasher::new();
    add_table(&mut hasher, root, &mut Vec::new());
    Identity(hasher.finalize().into())
}

/// Adds all values of a table, each with its whole path, so that an empty table adds nothing.
fn add_table(hasher: &mut Hasher, table: &DeTable<'_>, path: &mut Vec<String>) {
    let mut entries: Vec<(&str, &Node<'_>)> =
        table.iter().map(|(key, node)| (&**key.get_ref(), node)).collect();
    entries.sort_by_key(|(key, _)| *key);
    for (key, node) in entries {
        path.push(key.to_owned());
        if !is_left_out(path) {
            add_node(hasher, node, path);
        }
        path.pop();
    }
}

fn add_node(hasher: &mut Hasher, node: &Node<'_>, path: &mut Vec<String>) {
    match node.get_ref() {
        DeValue::Table(table) => add_table(hasher, table, path),
        DeValue::Array(list) => {
            for (index, entry) in list.iter().enumerate() {
                path.push(index.to_string());
                add_node(hasher, entry, path);
                path.pop();
            }
        }
        value => {
            hasher.update(&(path.len() as u64).to_le_bytes());
            path.iter().for_each(|step| add_text(hasher, step));
            add_value(hasher, value);
        }
    }
}

fn add_value(hasher: &mut Hasher, value: &DeValue<'_>) {
    match value {
        DeValue::Boolean(flag) => add_text(hasher, if *flag { "true" } else { "false" }),
        DeValue::Integer(whole) => match i128::from_str_radix(whole.as_str(), whole.radix()) {
            // A whole number means the same where a fraction is allowed.
            Ok(whole) => add_number(hasher, whole as f64, &whole.to_le_bytes()),
            Err(_) => add_text(hasher, whole.as_str()),
        },
        DeValue::Float(float) => match float.as_str().parse::<f64>() {
            Ok(number) if number.fract() == 0.0 && number.abs() < 1e30 => {
                add_number(hasher, number, &(number as i128).to_le_bytes());
            }
            Ok(number) => add_number(hasher, number, &[]),
            Err(_) => add_text(hasher, float.as_str()),
        },
        DeValue::String(text) => add_text(hasher, text),
        // The format has no dates, and tables and lists are not values here.
        _ => {}
    }
}

/// A number; `whole` are the bytes of one that is whole, of which f64 may not hold the last digits.
fn add_number(hasher: &mut Hasher, number: f64, whole: &[u8]) {
    // Adding 0 turns -0 into 0.
    hasher.update(b"n").update(&(number + 0.0).to_le_bytes()).update(whole);
}

/// A text with its length before it, so that no two sequences of texts look alike.
fn add_text(hasher: &mut Hasher, text: &str) {
    hasher.update(b"s").update(&(text.len() as u64).to_le_bytes()).update(text.as_bytes());
}

fn is_left_out(path: &[String]) -> bool {
    let fits = |(pattern, step): (&&str, &String)| *pattern == "*" || pattern == step;
    LEFT_OUT.iter().any(|left| left.len() == path.len() && left.iter().zip(path).all(fits))
}

/// The hash of a table's values: that of the hashes of its pieces, which all threads share.
fn hash_of_rows(rows: &[[f32; 4]], colors: Option<&Colors>) -> Identity {
    let mut hasher = Hasher::new();
    hasher.update(&(rows.len() as u64).to_le_bytes());
    add_rows(&mut hasher, rows.len(), |row| rows[row]);
    if let Some(colors) = colors {
        add_rows(&mut hasher, colors.len(), |row| colors.get(row).to_array());
    }
    Identity(hasher.finalize().into())
}

fn add_rows<const N: usize>(
    hasher: &mut Hasher,
    count: usize,
    values: impl Fn(usize) -> [f32; N] + Sync,
) {
    let hash_of_piece = |piece: usize| {
        let rows = piece * ROWS..count.min((piece + 1) * ROWS);
        let mut bytes = Vec::with_capacity(rows.len() * N * size_of::<f32>());
        for row in rows {
            values(row).iter().for_each(|value| bytes.extend(value.to_le_bytes()));
        }
        blake3::hash(&bytes)
    };
    let pieces = (0..count.div_ceil(ROWS)).into_par_iter();
    let hashes: Vec<blake3::Hash> = pieces.map(hash_of_piece).collect();
    for hash in hashes {
        hasher.update(hash.as_bytes());
    }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;
    use crate::scene::{Scene, read_text};

    const SCENE: &str = r#"
format = 1
image = { width = 8, height = 6 }
[camera]
position = [0, 1, 5]
look_at = [0, 1, 0]
vertical_fov_degrees = 40
[background]
radiance = [1, 1, 1]
[materials.matt]
type = "diffuse"
albedo = [0.5, 0.25, 0]
[[spheres]]
center = [0, 1, 0]
radius = 1
material = "matt"
[[sphere_tables]]
file = "a.f32"
columns = ["x", "y", "z", "radius"]
material = "matt"
"#;

    fn identity_of(text: &str, settings: &[(&str, &str)], table: &[f32]) -> Identity {
        let folder = tempfile::tempdir().unwrap();
        let bytes: Vec<u8> = table.iter().flat_map(|value| value.to_le_bytes()).collect();
        fs::write(folder.path().join("a.f32"), &bytes).unwrap();
        fs::write(folder.path().join("b.f32"), &bytes).unwrap();
        let option = |&(key, value): &(&str, &str)| Override {
            option: format!("--set {key}={value}"),
            key: key.to_owned(),
            value: value.to_owned(),
        };
        let options: Vec<_> = settings.iter().map(option).collect();
        let loaded = read_text("a.toml", text, folder.path(), &options).unwrap();
        Scene::new(loaded).unwrap().identity("native")
    }

    const TABLE: [f32; 8] = [1.0, 2.0, 3.0, 0.5, 4.0, 5.0, 6.0, 0.5];

    #[test]
    fn what_changes_no_sample_does_not_count() {
        let plain = identity_of(SCENE, &[], &TABLE);
        let other_layout =
            SCENE.replace("1]", "1.0]  # light").replace("[0, 1, 5]", "[0x0,1,+5.0]");
        let moved = SCENE.replace("image = { width = 8, height = 6 }\n", "")
            + "[image]\nheight = 6\nwidth = 8";
        assert_ne!(other_layout, SCENE);
        for text in [other_layout, moved, SCENE.replace("a.f32", "./b.f32")] {
            assert_eq!(identity_of(&text, &[], &TABLE), plain, "{text}");
        }
        let settings = [
            ("render.samples_per_pixel", "7"),
            ("image.crop", "[1, 1, 3, 3]"),
            ("materials.matt.albedo", "[0.5, 0.25, 0.0]"),
        ];
        for setting in settings {
            assert_eq!(identity_of(SCENE, &[setting], &TABLE), plain, "{setting:?}");
        }
    }

    #[test]
    fn what_changes_a_sample_counts() {
        let mut found = vec![identity_of(SCENE, &[], &TABLE)];
        let settings = [
            ("render.seed", "1"),
            ("render.sampler", "independent"),
            ("render.integrator", "direct"),
            ("render.estimator", "light"),
            ("render.light_choice", "power"),
            ("render.max_depth", "3"),
            ("image.width", "9"),
            ("image.filter", "tent"),
            ("materials.matt.albedo", "[0.5, 0.25, 1e-9]"),
            ("camera.up", "[0, 1, 0.1]"),
            ("spheres.0.center", "[0, 1, 1e-300]"),
        ];
        found.extend(settings.iter().map(|&setting| identity_of(SCENE, &[setting], &TABLE)));
        let mut other = TABLE;
        other[7] = 0.500_000_06;
        found.push(identity_of(SCENE, &[], &other));
        found.push(identity_of(SCENE, &[], &TABLE[..4]));
        // Stratified samples, and those through a pixel's centre, change with their number.
        let of = |settings: &[(&str, &str)]| identity_of(SCENE, settings, &TABLE);
        for kind in [("render.sampler", "stratified"), ("render.integrator", "normals")] {
            found.push(of(&[kind, ("render.samples_per_pixel", "1")]));
            found.push(of(&[kind, ("render.samples_per_pixel", "64")]));
        }
        let count = found.len();
        found.sort_by_key(|identity| *identity.as_bytes());
        found.dedup();
        assert_eq!(found.len(), count);
    }

    #[test]
    fn an_identity_is_read_back_from_its_digits() {
        let identity = Identity::of_bytes(b"abc");
        // The first digits of BLAKE3's hash of "abc", as `b3sum` prints them.
        assert!(identity.to_string().starts_with("6437b3ac38465133ffb63b75273a8db5"));
        assert_eq!(identity.to_string().parse(), Ok(identity));
        assert!("6437".parse::<Identity>().is_err());
    }
}
