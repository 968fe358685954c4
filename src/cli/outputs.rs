//! The files of a picture: prepared before any work, written after it.

use std::path::{Path, PathBuf};

use crate::color::Look;
use crate::error::{Error, Result};
use crate::film::{Kind, Layer, Picture};
use crate::output::{Crop, Notes, Record, Target};
use crate::provenance::{self, Made, Run};
use crate::scene::Scene;

use super::args::OutputArgs;

/// The files that a picture goes to.
pub(super) struct Outputs {
    targets: Vec<(PathBuf, Target)>,
    look: Look,
    kinds: Vec<Kind>,
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
        refuse_layers_without_place(args, &targets)?;
        if let Some(option) = args.look_option() {
            refuse_look_without_screen(option, &targets)?;
        }
        Ok(Self { targets, look: args.look(), kinds: args.kinds(), with_run: !args.no_run_figures })
    }

    /// The layers that are asked for.
    pub(super) fn kinds(&self) -> &[Kind] {
        &self.kinds
    }

    /// Writes all files.
    ///
    /// # Errors
    /// When one cannot be written; those before it are.
    pub(super) fn write(
        &self,
        picture: &Picture,
        scene: &Scene,
        made: &Made,
        run: &Run,
    ) -> Result<()> {
        let mut records = made.records();
        if self.with_run {
            records.extend(run.records());
        }
        for (_, target) in &self.targets {
            let mut records = records.clone();
            if target.is_for_screen() {
                records.extend(look_in_words(&self.look).map(|words| Record::new("look", words)));
            }
            if target.has_layers() {
                let names: Vec<&str> = self.kinds.iter().map(|kind| kind.row().name).collect();
                records.push(Record::new("layers", names.join(",")));
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

/// `.png` has the beauty, and alpha; the formats of linear light have the beauty alone.
fn refuse_layers_without_place(args: &OutputArgs, targets: &[(PathBuf, Target)]) -> Result<()> {
    let any = |test: fn(&Target) -> bool| targets.iter().any(|(_, target)| test(target));
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
    let (layer, names) = (homeless.row().name, quoted(targets));
    let verb = if targets.len() == 1 { "has" } else { "have" };
    Err(Error::input(format!("{names} {verb} no place for the layer `{layer}`"))
        .with_help("layers go into .exr files; name one beside it where you want both"))
}

fn quoted(targets: &[(PathBuf, Target)]) -> String {
    let names: Vec<String> =
        targets.iter().map(|(path, _)| format!("`{}`", path.display())).collect();
    names.join(" and ")
}

fn refuse_look_without_screen(option: &str, targets: &[(PathBuf, Target)]) -> Result<()> {
    if targets.iter().any(|(_, target)| target.is_for_screen()) {
        return Ok(());
    }
    let (names, verb) = (quoted(targets), if targets.len() == 1 { "holds" } else { "hold" });
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
