//! The files of a picture: prepared before any work, written after it.

use std::path::{Path, PathBuf};

use crate::color::Look;
use crate::error::{Error, Result};
use crate::film::{Frame, Kind, Layer, Picture};
use crate::output::{Crop, Notes, Record, Target};
use crate::provenance::{self, Made, Run};

use super::args::OutputArgs;

/// The files that a picture goes to.
pub(super) struct Outputs {
    pictures: Vec<File>,
    /// Where the sums themselves go.
    part: Option<PathBuf>,
    look: Look,
    kinds: Vec<Kind>,
    with_run: bool,
}

/// The file of a picture.
pub(super) struct File {
    pub(super) path: PathBuf,
    target: Target,
}

/// What the files of a picture say of it.
pub(super) struct Words {
    notes: Notes,
    layers: Record,
}

/// The name of the record that lists the layers.
const LAYERS: &str = "layers";

/// The layers that a file says it is for, if it does.
pub(super) fn kinds_of(records: &[Record]) -> Option<Vec<Kind>> {
    let record = records.iter().find(|record| record.name == LAYERS)?;
    record.text.split(',').filter(|name| !name.is_empty()).map(Kind::named).collect()
}

impl Outputs {
    /// Prepares all files; with a preview there is something for the screen in any case.
    ///
    /// # Errors
    /// When one cannot be written, is named twice, or none has a place for what is asked.
    pub(super) fn new(args: &OutputArgs, has_preview: bool) -> Result<Self> {
        let mut pictures: Vec<File> = Vec::new();
        let mut part = None;
        for path in &args.files {
            if is_part(path) {
                if let Some(earlier) = part.replace(path.clone()) {
                    let (a, b) = (earlier.display(), path.display());
                    let message = format!("`{a}` and `{b}` are both parts");
                    return Err(Error::input(message).with_help("one holds all there is"));
                }
                continue;
            }
            pictures.push(File { path: path.clone(), target: Target::new(path)? });
        }
        if part.is_none() {
            refuse_layers_without_place(args, &pictures)?;
        }
        if let Some(option) = args.look_option().filter(|_| !has_preview) {
            refuse_look_without_screen(option, args, &pictures)?;
        }
        let (look, kinds, with_run) = (args.look(), args.kinds(), !args.no_run_figures);
        Ok(Self { pictures, part, look, kinds, with_run })
    }

    /// The layers that are asked for.
    pub(super) fn kinds(&self) -> &[Kind] {
        &self.kinds
    }

    /// Says which those are.
    pub(super) fn record_of_layers(&self) -> Record {
        let names: Vec<&str> = self.kinds.iter().map(|kind| kind.row().name).collect();
        Record::new(LAYERS, names.join(","))
    }

    /// Asks for other layers.
    pub(super) fn set_kinds(&mut self, kinds: Vec<Kind>) {
        self.kinds = kinds;
    }

    /// Where the sums themselves go.
    pub(super) fn part(&self) -> Option<&Path> {
        self.part.as_deref()
    }

    /// Whether there is any picture among the files.
    pub(super) fn has_pictures(&self) -> bool {
        !self.pictures.is_empty()
    }

    /// The files of the picture.
    pub(super) fn pictures(&self) -> &[File] {
        &self.pictures
    }

    /// What they say of a picture; `quickly` where somebody waits for the end of writing it.
    pub(super) fn words(&self, frame: &Frame, made: &Made, run: &Run, quickly: bool) -> Words {
        let mut records = made.records();
        if self.with_run {
            records.extend(run.records());
        }
        let notes = Notes { cropped_from: crop(frame), look: self.look, records, quickly };
        Words { notes, layers: self.record_of_layers() }
    }
}

