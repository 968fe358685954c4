//! The output files of a picture: prepared before rendering, written after it.

use std::io::{self, IsTerminal};
use std::path::{Path, PathBuf};

use crate::color::ViewTransform;
use crate::denoise::Denoiser;
use crate::error::{Error, Result};
use crate::film::{Aov, FilmFrame, Layer};
use crate::image_io::{FileFormat, Picture};
use crate::job::{FilePath, Metadata, OutputSpec, PictureRecord, frame_crop};
use crate::overlay::{LegendSpec, OverlaySpec};
use crate::scene::{ColumnLayers, Scene};

use super::picture_file::PictureFile;

/// The output files of a picture.
pub(super) struct Outputs {
    pictures: Vec<PictureFile>,
    /// The checkpoint file (`.part`), which holds the sample sums.
    part: Option<PathBuf>,
    layers: Vec<Aov>,
    overlay: Option<OverlaySpec>,
    columns: Option<ColumnLayers>,
    denoiser: Option<Denoiser>,
    spec: OutputSpec,
}

impl Outputs {
    /// Prepares all files. `--exposure`, `--tone` and `--dither` need a file for the screen, and a
    /// preview counts as one. `--dpi` needs a picture for the screen. `stdout` is the requested
    /// format of the standard output.
    ///
    /// # Errors
    /// If a file cannot be written or is named twice, or no file can hold a requested layer.
    pub(super) fn new(
        delivery: &OutputSpec,
        layers: &[Aov],
        layers_given: bool,
        stdout: Option<FileFormat>,
    ) -> Result<Self> {
        check_streams(delivery, stdout)?;
        let mut pictures: Vec<PictureFile> = Vec::new();
        let mut part = None;
        let named = |path: &&FilePath| !is_discarded(&path.0);
        for FilePath(path) in delivery.files.iter().filter(named) {
            if is_stdout(path) {
                pictures.push(PictureFile::stdout(path, stdout.unwrap_or(FileFormat::Png)));
                continue;
            }
            if is_part(path) {
                if let Some(earlier) = part.replace(path.clone()) {
                    let (a, b) = (earlier.display(), path.display());
                    let message = format!("`{a}` and `{b}` are both parts");
                    return Err(
                        Error::input(message).with_help("remove one; a part holds everything")
                    );
                }
                continue;
            }
            pictures.push(PictureFile::new(path)?);
        }
        let is_discarded = pictures.is_empty() && part.is_none();
        if part.is_none() && layers_given && !is_discarded {
            refuse_layers_without_place(layers, &pictures)?;
        }
        if !is_discarded {
            refuse_look_without_screen(delivery, &pictures)?;
        }
        let (layers, spec) = (layers.to_vec(), delivery.clone());
        Ok(Self { pictures, part, layers, overlay: None, columns: None, denoiser: None, spec })
    }

    /// The `.part` file, which holds the sample sums.
    pub(super) fn part(&self) -> Option<&Path> {
        self.part.as_deref()
    }

    /// Returns true if at least one of the files is a picture.
    pub(super) fn has_pictures(&self) -> bool {
        !self.pictures.is_empty()
    }

    /// Returns true if there is a `.part` file and no picture.
    pub(super) fn is_part_alone(&self) -> bool {
        self.part.is_some() && !self.has_pictures()
    }

    /// The picture files.
    pub(super) fn pictures(&self) -> &[PictureFile] {
        &self.pictures
    }

    /// Sets what is drawn over the pictures.
    pub(super) fn set_overlay(&mut self, overlay: Option<OverlaySpec>) {
        self.overlay = overlay;
    }

    /// Returns true if a colour bar or legend is drawn over the pictures.
    pub(super) fn has_legend(&self) -> bool {
        self.overlay.as_ref().is_some_and(|overlay| overlay.legend != LegendSpec::Nothing)
    }

    /// Sets the columns of a particle file that are layers.
    pub(super) fn set_columns(&mut self, columns: Option<ColumnLayers>) {
        self.columns = columns;
    }

    /// Sets what denoises the pictures.
    pub(super) fn set_denoiser(&mut self, denoiser: Denoiser) {
        self.denoiser = Some(denoiser);
    }

    /// What denoises the pictures.
    pub(super) fn denoiser(&self) -> Option<&Denoiser> {
        self.denoiser.as_ref()
    }

    /// Returns a picture of the scene with the columns as layers.
    pub(super) fn with_columns(&self, mut picture: Picture, scene: &Scene) -> Picture {
        if let Some(columns) = &self.columns {
            columns.add_to(&mut picture, scene);
        }
        picture
    }

    /// Replaces the layers to write.
    pub(super) fn set_layers(&mut self, layers: &[Aov]) {
        self.layers = layers.to_vec();
    }

    /// Returns what the files record about a picture. `quickly` favours writing speed over file
    /// size.
    pub(super) fn notes(
        &self,
        frame: &FilmFrame,
        metadata: &Metadata,
        quickly: bool,
    ) -> PictureRecord {
        let (overlay, crop) = (self.overlay.as_ref(), frame_crop(frame));
        let columns = self.columns.as_ref().map(|columns| columns.names()).unwrap_or_default();
        PictureRecord::new(metadata, &self.layers, crop, overlay, &self.spec)
            .with_columns(columns)
            .fast(quickly)
    }
}

