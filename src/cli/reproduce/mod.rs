//! `photosphere reproduce`: a picture again, from what it says of itself.

mod again;
mod words;

use std::path::{Path, PathBuf};

use crate::color::Look;
use crate::error::{Error, Result};
use crate::film::{Kind, Layer};
use crate::output::{self, RawChannel};
use crate::provenance::{self, Made};

use super::args::ReproduceArgs;
use super::exit::Exit;
use super::{on_threads, print};

use again::Again;

/// What a picture says of itself, as far as it is needed here.
struct Said {
    made: Made,
    look: Look,
    kinds: Vec<Kind>,
    scene_file: Option<PathBuf>,
}

/// # Errors
/// When the picture does not say how it was made, when its scene is not what it was, or when it
/// cannot be rendered.
pub(super) fn run(args: &ReproduceArgs) -> Result<Exit> {
    let path = &args.picture;
    refuse_part(path)?;
    let said = read(path)?;
    let then = output::raw_channels(path)?;
    let again = on_threads(args.threads, || Again::of(args, &said))?;
    let wrong = differing(&then, &again.channels);
    let count = then.len();
    if wrong.is_empty() {
        let what = print::count(count, "channel");
        print::result(&format!("all pixels agree to the bit, in {what}\n"))?;
        return Ok(Exit::Done);
    }
    print::result(&in_words(path, &said, &then, &again, &wrong))?;
    Ok(Exit::CheckFailed)
}

/// A part has no pixels to compare with.
fn refuse_part(path: &Path) -> Result<()> {
    if !output::is_part_file(path) {
        return Ok(());
    }
    let path = path.display();
    Err(Error::input(format!("`{path}` is a part, and a part is no picture")).with_help(format!(
        "make a picture of it first: photosphere merge '{path}' -o picture.exr"
    )))
}

fn read(path: &Path) -> Result<Said> {
    let records = output::records(path)?;
    let made = Made::read(path, &records)?;
    let text = |name: &str| records.iter().find(|r| r.name == name).map(|r| r.text.as_str());
    let strange = |name: &str| {
        let message = format!("`{}` says `{name}` in a way that is not understood", path.display());
        Error::input(message).with_help("it may be of a newer version of photosphere")
    };
    let look = match text("look") {
        None => Look::default(),
        Some(words) => provenance::look_of_words(words).ok_or_else(|| strange("look"))?,
    };
    let kinds = match text("layers") {
        None if made_with_alpha(path)? => vec![Kind::Mean(Layer::Alpha)],
        None => Vec::new(),
        Some("") => Vec::new(),
        Some(names) => {
            let kinds: Option<Vec<Kind>> = names.split(',').map(Kind::named).collect();
            kinds.ok_or_else(|| strange("layers"))?
        }
    };
    Ok(Said { made, look, kinds, scene_file: text("scene-file").map(PathBuf::from) })
}

/// Whether a picture has an alpha channel, which the scene or the command may have asked for.
fn made_with_alpha(path: &Path) -> Result<bool> {
    Ok(output::raw_channels(path)?.iter().any(|channel| channel.name == "A"))
}

impl Said {
    fn is_png(&self, path: &Path) -> bool {
        path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("png"))
    }
}

/// The names of the channels that differ, or that only one of both has.
fn differing(then: &[RawChannel], now: &[RawChannel]) -> Vec<String> {
    let differs = |channel: &&RawChannel| !now.contains(channel);
    let gone = then.iter().filter(differs).map(|channel| channel.name.clone());
    let is_new = |channel: &&RawChannel| !then.iter().any(|other| other.name == channel.name);
    gone.chain(now.iter().filter(is_new).map(|channel| channel.name.clone())).collect()
}

fn in_words(
    path: &Path,
    said: &Said,
    then: &[RawChannel],
    again: &Again,
    wrong: &[String],
) -> String {
    let mut words =
        format!("`{}` comes out differently, in {}\n", path.display(), wrong.join(", "));
    let differences = said.made.differences(&again.made);
    if differences.is_empty() {
        words += "nothing that is known differs in how it was made: the file was changed since, or this \
                  is a mistake of photosphere; please report it\n";
    }
    for difference in differences {
        words += &format!("  {difference}\n");
    }
    words += &match said.is_png(path) {
        true => words::in_steps(then, &again.channels),
        false => words::in_standard_errors(then, &again.channels, &again.film),
    };
    words
}
