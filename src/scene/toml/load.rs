//! From a scene file to values, and on to a scene, with the place of every mistake.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use toml::de::DeTable;

use crate::error::{Error, Result};
use crate::scene::description::Description;
use crate::scene::import::{Survey, check_count};
use crate::scene::problem::{self, Problems};
use crate::scene::settings::Settings;
use crate::scene::source::{Identity, Source};
use crate::scene::{Override, Scene};

use super::document::{self, span_at};
use super::overrides::LaidOut;
use super::read::read;
use super::report::Report;

/// The longest scene file in bytes; more spheres than fit belong in a table.
const LONGEST_FILE: u64 = 256 << 20;

/// The longest scene text, in bytes, that goes along with a scene.
const LONGEST_TEXT: usize = 1 << 20;

/// A scene file that was read and checked: a description and the settings beside it. Its tables were
/// only looked at from outside, so nothing large is in memory yet.
#[derive(Debug)]
pub struct SceneFile {
    /// What the file and the options say of the scene.
    pub description: Description,
    /// What they say of its rendering.
    pub settings: Settings,
    source: Source,
    survey: Survey,
    places: Places,
}

/// What is needed to find the place of a key again.
#[derive(Debug)]
struct Places {
    report: Report,
    options: Vec<LaidOut>,
}

/// Reads a scene file, with `overrides` in place of what it says.
///
/// # Errors
/// Every mistake in the file and the overrides, all at once; or that a file cannot be read.
pub fn read_file(path: &Path, overrides: &[Override]) -> Result<SceneFile> {
    let text = read_to_string(path)?;
    let folder = path.parent().unwrap_or(Path::new(""));
    let mut file = read_text(&path.display().to_string(), &text, folder, overrides)?;
    file.source.file = Some(path.to_path_buf());
    Ok(file)
}

/// Reads a scene from `text`; `name` stands for it in messages, and files that it names are looked for
/// in `folder`.
///
/// # Errors
/// Like [`read_file`].
pub fn read_text(
    name: &str,
    text: &str,
    folder: &Path,
    overrides: &[Override],
) -> Result<SceneFile> {
    let mut report = Report::new(name, text);
    let options = overrides.iter().map(|given| LaidOut::new(given, &mut report)).collect();
    let places = Places { report, options };
    let (description, settings, survey) = {
        let Places { report, .. } = &places;
        let mut table = document::parse(text, report);
        let integrator_of_file = document::text_at(&table, ["render", "integrator"]);
        places.apply_options(&mut table);
        let (description, settings) = read(&table, integrator_of_file.as_deref(), folder, report);
        let mut problems = description.problems();
        problems.0.extend(settings.problems().0);
        places.add(problems, &table);
        // Files are looked at whatever else is wrong, but not those that nobody names.
        let mut problems = Problems::default();
        let survey = Survey::of(&description, &mut problems);
        places.add(problems, &table);
        report.verdict()?;
        (description, settings, survey)
    };
    check_count(survey.sphere_count(&description))?;
    let source = Source {
        name: name.to_owned(),
        file: None,
        folder: folder.to_path_buf(),
        text: (text.len() <= LONGEST_TEXT).then(|| text.to_owned()),
        text_hash: Identity::of_bytes(text.as_bytes()),
        overrides: overrides.iter().map(|o| (o.key.clone(), o.value.clone())).collect(),
    };
    Ok(SceneFile { description, settings, source, survey, places })
}

impl SceneFile {
    /// Where it was read from.
    pub fn source(&self) -> &Source {
        &self.source
    }

    /// How many rows each table has.
    pub fn table_rows(&self) -> impl Iterator<Item = u64> {
        self.survey.rows.iter().copied()
    }

    /// How many spheres there are, those that are there twice included.
    pub fn sphere_count(&self) -> u64 {
        self.survey.sphere_count(&self.description)
    }

    /// How many pixels the image of the background has.
    pub fn environment_pixels(&self) -> u64 {
        self.survey.environment.as_ref().map_or(0, |pixels| pixels.len() as u64)
    }

    /// Reads the tables and builds the scene.
    ///
    /// # Errors
    /// Every mistake in the tables; or that there is no memory for them.
    pub fn build(self) -> Result<(Scene, Settings)> {
        let Self { description, settings, source, survey, places } = self;
        let text = source.text.clone();
        let refuse = |problems: Problems| match text {
            // Its document is gone, and made again only for the places of mistakes.
            Some(text) => places.refuse(&text, problems),
            None => problems.verdict(),
        };
        let scene = Scene::assemble(description, survey, Some(source), refuse)?;
        Ok((scene, settings))
    }
}

impl Places {
    fn apply_options<'t>(&'t self, table: &mut DeTable<'t>) {
        self.options.iter().for_each(|option| option.apply(table, &self.report));
    }

    fn add(&self, problems: Problems, table: &DeTable<'_>) {
        let span_of = |path: &problem::Path| span_at(table, path, self.report.end_of_file());
        self.report.add_problems(problems, span_of);
    }

    fn refuse(&self, text: &str, problems: Problems) -> Result<()> {
        let mut table = document::parse(text, &self.report);
        self.apply_options(&mut table);
        self.add(problems, &table);
        self.report.verdict()
    }
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
        Error::file("read the scene", path, format!("it is not UTF-8 text at byte {at}"))
    })
}
