//! Particle files in place of a scene.

use std::path::Path;

use crate::error::{Error, Result};
use crate::particles::{ReadRequest, survey};
use crate::scene::{Override, SceneFile};
use crate::studio::{Import, StudioOptions, import};

use super::args::StudioArgs;
use super::print;
use super::scene_file::{self, is_stdin};

/// The key by which an option chooses the format of a particle file.
const FORMAT_KEY: &str = "particles.0.format";

/// Endings of particle files.
const ENDINGS: [&str; 27] = [
    "xyz",
    "extxyz",
    "exyz",
    "dump",
    "lammpstrj",
    "lammpsdump",
    "lammps",
    "lmp",
    "pdb",
    "ent",
    "pqr",
    "cif",
    "mmcif",
    "gro",
    "xtc",
    "npy",
    "npz",
    "csv",
    "tsv",
    "ply",
    "gsd",
    "vtp",
    "vtu",
    "pvd",
    "vtk",
    "poscar",
    "vasp",
];

/// A particle file, with what options set.
pub(super) struct ParticleFile<'a> {
    pub(super) path: &'a Path,
    pub(super) overrides: &'a [Override],
}

impl ParticleFile<'_> {
    /// Returns true if the file holds particles rather than a scene: by its ending, by an option
    /// that says its format, or else by its content.
    pub(super) fn is_one(path: &Path, overrides: &[Override]) -> bool {
        let name = path.to_string_lossy().to_ascii_lowercase();
        if name.ends_with(".toml") {
            return false;
        }
        if overrides.iter().any(|given| given.key == FORMAT_KEY) {
            return true;
        }
        if is_stdin(path) {
            return false;
        }
        let name = name.trim_end_matches(".gz").trim_end_matches(".zst");
        let has_ending =
            |ending: &&str| name.strip_suffix(*ending).is_some_and(|rest| rest.ends_with('.'));
        ENDINGS.iter().any(has_ending)
            || path.is_file() && survey(path, &ReadRequest::default()).is_ok()
    }

    /// Makes a scene of the file, in its folder.
    ///
    /// # Errors
    /// If the file or an option is wrong.
    pub(super) fn import(&self, options: &StudioOptions) -> Result<Import> {
        let folder = self.path.parent().unwrap_or(Path::new(""));
        let name = self.path.file_name().map_or(self.path, Path::new);
        self.import_from(name, folder, options)
    }

    /// Makes a scene of the file, which the scene names `reference` from `folder`.
    ///
    /// # Errors
    /// If the file or an option is wrong.
    pub(super) fn import_from(
        &self,
        reference: &Path,
        folder: &Path,
        options: &StudioOptions,
    ) -> Result<Import> {
        let name = self.path.display().to_string();
        import(&name, reference, folder, options, self.overrides)
    }
}

/// Reads a scene, or makes one of a particle file, for a command that reads it several times or
/// prints something else: automatic choices are not printed.
///
/// # Errors
/// If the file cannot be read, has mistakes, or an option is wrong for it.
pub(super) fn read_scene(
    path: &Path,
    overrides: &[Override],
    studio: Option<&StudioArgs>,
) -> Result<SceneFile> {
    if !ParticleFile::is_one(path, overrides) {
        refuse_options(path, studio.and_then(StudioArgs::first_given))?;
        return scene_file::read(path, overrides);
    }
    let options = studio.map_or_else(StudioOptions::default, StudioArgs::options);
    Ok(ParticleFile { path, overrides }.import(&options)?.scene)
}

/// Prints what was chosen automatically, as the options that would fix it.
pub(super) fn tell(import: &Import) {
    import.notes.iter().for_each(print::note);
    import.scene.warnings.iter().for_each(print::warning);
    if import.choices.is_empty() {
        return;
    }
    let option = |(name, value): &(&str, String)| {
        let value = shlex::try_quote(value).map_or_else(|_| value.clone(), Into::into);
        format!("--{name} {value}")
    };
    let options: Vec<String> = import.choices.iter().map(option).collect();
    print::note(format_args!("chosen automatically: {}", options.join(" ")));
}

/// Refuses an option for particle files where there is a scene.
///
/// # Errors
/// If one is given.
pub(super) fn refuse_options(path: &Path, option: Option<&str>) -> Result<()> {
    let Some(option) = option else { return Ok(()) };
    let message = format!("`{option}` is for particle files, but `{}` is a scene", path.display());
    Err(Error::input(message).with_help("change the scene, or set its keys with --set"))
}
