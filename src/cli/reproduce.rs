//! `photosphere reproduce`: renders a picture again from its metadata, and compares the pixels.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

use crate::error::{Error, Result};
use crate::image_io::{self, ImageWriter, OverlayImage, RawChannel, WriteOptions, temp_folder};
use crate::job::reproduce::{
    ReproduceOptions, Reproduction, ReproductionCost, read_metadata, reproduce,
};
use crate::job::{Metadata, frame_crop, is_checkpoint};
use crate::overlay::OverlaySpec;
use crate::report::{describe_in_standard_errors, describe_in_steps};
use crate::task::memory_limits;

use super::args::ReproduceArgs;
use super::exit::Exit;
use super::progress::{ProgressDisplay, ProgressState};
use super::system::on_threads;
use super::{interrupt, print};

/// Runs the command.
///
/// # Errors
/// If the picture does not record how it was made, if its scene has changed, or if it cannot be
/// rendered.
pub(super) fn run(args: &ReproduceArgs) -> Result<Exit> {
    let path = &args.picture;
    refuse_part(path)?;
    let said = read_metadata(path)?;
    let cost = ReproductionCost::of(&said)?;
    allow(args, &cost)?;
    let then = image_io::read_raw_channels(path)?;
    refuse_other_size(path, &cost, &then)?;
    let temporary = temp_folder()?;
    let (again, now) = on_threads(args.threads, || {
        let again = render(args, &said)?;
        let now = channels(args, &said, &again, temporary.path())?;
        Ok((again, now))
    })?;
    let wrong = differing(&then, &now);
    if wrong.is_empty() {
        let what = print::count(then.len(), "channel");
        print::result(&format!("all pixels agree to the bit, in {what}\n"))?;
        return Ok(Exit::Done);
    }
    let mut words =
        format!("`{}` differs when rendered again, in {}\n", path.display(), wrong.join(", "));
    words += &reasons(&said.program_differences(&again.metadata));
    words += &match is_png(path) {
        true => describe_in_steps(&then, &now),
        false => describe_in_standard_errors(&then, &now, &again.film),
    };
    print::result(&words)?;
    Ok(Exit::CheckFailed)
}

/// Refuses a `.part` file, which has no pixels to compare with.
fn refuse_part(path: &Path) -> Result<()> {
    if !is_checkpoint(path) {
        return Ok(());
    }
    let (shown, path) = (path.display(), print::shell_path(path));
    Err(Error::input(format!("`{shown}` is a part, not a picture"))
        .with_help(format!("merge it first: photosphere merge {path} -o picture.exr")))
}

/// Prints how much work a reproduction is, and refuses too much of it.
fn allow(args: &ReproduceArgs, cost: &ReproductionCost) -> Result<()> {
    let ReproductionCost { pixels, samples, memory } = *cost;
    let path = args.picture.display();
    if samples > args.max_samples {
        let message = format!(
            "`{path}` records {samples} samples in {pixels} pixels, but at most {} are rendered \
             unless you allow more",
            args.max_samples
        );
        let help = format!("if you trust the picture and have the time: --max-samples {samples}");
        return Err(Error::input(message).with_help(help));
    }
    let available = || memory_limits::free().map(|free| free.bytes);
    if let Some(limit) = args.memory.limit.or_else(available) {
        if memory > limit {
            let (needed, limit) = (print::bytes(memory), print::bytes(limit));
            let message = format!("`{path}` needs {needed} of memory, more than {limit}");
            return Err(Error::input(message).with_help("use a machine with more memory"));
        }
    }
    if !args.quiet {
        let all = print::count(pixels as usize, "pixel");
        let samples = print::count(samples as usize, "sample");
        print::note(format_args!("re-rendering {all}, {samples}"));
    }
    Ok(())
}

/// Refuses a picture whose size differs from its record: no pixel could agree.
fn refuse_other_size(path: &Path, cost: &ReproductionCost, then: &[RawChannel]) -> Result<()> {
    let Some(other) = then.iter().find(|channel| channel.bits.len() as u64 != cost.pixels) else {
        return Ok(());
    };
    let (path, pixels, said) = (path.display(), other.bits.len(), cost.pixels);
    let message = format!("`{path}` has {pixels} pixels, but records {said}");
    Err(Error::input(message)
        .with_help("another program resized the picture or changed its record"))
}

fn render(args: &ReproduceArgs, said: &Metadata) -> Result<Reproduction> {
    let interrupt = interrupt::listen();
    let (progress, began) = (ProgressDisplay::new(args.quiet), Instant::now());
    let again = ReproduceOptions {
        folder: folder(args, said),
        backend: args.accel,
        cancel: interrupt.cancel(),
    };
    let result = reproduce(said, &again, &|done, total| {
        progress.show(&ProgressState::since(began, done, total));
    });
    progress.finish();
    result
}

/// Returns the folder of the scene's files.
fn folder(args: &ReproduceArgs, said: &Metadata) -> PathBuf {
    let scene_file = said.run.as_ref().and_then(|run| run.scene_file.as_deref());
    let beside = args.picture.parent().unwrap_or(Path::new(""));
    let then = scene_file.and_then(Path::parent).unwrap_or(beside);
    args.folder.clone().unwrap_or_else(|| then.to_path_buf())
}

/// Returns the channels as a file of the picture stores them, because rounding to its format is
/// part of the result.
fn channels(
    args: &ReproduceArgs,
    said: &Metadata,
    again: &Reproduction,
    folder: &Path,
) -> Result<Vec<RawChannel>> {
    let notes = WriteOptions {
        crop_window: frame_crop(again.film.frame()),
        view_transform: said.look.unwrap_or_default(),
        png_depth: said.bits.unwrap_or_default(),
        overlay: overlay(said).map(Arc::new),
        ..WriteOptions::default()
    };
    let name = if is_png(&args.picture) { "again.png" } else { "again.exr" };
    let file = folder.join(name);
    ImageWriter::new(&file)?.write_with(&again.picture, &notes)?;
    image_io::read_raw_channels(&file)
}

/// Draws what a picture says that is drawn over it, if that is as large as the picture.
fn overlay(said: &Metadata) -> Option<OverlayImage> {
    let image = &said.settings.image;
    let fits = |overlay: &&OverlaySpec| overlay.size == [image.width, image.height];
    said.overlay.as_ref().filter(fits).map(OverlaySpec::draw)
}

fn is_png(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("png"))
}

/// Returns the names of the channels that differ or exist in only one of the two pictures.
fn differing(then: &[RawChannel], now: &[RawChannel]) -> Vec<String> {
    let differs = |channel: &&RawChannel| !now.contains(channel);
    let gone = then.iter().filter(differs).map(|channel| channel.name.clone());
    let is_new = |channel: &&RawChannel| !then.iter().any(|other| other.name == channel.name);
    gone.chain(now.iter().filter(is_new).map(|channel| channel.name.clone())).collect()
}

/// Explains why the picture may differ.
fn reasons(differences: &[String]) -> String {
    if differences.is_empty() {
        return "no difference is known in how it was made: the file was modified, or this is a bug in \
                photosphere; please report it\n"
            .to_owned();
    }
    differences.iter().map(|difference| format!("  {difference}\n")).collect()
}