/// Refuses pictures that nobody could read, and a format for no picture.
fn check_streams(delivery: &OutputSpec, stdout: Option<FileFormat>) -> Result<()> {
    let has = |test: fn(&Path) -> bool| delivery.files.iter().any(|FilePath(file)| test(file));
    let refused = |message: &str, help: &str| Err(Error::input(message).with_help(help));
    if has(is_discarded) && delivery.files.len() > 1 {
        let help = "leave it out, or the other files";
        return refused("`-o none` discards the picture, and there are other files", help);
    }
    if has(is_stdout) && io::stdout().is_terminal() {
        let help = "redirect it: -o - > picture.png";
        return refused("the standard output is a terminal, which shows no picture", help);
    }
    if stdout.is_some() && !has(is_stdout) {
        let help = "the extension of a file name chooses its format";
        return refused("`--format` is for the standard output, `-o -`", help);
    }
    Ok(())
}

/// Refuses the standard output and no output where files are needed.
pub(super) fn refuse_streams(files: &[PathBuf]) -> Result<()> {
    let Some(stream) = files.iter().find(|file| is_stdout(file) || is_discarded(file)) else {
        return Ok(());
    };
    Err(Error::input(format!("`-o {}` names no file", stream.display()))
        .with_help("name a picture, such as -o picture.exr"))
}

/// Refuses columns of particle files as layers of a picture that is merged from parts.
///
/// # Errors
/// If there are any.
pub(super) fn refuse_columns(columns: &[String]) -> Result<()> {
    let Some(column) = columns.first() else { return Ok(()) };
    let message = format!("there is no layer `{column}` in a picture that is merged from parts");
    Err(Error::input(message).with_help("`render` has columns of a particle file as layers"))
}

/// Returns the plain paths.
pub(super) fn paths(files: &[FilePath]) -> Vec<PathBuf> {
    files.iter().map(|FilePath(file)| file.clone()).collect()
}

/// Refuses two outputs with the same path, however it is spelled: one would replace the other.
///
/// # Errors
/// Names the first such pair.
pub(super) fn refuse_duplicate_paths(files: &[(&str, &Path)]) -> Result<()> {
    let places: Vec<PathBuf> = files.iter().map(|(_, file)| place(file)).collect();
    for (at, (option, file)) in files.iter().enumerate() {
        let Some(earlier) = places[..at].iter().position(|place| *place == places[at]) else {
            continue;
        };
        let (first_option, first) = files[earlier];
        let (first, file) = (first.display(), file.display());
        let message = format!("{first_option} {first} and {option} {file} are the same file");
        return Err(Error::input(message).with_help("remove one, or give it another name"));
    }
    Ok(())
}

/// Returns the absolute path of a file, with links resolved as far as the path exists.
pub(super) fn place(file: &Path) -> PathBuf {
    let full = std::path::absolute(file).unwrap_or_else(|_| file.to_path_buf());
    let there = |ancestor: &Path| {
        let rest = full.strip_prefix(ancestor).ok()?;
        let folder = ancestor.canonicalize().ok()?;
        Some(if rest.as_os_str().is_empty() { folder } else { folder.join(rest) })
    };
    full.ancestors().find_map(there).unwrap_or_else(|| full.clone())
}

/// Returns true if the path names a `.part` file, which holds the sample sums.
pub(super) fn is_part(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("part"))
}

/// Returns true if the path stands for the standard output.
pub(super) fn is_stdout(path: &Path) -> bool {
    path.as_os_str() == "-"
}

/// Returns true if the path stands for no file: the picture is discarded.
pub(super) fn is_discarded(path: &Path) -> bool {
    path.as_os_str() == "none"
}

/// Joins file names for a message: `a.png and b.exr`.
pub(super) fn in_words(files: &[PathBuf]) -> String {
    let name = |file: &PathBuf| match file {
        file if is_stdout(file) => "the standard output".to_owned(),
        file if is_discarded(file) => "nothing".to_owned(),
        file => file.display().to_string(),
    };
    files.iter().map(name).collect::<Vec<_>>().join(" and ")
}

/// Refuses layers that no file can hold: `.png` stores beauty and alpha, the linear formats store
/// only the beauty.
fn refuse_layers_without_place(layers: &[Aov], files: &[PictureFile]) -> Result<()> {
    let any = |test: fn(&PictureFile) -> bool| files.iter().any(test);
    if any(PictureFile::has_layers) {
        return Ok(());
    }
    let has_place = |kind: &&Aov| match kind {
        Aov::Beauty => true,
        Aov::Mean(Layer::Alpha) => any(PictureFile::is_display_referred),
        _ => false,
    };
    let Some(homeless) = layers.iter().find(|kind| !has_place(kind)) else { return Ok(()) };
    let (layer, names) = (homeless.info().name, quoted(files));
    Err(Error::input(format!("{names} cannot hold the layer `{layer}`"))
        .with_help("layers need an .exr file; add one: -o a.exr"))
}

fn quoted(files: &[PictureFile]) -> String {
    let names: Vec<String> =
        files.iter().map(|file| format!("`{}`", file.path.display())).collect();
    names.join(" and ")
}

fn refuse_look_without_screen(delivery: &OutputSpec, files: &[PictureFile]) -> Result<()> {
    let usual = ViewTransform::default();
    let has_preview = delivery.preview.is_some();
    let given = [
        ("--exposure", delivery.look.exposure != usual.exposure && !has_preview),
        ("--tone", delivery.look.tone != usual.tone && !has_preview),
        ("--dither", delivery.look.dither && !has_preview),
        ("--dpi", delivery.dpi.is_some()),
    ];
    let Some((option, _)) = given.into_iter().find(|(_, given)| *given) else { return Ok(()) };
    if files.iter().any(|file| file.is_display_referred()) {
        return Ok(());
    }
    let verb = if delivery.files.len() == 1 { "is" } else { "are" };
    let names: Vec<String> =
        delivery.files.iter().map(|FilePath(path)| format!("`{}`", path.display())).collect();
    let names = names.join(" and ");
    Err(Error::input(format!("`{option}` applies only to .png files, and {names} {verb} not"))
        .with_help("add a .png file: -o a.exr -o a.png"))
}
