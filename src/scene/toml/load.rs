//! Loads a scene file into values and then a scene, with the position of every error.

use std::fs::File;
use std::io::{ErrorKind, Read};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use toml::de::DeTable;

use crate::error::{Error, Result};
use crate::particles::Particles;
use crate::scene::data::SphereArrays;
use crate::scene::description::SceneDescription;
use crate::scene::import::{GivenTable, ImportPlan, TablePlan, check_count};
use crate::scene::loaded_particles::LoadedParticles;
use crate::scene::particle_table::FileRows;
use crate::scene::settings::{RenderSettings, Settings};
use crate::scene::source::{ContentHash, SceneSource};
use crate::scene::validation_errors::{self, ValidationErrors};
use crate::scene::{Override, Scene, SceneSize};

use super::diagnostics::Diagnostics;
use super::document::{self, span_at};
use super::missing_file;
use super::overrides::ParsedOverride;
use super::read::read;

/// Maximum size of a scene file in bytes; larger numbers of spheres belong in a table.
const MAX_FILE_BYTES: u64 = 256 << 20;

/// Maximum size in bytes of a scene text kept with the scene.
const MAX_EMBEDDED_TEXT: usize = 1 << 20;

/// A validated scene file: a description and settings. Table data is not loaded yet, so nothing
/// large is in memory.
#[derive(Debug)]
pub struct SceneFile {
    /// The scene description, with overrides applied.
    pub description: SceneDescription,
    /// The render settings, with overrides applied.
    pub settings: Settings,
    /// What a user should know of how overrides were understood.
    pub notes: Vec<String>,
    /// The overrides that change nothing, each with the reason.
    pub warnings: Vec<String>,
    source: SceneSource,
    import_plan: ImportPlan,
    locator: ErrorLocator,
}

/// What stands in place of a table's file: particles or spheres of a program, or the particles of
/// another scene with their radii and colours ([`SceneFile::particle_input`]).
#[derive(Clone, Debug, Default)]
pub struct TableInput(TablePlan);

/// For one of `[[particles]]`.
impl From<Particles> for TableInput {
    fn from(particles: Particles) -> Self {
        Self(TablePlan::of_given(GivenTable::Particles(Arc::new(particles))))
    }
}

/// For one of `[[sphere_tables]]`.
impl From<SphereArrays> for TableInput {
    fn from(arrays: SphereArrays) -> Self {
        Self(TablePlan::of_given(GivenTable::Arrays(arrays)))
    }
}

/// Finds the position of a key again for an error message.
#[derive(Debug)]
struct ErrorLocator {
    diagnostics: Diagnostics,
    overrides: Vec<ParsedOverride>,
}

/// Reads a scene file and applies `overrides`.
///
/// # Errors
/// Reports all errors in the file and the overrides at once, or that a file cannot be read.
pub fn read_file(path: &Path, overrides: &[Override]) -> Result<SceneFile> {
    let text = read_to_string(path)?;
    let folder = path.parent().unwrap_or(Path::new(""));
    let name = path.display().to_string();
    let mut file = read_from(&name, &text, SceneFolder::of(path, folder), overrides, Vec::new())?;
    file.source.file = Some(path.to_path_buf());
    Ok(file)
}

/// Reads a scene from a stream, such as a pipe. The rest is as for [`read_text`].
///
/// # Errors
/// As for [`read_file`].
pub fn read_stream(
    name: &str,
    stream: impl Read,
    folder: &Path,
    overrides: &[Override],
) -> Result<SceneFile> {
    let text = read_bounded(Path::new(name), stream)?;
    read_text(name, &text, folder, overrides)
}

/// Reads a scene from `text`. `name` identifies it in messages, and relative file paths start at
/// `folder`.
///
/// # Errors
/// As for [`read_file`].
pub fn read_text(
    name: &str,
    text: &str,
    folder: &Path,
    overrides: &[Override],
) -> Result<SceneFile> {
    let folder = SceneFolder { named: folder, linked: None };
    read_from(name, text, folder, overrides, Vec::new())
}

/// Reads the scene that was made of the particle file `name` like [`read_text`], but takes the
/// particles from an earlier scene whose tables are the same. Messages say that nobody has seen its
/// text yet.
///
/// # Errors
/// As for [`read_file`].
pub fn read_text_reusing(
    name: &str,
    text: &str,
    folder: &Path,
    overrides: &[Override],
    earlier: SceneFile,
) -> Result<SceneFile> {
    let folder = SceneFolder { named: folder, linked: None };
    let shown = format!("the scene that `import` writes of {name}");
    let report = Diagnostics::new(&shown, text);
    read_with(report, name, text, folder, overrides, earlier.import_plan.tables)
}

