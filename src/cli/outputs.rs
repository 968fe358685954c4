//! The output files of a picture: prepared before rendering, written after it.

use std::path::{Path, PathBuf};

use crate::color::ViewTransform;
use crate::error::{Error, Result};
use crate::film::{Aov, FilmFrame, Layer};
use crate::image_io::Picture;
use crate::image_io::{ImageWriter, WriteOptions};
use crate::job::{FilePath, Metadata, OutputSpec, frame_crop};

/// The output files of a picture.
pub(super) struct Outputs {
    pictures: Vec<PictureFile>,
    /// The checkpoint file (`.part`), which holds the sample sums.
    part: Option<PathBuf>,
    look: ViewTransform,
    layers: Vec<Aov>,
    with_run: bool,
}

/// One picture file.
pub(super) struct PictureFile {
    pub(super) path: PathBuf,
    target: ImageWriter,
}

/// What is written beside the pixels of a picture file.
pub(super) struct PictureNotes {
    notes: WriteOptions,
    metadata: Metadata,
    layers: Vec<Aov>,
}

impl Outputs {
    /// Prepares all files. `--exposure`, `--tone` and `--dither` need a file for the screen. A
    /// preview counts as one.
    ///
    /// # Errors
    /// If a file cannot be written or is named twice, or no file can hold a requested layer.
    pub(super) fn new(delivery: &OutputSpec, layers: &[Aov], layers_given: bool) -> Result<Self> {
        let mut pictures: Vec<PictureFile> = Vec::new();
        let mut part = None;
        for FilePath(path) in &delivery.files {
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
            pictures.push(PictureFile { path: path.clone(), target: ImageWriter::new(path)? });
        }
        if part.is_none() && layers_given {
            refuse_layers_without_place(layers, &pictures)?;
        }
        if delivery.preview.is_none() {
            refuse_look_without_screen(delivery, &pictures)?;
        }
        let OutputSpec { look, with_run, .. } = *delivery;
        Ok(Self { pictures, part, look, layers: layers.to_vec(), with_run })
    }

    /// The `.part` file, which holds the sample sums.
    pub(super) fn part(&self) -> Option<&Path> {
        self.part.as_deref()
    }

    /// Returns true if at least one of the files is a picture.
    pub(super) fn has_pictures(&self) -> bool {
        !self.pictures.is_empty()
    }

    /// The picture files.
    pub(super) fn pictures(&self) -> &[PictureFile] {
        &self.pictures
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
    ) -> PictureNotes {
        let mut metadata = metadata.clone();
        metadata.run = metadata.run.filter(|_| self.with_run);
        let cropped_from = frame_crop(frame);
        let notes = WriteOptions {
            crop_window: cropped_from,
            view_transform: self.look,
            metadata: Vec::new(),
            fast: quickly,
        };
        PictureNotes { notes, metadata, layers: self.layers.clone() }
    }
}

impl PictureFile {
    /// Writes the picture, to its own path or to another.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub(super) fn write(
        &self,
        place: Option<&Path>,
        picture: &Picture,
        of: &PictureNotes,
    ) -> Result<()> {
        let usual = of.notes.view_transform == ViewTransform::default();
        let metadata = Metadata {
            look: (self.target.is_display_referred() && !usual).then_some(of.notes.view_transform),
            layers: self.target.has_layers().then(|| of.layers.clone()),
            ..of.metadata.clone()
        };
        let notes = WriteOptions { metadata: metadata.to_records()?, ..of.notes.clone() };
        match place {
            None => self.target.write_with(picture, &notes),
            Some(place) => ImageWriter::new(place)?.write_with(picture, &notes),
        }
    }
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
fn place(file: &Path) -> PathBuf {
    let full = std::path::absolute(file).unwrap_or_else(|_| file.to_path_buf());
    let beside = || Some(full.parent()?.canonicalize().ok()?.join(full.file_name()?));
    full.canonicalize().ok().or_else(beside).unwrap_or_else(|| full.clone())
}

/// Returns true if the path names a `.part` file, which holds the sample sums.
pub(super) fn is_part(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("part"))
}

/// Joins file names for a message: `a.png and b.exr`.
pub(super) fn in_words(files: &[PathBuf]) -> String {
    let names: Vec<String> = files.iter().map(|file| file.display().to_string()).collect();
    names.join(" and ")
}

/// Refuses layers that no file can hold: `.png` stores beauty and alpha, the linear formats store
/// only the beauty.
fn refuse_layers_without_place(layers: &[Aov], files: &[PictureFile]) -> Result<()> {
    let any = |test: fn(&ImageWriter) -> bool| files.iter().any(|file| test(&file.target));
    if any(ImageWriter::has_layers) {
        return Ok(());
    }
    let has_place = |kind: &&Aov| match kind {
        Aov::Beauty => true,
        Aov::Mean(Layer::Alpha) => any(ImageWriter::is_display_referred),
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
    let given = [
        ("--exposure", delivery.look.exposure != usual.exposure),
        ("--tone", delivery.look.tone != usual.tone),
        ("--dither", delivery.look.dither),
    ];
    let Some((option, _)) = given.into_iter().find(|(_, given)| *given) else { return Ok(()) };
    if files.iter().any(|file| file.target.is_display_referred()) {
        return Ok(());
    }
    let verb = if delivery.files.len() == 1 { "is" } else { "are" };
    let names: Vec<String> =
        delivery.files.iter().map(|FilePath(path)| format!("`{}`", path.display())).collect();
    let names = names.join(" and ");
    Err(Error::input(format!("`{option}` applies only to .png files, and {names} {verb} not"))
        .with_help("add a .png file: -o a.exr -o a.png"))
}