impl File {
    /// Writes the picture, in its own place or in another.
    ///
    /// # Errors
    /// When it cannot be written there.
    pub(super) fn write(
        &self,
        place: Option<&Path>,
        picture: &Picture,
        words: &Words,
    ) -> Result<()> {
        let mut notes = words.notes.clone();
        if self.target.is_for_screen() {
            let look = provenance::look_in_words(&notes.look);
            notes.records.extend(look.map(|words| Record::new("look", words)));
        }
        if self.target.has_layers() {
            notes.records.push(words.layers.clone());
        }
        provenance::sort(&mut notes.records);
        match place {
            None => self.target.write_with(picture, &notes),
            Some(place) => Target::new(place)?.write_with(picture, &notes),
        }
    }
}

/// Refuses two files in one place, however they are written: one would replace the other.
///
/// # Errors
/// With the first two of them.
pub(super) fn refuse_same_places(files: &[(&str, &Path)]) -> Result<()> {
    let places: Vec<PathBuf> = files.iter().map(|(_, file)| place(file)).collect();
    for (at, (option, file)) in files.iter().enumerate() {
        let Some(earlier) = places[..at].iter().position(|place| *place == places[at]) else {
            continue;
        };
        let (first_option, first) = files[earlier];
        let (first, file) = (first.display(), file.display());
        let message = format!("{first_option} {first} and {option} {file} are the same file");
        return Err(Error::input(message).with_help("leave one out, or give it another name"));
    }
    Ok(())
}

/// A file's name from the root on, through links, as far as it is there.
fn place(file: &Path) -> PathBuf {
    let full = std::path::absolute(file).unwrap_or_else(|_| file.to_path_buf());
    let beside = || Some(full.parent()?.canonicalize().ok()?.join(full.file_name()?));
    full.canonicalize().ok().or_else(beside).unwrap_or_else(|| full.clone())
}

/// Which part of the whole picture this is, unless it is all of it.
pub(super) fn crop(frame: &Frame) -> Option<Crop> {
    let Frame { full_size, window } = *frame;
    (*frame != Frame::whole(full_size[0], full_size[1])).then(|| Crop {
        full_size: full_size.map(|pixels| pixels as usize),
        corner: [window.x, window.y].map(|pixels| pixels as usize),
    })
}

/// Whether a file is to hold the sums themselves.
pub(super) fn is_part(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("part"))
}

/// Names, in words: `a.png and b.exr`.
pub(super) fn in_words(files: &[PathBuf]) -> String {
    let names: Vec<String> = files.iter().map(|file| file.display().to_string()).collect();
    names.join(" and ")
}

/// `.png` has the beauty, and alpha; the formats of linear light have the beauty alone.
fn refuse_layers_without_place(args: &OutputArgs, files: &[File]) -> Result<()> {
    let any = |test: fn(&Target) -> bool| files.iter().any(|file| test(&file.target));
    if !args.asks_for_layers() || any(Target::has_layers) {
        return Ok(());
    }
    let has_place = |kind: &Kind| match kind {
        Kind::Beauty => true,
        Kind::Mean(Layer::Alpha) => any(Target::is_for_screen),
        _ => false,
    };
    let Some(homeless) = args.kinds().into_iter().find(|kind| !has_place(kind)) else {
        return Ok(());
    };
    let (layer, names) = (homeless.row().name, quoted(files));
    let verb = if files.len() == 1 { "has" } else { "have" };
    Err(Error::input(format!("{names} {verb} no place for the layer `{layer}`"))
        .with_help("layers go into .exr files; name one beside it where you want both"))
}

fn quoted(files: &[File]) -> String {
    let names: Vec<String> =
        files.iter().map(|file| format!("`{}`", file.path.display())).collect();
    names.join(" and ")
}

fn refuse_look_without_screen(option: &str, args: &OutputArgs, files: &[File]) -> Result<()> {
    if files.iter().any(|file| file.target.is_for_screen()) {
        return Ok(());
    }
    let verb = if args.files.len() == 1 { "holds" } else { "hold" };
    let names: Vec<String> =
        args.files.iter().map(|path| format!("`{}`", path.display())).collect();
    let names = names.join(" and ");
    Err(Error::input(format!(
        "`{option}` is for .png files, but {names} {verb} light, which stays as it is"
    ))
    .with_help("name a .png file, beside it where you want both: -o a.exr -o a.png"))
}