/// Reads a scene from `text` like [`read_text`], but takes its tables from `inputs` and not from
/// files: one for each of `[[sphere_tables]]`, then for each of `[[particles]]`. Tables without an
/// input are read from their files.
///
/// # Errors
/// As for [`read_file`].
pub fn read_text_with(
    name: &str,
    text: &str,
    folder: &Path,
    overrides: &[Override],
    inputs: Vec<TableInput>,
) -> Result<SceneFile> {
    let folder = SceneFolder { named: folder, linked: None };
    let plans = inputs.into_iter().map(|input| input.0).collect();
    read_from(name, text, folder, overrides, plans)
}

/// Where relative paths of a scene start.
struct SceneFolder<'a> {
    /// The folder of the path that was named.
    named: &'a Path,
    /// The folder of the file that a named link leads to.
    linked: Option<PathBuf>,
}

impl<'a> SceneFolder<'a> {
    fn of(path: &Path, named: &'a Path) -> Self {
        let is_link = path.symlink_metadata().is_ok_and(|metadata| metadata.is_symlink());
        let target = path.canonicalize().ok().filter(|_| is_link);
        Self { named, linked: target.and_then(|file| Some(file.parent()?.to_path_buf())) }
    }

    /// Moves the files that are missing in the named folder and present in the other.
    fn find_files(&self, description: &mut SceneDescription) {
        let Some(linked) = &self.linked else { return };
        description.for_each_file(|file| {
            let moved = file.strip_prefix(self.named).ok().map(|relative| linked.join(relative));
            if let Some(moved) = moved.filter(|moved| !file.exists() && moved.exists()) {
                *file = moved;
            }
        });
    }
}

fn read_from(
    name: &str,
    text: &str,
    folder: SceneFolder<'_>,
    overrides: &[Override],
    earlier: Vec<TablePlan>,
) -> Result<SceneFile> {
    read_with(Diagnostics::new(name, text), name, text, folder, overrides, earlier)
}

fn read_with(
    mut report: Diagnostics,
    name: &str,
    text: &str,
    folder: SceneFolder<'_>,
    overrides: &[Override],
    earlier: Vec<TablePlan>,
) -> Result<SceneFile> {
    let options = overrides.iter().map(|given| ParsedOverride::new(given, &mut report)).collect();
    let places = ErrorLocator { diagnostics: report, overrides: options };
    let (description, settings, survey, notes) = {
        let ErrorLocator { diagnostics: report, .. } = &places;
        let mut table = document::parse(text, report);
        let integrator_of_file = document::string_at(&table, ["render", "integrator"]);
        let notes = places.apply_overrides(&mut table);
        let (mut description, settings) =
            read(&table, integrator_of_file.as_deref(), folder.named, report);
        folder.find_files(&mut description);
        let mut problems = description.validate();
        problems.0.extend(settings.validate().0);
        places.add_errors(problems, &table);
        // Examine the files even if there are other errors, except files that are not named.
        let mut problems = ValidationErrors::default();
        let survey = ImportPlan::scan_with(&mut description, earlier, &mut problems);
        places.add_errors(problems, &table);
        report.finish()?;
        let drawn = survey.tables.iter().find_map(|table| table.particles.as_ref());
        if let (Some(fit), Some(drawn)) = (&mut description.camera.fit, drawn) {
            fit.leave_room_for(&drawn.look.legend);
        }
        (description, settings, survey, notes)
    };
    check_count(survey.sphere_count(&description))?;
    let source = SceneSource {
        name: name.to_owned(),
        file: None,
        folder: folder.named.to_path_buf(),
        text: (text.len() <= MAX_EMBEDDED_TEXT).then(|| text.to_owned()),
        text_hash: ContentHash::of_bytes(text.as_bytes()),
        overrides: overrides.iter().map(|o| (o.key.clone(), o.value.clone())).collect(),
    };
    let warnings =
        overrides.iter().filter_map(|given| no_effect(given, &settings.render)).collect();
    let import_plan = survey;
    Ok(SceneFile { description, settings, notes, warnings, source, import_plan, locator: places })
}

/// A warning if an override changes nothing.
fn no_effect(given: &Override, render: &RenderSettings) -> Option<String> {
    let why = render.why_no_effect(given.key.strip_prefix("render.")?)?;
    Some(format!("`{given}` has no effect: {why}"))
}

