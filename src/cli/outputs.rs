//! The files of a picture: prepared before any work, written after it.

use std::path::{Path, PathBuf};

use crate::color::Look;
use crate::error::{Error, Result};
use crate::film::Picture;
use crate::output::{Crop, Notes, Record, Target};
use crate::provenance::{self, Made, Run};
use crate::scene::Scene;

use super::args::OutputArgs;

/// The files that a picture goes to.
pub(super) struct Outputs {
    targets: Vec<(PathBuf, Target)>,
    look: Look,
    with_run: bool,
}

impl Outputs {
    /// Prepares all files.
    ///
    /// # Errors
    /// When one cannot be written, is named twice, or none has a place for what is asked.
    pub(super) fn new(args: &OutputArgs) -> Result<Self> {
        let mut targets: Vec<(PathBuf, Target)> = Vec::new();
        for path in &args.files {
            if targets.iter().any(|(earlier, _)| earlier == path) {
                let message = format!("`{}` is named twice as the picture", path.display());
                return Err(Error::input(message).with_help("leave one out"));
            }
            targets.push((path.clone(), Target::new(path)?));
        }
        if let Some(option) = args.look_option() {
            refuse_look_without_screen(option, &targets)?;
        }
        Ok(Self { targets, look: args.look(), with_run: !args.no_run_figures })
    }

    /// The unfinished files; a program that is about to die may remove them.
    pub(super) fn temporaries(&self) -> impl Iterator<Item = &Path> {
        self.targets.iter().map(|(_, target)| target.temporary())
    }

    /// Writes all files.
    ///
    /// # Errors
    /// When one cannot be written; those before it are.
    pub(super) fn write(
        self,
        picture: &Picture,
        scene: &Scene,
        made: &Made,
        run: &Run,
    ) -> Result<()> {
        let mut records = made.records();
        if self.with_run {
            records.extend(run.records());
        }
        for (_, target) in self.targets {
            let mut records = records.clone();
            if target.is_for_screen() {
                records.extend(look_in_words(&self.look).map(|words| Record::new("look", words)));
            }
            provenance::sort(&mut records);
            let notes = Notes { cropped_from: crop(scene), look: self.look, records };
            target.write_with(picture, &notes)?;
        }
        Ok(())
    }
}

/// Which part of the whole picture the scene asks for.
pub(super) fn crop(scene: &Scene) -> Option<Crop> {
    let image = scene.description().image;
    let window = image.window();
    image.crop.map(|_| Crop {
        full_size: [image.width, image.height].map(|pixels| pixels as usize),
        corner: [window.x, window.y].map(|pixels| pixels as usize),
    })
}

/// Names, in words: `a.png and b.exr`.
pub(super) fn in_words(files: &[PathBuf]) -> String {
    let names: Vec<String> = files.iter().map(|file| file.display().to_string()).collect();
    names.join(" and ")
}

fn refuse_look_without_screen(option: &str, targets: &[(PathBuf, Target)]) -> Result<()> {
    if targets.iter().any(|(_, target)| target.is_for_screen()) {
        return Ok(());
    }
    let files: Vec<&Path> = targets.iter().map(|(path, _)| path.as_path()).collect();
    let names: Vec<String> = files.iter().map(|path| format!("`{}`", path.display())).collect();
    let (names, verb) = (names.join(" and "), if files.len() == 1 { "holds" } else { "hold" });
    Err(Error::input(format!(
        "`{option}` is for .png files, but {names} {verb} light, which stays as it is"
    ))
    .with_help("name a .png file, beside it where you want both: -o a.exr -o a.png"))
}

/// How files for the screen show the picture; `None` for the usual way.
fn look_in_words(look: &Look) -> Option<String> {
    let usual = Look::default();
    let mut words = Vec::new();
    if look.tone != usual.tone {
        words.push(look.tone.name().to_owned());
    }
    if look.exposure != usual.exposure {
        words.push(format!("exposure {}", look.exposure));
    }
    if look.dither {
        words.push("dithered".to_owned());
    }
    (!words.is_empty()).then(|| words.join(", "))
}
