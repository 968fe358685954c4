//! `photosphere convert`: shows a picture in another way.

use std::path::Path;

use crate::convert::{Converted, convert};
use crate::error::{Error, Result};
use crate::image_io::{FileFormat, ImageWriter, PngDepth};

use super::args::ConvertArgs;
use super::exit::Exit;
use super::outputs::{is_part, place, refuse_streams};
use super::print;
use super::system::on_threads;

/// Runs the command.
///
/// # Errors
/// If the picture cannot be read or written, or an option does not suit it.
pub(super) fn run(args: &ConvertArgs) -> Result<Exit> {
    refuse_other(&args.input, &args.output)?;
    let to = FileFormat::from_path(&args.output)?;
    let options = args.options();
    refuse_without_screen(&args.output, to, args.given(), options.look.dither, args.bits)?;
    let target = ImageWriter::new(&args.output)?;
    on_threads(None, || {
        let converted = convert(&args.input, to, &options)?;
        warn_of_record(&args.input, &converted);
        warn_of_steps(&args.input, &converted);
        target.write_with(&converted.picture, &converted.options)?;
        if !args.quiet && !converted.done.is_empty() {
            print::note(format_args!("{}: {}", args.output.display(), converted.done.join(", ")));
        }
        Ok(Exit::Done)
    })
}

/// Warns if the new file cannot say how the picture was made.
pub(super) fn warn_of_record(input: &Path, converted: &Converted) {
    if !converted.is_record_understood {
        print::warning(format_args!(
            "another version of photosphere wrote how `{}` was made; the new file does not say it",
            input.display()
        ));
    }
}

/// Warns if the new file has finer steps than the old one.
pub(super) fn warn_of_steps(input: &Path, converted: &Converted) {
    if converted.is_finer_than_source {
        print::warning(format_args!(
            "`{}` has 8 bits: 16 show the same 256 steps; for finer ones, convert the .exr file",
            input.display()
        ));
    }
}

/// Refuses an input or output that is no picture file, and an output that is the input.
///
/// # Errors
/// Says which.
pub(super) fn refuse_other(input: &Path, output: &Path) -> Result<()> {
    refuse_part(input)?;
    refuse_streams(&[output.to_path_buf()])?;
    refuse_same(input, output)
}

fn refuse_part(path: &Path) -> Result<()> {
    if !is_part(path) {
        return Ok(());
    }
    let (shown, path) = (path.display(), print::shell_path(path));
    Err(Error::input(format!("`{shown}` is a part, not a picture"))
        .with_help(format!("merge it first: photosphere merge {path} -o picture.exr")))
}

fn refuse_same(input: &Path, output: &Path) -> Result<()> {
    if place(input) != place(output) {
        return Ok(());
    }
    let shown = input.display();
    Err(Error::input(format!("the new picture would replace `{shown}`, which it is made from"))
        .with_help("give -o another name"))
}

/// Refuses options that apply only to files for the screen, and dithering of 16 bits.
///
/// # Errors
/// Names the first such option of `given`.
pub(super) fn refuse_without_screen(
    output: &Path,
    to: FileFormat,
    given: impl IntoIterator<Item = (&'static str, bool)>,
    dither: bool,
    bits: Option<PngDepth>,
) -> Result<()> {
    let path = output.display();
    let option = given.into_iter().find(|(_, given)| *given && !to.is_display_referred());
    if let Some((option, _)) = option {
        return Err(Error::input(format!(
            "`{option}` applies only to .png files, and `{path}` is not"
        ))
        .with_help("write a .png file, or leave the option out"));
    }
    if dither && bits == Some(PngDepth::Sixteen) {
        let message = "`--dither` hides the steps of 8 bits, and 16 bits have none to hide";
        return Err(Error::input(message).with_help("leave one of the two out"));
    }
    Ok(())
}