impl SceneFile {
    /// The source of the scene.
    pub fn source(&self) -> &SceneSource {
        &self.source
    }

    /// The size of the scene. The tables are not read for it.
    pub fn size(&self) -> SceneSize {
        SceneSize::new(&self.description, &self.import_plan)
    }

    /// The particles of `[[particles]]`, which are read with the file.
    pub fn particles(&self) -> impl Iterator<Item = LoadedParticles<'_>> {
        let planned = self.import_plan.tables.iter().filter_map(|plan| plan.particles.as_ref());
        planned.map(|planned| LoadedParticles::new(&planned.arrays, &planned.look))
    }

    /// What is probably a mistake in the particle files.
    pub fn warnings(&self) -> Vec<String> {
        self.particles().flat_map(|particles| particles.look.warnings.iter().cloned()).collect()
    }

    /// For each table, which rows of a particle file its rows show; `None` for other tables.
    pub fn file_rows(&self) -> Vec<Option<FileRows>> {
        let planned = self.import_plan.tables.iter().map(|plan| plan.particles.as_ref());
        let loaded = planned.map(|one| one.map(|one| LoadedParticles::new(&one.arrays, &one.look)));
        loaded.map(|one| one.map(|one| one.file_rows())).collect()
    }

    /// The particles of the first table that has some, to be used in another scene: a copy that
    /// shares their numbers, radii and colours.
    pub fn particle_input(&self) -> Option<TableInput> {
        let plans = &self.import_plan.tables;
        plans.iter().find(|plan| plan.particles.is_some()).cloned().map(TableInput)
    }

    /// Reads the tables and builds the scene.
    ///
    /// # Errors
    /// Reports all errors in the tables at once, or that they do not fit into memory.
    pub fn build(self) -> Result<(Scene, Settings)> {
        let Self { description, settings, source, import_plan: survey, locator: places, .. } = self;
        let text = source.text.clone();
        let refuse = |problems: ValidationErrors| match &text {
            // The document was freed; parse it again only to locate errors.
            Some(text) => places.report(text, problems),
            None => problems.into_result(),
        };
        let scene = Scene::assemble(description, survey, Some(source), refuse)?;
        let mut problems = ValidationErrors::default();
        scene.place_camera(&settings.image, &mut problems);
        if !problems.0.is_empty() {
            refuse(problems)?;
        }
        Ok((scene, settings))
    }
}

impl ErrorLocator {
    /// Applies the overrides; returns notes on the keys that they take away.
    fn apply_overrides<'t>(&'t self, table: &mut DeTable<'t>) -> Vec<String> {
        let apply = |option: &'t ParsedOverride| option.apply(table, &self.diagnostics);
        self.overrides.iter().flat_map(apply).collect()
    }

    fn add_errors(&self, problems: ValidationErrors, table: &DeTable<'_>) {
        let span_of = |path: &validation_errors::KeyPath| {
            span_at(table, path, self.diagnostics.end_of_file())
        };
        self.diagnostics.add_validation_errors(problems, span_of);
    }

    fn report(&self, text: &str, problems: ValidationErrors) -> Result<()> {
        let mut table = document::parse(text, &self.diagnostics);
        self.apply_overrides(&mut table);
        self.add_errors(problems, &table);
        self.diagnostics.finish()
    }
}

fn read_to_string(path: &Path) -> Result<String> {
    let trouble = |error: std::io::Error| Error::file("read the scene", path, error);
    let file = File::open(path).map_err(|error| {
        let help = missing_file::suggestion(path).filter(|_| error.kind() == ErrorKind::NotFound);
        match help {
            Some(help) => trouble(error).with_help(help),
            None => trouble(error),
        }
    })?;
    if file.metadata().map_err(trouble)?.is_dir() {
        return Err(Error::file("read the scene", path, "it is a folder"));
    }
    read_bounded(path, file)
}

fn read_bounded(path: &Path, stream: impl Read) -> Result<String> {
    let trouble = |error: std::io::Error| Error::file("read the scene", path, error);
    let mut bytes = Vec::new();
    stream.take(MAX_FILE_BYTES + 1).read_to_end(&mut bytes).map_err(trouble)?;
    if bytes.len() as u64 > MAX_FILE_BYTES {
        return Err(Error::file("read the scene", path, "it is longer than 256 MiB")
            .with_help("put the spheres into a sphere table"));
    }
    String::from_utf8(bytes).map_err(|error| {
        let at = error.utf8_error().valid_up_to();
        Error::file("read the scene", path, format!("it is not UTF-8 text at byte {at}"))
    })
}
