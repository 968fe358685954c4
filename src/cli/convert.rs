//! `photosphere convert`: shows a picture in another way.

use std::path::Path;

use crate::convert::convert;
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
    refuse_part(&args.input)?;
    refuse_streams(std::slice::from_ref(&args.output))?;
    refuse_same(&args.input, &args.output)?;
    let to = FileFormat::from_path(&args.output)?;
    refuse_without_screen(args, to)?;
    let target = ImageWriter::new(&args.output)?;
    on_threads(None, || {
        let converted = convert(&args.input, to, &args.options())?;
        if !converted.is_record_understood {
            print::warning(format_args!(
                "another version of photosphere wrote how `{}` was made; the new file does not say it",
                args.input.display()
            ));
        }
        target.write_with(&converted.picture, &converted.options)?;
        if !args.quiet && !converted.done.is_empty() {
            print::note(format_args!("{}: {}", args.output.display(), converted.done.join(", ")));
        }
        Ok(Exit::Done)
    })
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

fn refuse_without_screen(args: &ConvertArgs, to: FileFormat) -> Result<()> {
    let path = args.output.display();
    if let Some(option) = args.options_for_screen().next().filter(|_| !to.is_display_referred()) {
        return Err(Error::input(format!(
            "`{option}` applies only to .png files, and `{path}` is not"
        ))
        .with_help("write a .png file, or leave the option out"));
    }
    if args.options().look.dither && args.bits == Some(PngDepth::Sixteen) {
        let message = "`--dither` hides the steps of 8 bits, and 16 bits have none to hide";
        return Err(Error::input(message).with_help("leave one of the two out"));
    }
    Ok(())
}
