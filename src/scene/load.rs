//! From a file to a scene that is read and checked.

use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

use crate::error::{Error, Result};
use crate::geometry::SphereRows;

use super::description::Description;
use super::document;
use super::environment::Pixels;
use super::identity::{Identity, Ingredients, Words, hash_of_document};
use super::import::{RowGroup, check_count, import};
use super::overrides::{LaidOut, Override};
use super::read::{Draft, read};
use super::report::Report;

/// The longest scene file in bytes; more spheres than fit belong in a table.
const LONGEST_FILE: u64 = 256 << 20;

/// A scene file read and checked, with its tables, not yet prepared for rendering.
#[derive(Debug)]
pub struct Loaded {
    /// What the file and the options say, with the defaults filled in.
    pub description: Description,
    /// All spheres: those written in the scene first, then the rows of the tables.
    pub rows: SphereRows,
    /// Which rows came from which table; one group for each of the description's tables.
    pub groups: Vec<RowGroup>,
    /// The pixels of the background's image, where it has one.
    pub environment: Option<Pixels>,
    /// What all this was read from.
    pub ingredients: Ingredients,
}

/// A scene file read and checked, whose tables were only looked at from outside: what is known of a
/// scene before anything large is held in memory.
#[derive(Debug)]
pub struct Opened {
    name: String,
    folder: PathBuf,
    text: String,
    options: Vec<Override>,
    document: Identity,
    draft: Draft,
    report: Report,
}

/// Reads a scene file without its tables, with `overrides` in place of what it says.
///
/// # Errors
/// Every mistake in the file and the overrides, all at once; or that a file cannot be read.
pub fn open_file(path: &Path, overrides: &[Override]) -> Result<Opened> {
    let text = read_to_string(path)?;
    let folder = path.parent().unwrap_or(Path::new(""));
    open_text(&path.display().to_string(), &text, folder, overrides)
}

/// Reads a scene from `text`, without its tables; `name` stands for it in messages, and sphere
/// tables are looked for in `folder`.
///
/// # Errors
/// Like [`open_file`].
pub fn open_text(name: &str, text: &str, folder: &Path, overrides: &[Override]) -> Result<Opened> {
    let mut report = Report::new(name, text);
    let laid_out: Vec<_> = overrides.iter().map(|given| LaidOut::new(given, &mut report)).collect();
    let mut table = document::parse(text, &report);
    let integrator_of_file = document::text_at(&table, ["render", "integrator"]);
    laid_out.iter().for_each(|option| option.apply(&mut table, &report));
    let draft = read(&table, integrator_of_file.as_deref(), folder, &report);
    report.verdict()?;
    let draft = draft.expect("whoever gave up on the scene has told the report why");
    let document = hash_of_document(&table);
    let (name, folder, text) = (name.to_owned(), folder.to_path_buf(), text.to_owned());
    let opened =
        Opened { name, folder, text, options: overrides.to_vec(), document, draft, report };
    check_count(opened.sphere_count())?;
    Ok(opened)
}

impl Opened {
    /// What the file and the options say, with the defaults filled in.
    pub fn description(&self) -> &Description {
        &self.draft.description
    }

    /// How many rows each table has.
    pub fn table_rows(&self) -> impl Iterator<Item = u64> {
        self.draft.surveys.iter().map(|survey| survey.rows)
    }

    /// How many spheres there are, those that are there twice included.
    pub fn sphere_count(&self) -> u64 {
        self.description().spheres.len() as u64 + self.table_rows().sum::<u64>()
    }

    /// How many pixels the image of the background has.
    pub fn environment_pixels(&self) -> u64 {
        self.draft.environment.as_ref().map_or(0, |pixels| pixels.len() as u64)
    }

    /// Reads the tables.
    ///
    /// # Errors
    /// Every mistake in them; or that there is no memory for them.
    pub fn read(self) -> Result<Loaded> {
        let Self { draft: Draft { description, surveys, environment }, report, .. } = &self;
        let (rows, groups) = import(description, surveys, report)?;
        report.verdict()?;
        let words = Words {
            name: &self.name,
            folder: &self.folder,
            text: &self.text,
            options: &self.options,
            document: self.document,
        };
        let ingredients =
            Ingredients::new(&words, description, &rows, &groups, environment.as_ref());
        let Draft { description, environment, .. } = self.draft;
        Ok(Loaded { description, rows, groups, environment, ingredients })
    }
}

/// Reads a scene file, with `overrides` in place of what it says.
///
/// # Errors
/// Every mistake in the file, its tables and the overrides, all at once; or that a file cannot be
/// read.
pub fn read_file(path: &Path, overrides: &[Override]) -> Result<Loaded> {
    open_file(path, overrides)?.read()
}

/// Reads a scene from `text`; `name` stands for it in messages, and sphere tables are looked for in
/// `folder`.
///
/// # Errors
/// Like [`read_file`].
pub fn read_text(name: &str, text: &str, folder: &Path, overrides: &[Override]) -> Result<Loaded> {
    open_text(name, text, folder, overrides)?.read()
}

fn read_to_string(path: &Path) -> Result<String> {
    let trouble = |error: std::io::Error| Error::file("read the scene", path, error);
    let file = File::open(path).map_err(trouble)?;
    if file.metadata().map_err(trouble)?.is_dir() {
        return Err(Error::file("read the scene", path, "it is a folder"));
    }
    let mut bytes = Vec::new();
    file.take(LONGEST_FILE + 1).read_to_end(&mut bytes).map_err(trouble)?;
    if bytes.len() as u64 > LONGEST_FILE {
        return Err(Error::file("read the scene", path, "it is longer than 256 MiB")
            .with_help("put the spheres into a sphere table"));
    }
    String::from_utf8(bytes).map_err(|error| {
        let at = error.utf8_error().valid_up_to();
        Error::file("read the scene", path, format_args!("it is not UTF-8 text at byte {at}"))
    })
}
