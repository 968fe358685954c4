//! `photosphere denoise`: removes the noise of a finished picture.

use std::sync::Arc;

use crate::convert::{ConvertOptions, convert};
use crate::denoise::Denoiser;
use crate::error::Result;
use crate::image_io::{FileFormat, ImageWriter};

use super::args::DenoiseArgs;
use super::convert::{refuse_other, refuse_without_screen, warn_of_record};
use super::exit::Exit;
use super::print;
use super::system::on_threads;

/// Runs the command.
///
/// # Errors
/// If the library is not installed, or the picture cannot be read or written.
pub(super) fn run(args: &DenoiseArgs) -> Result<Exit> {
    refuse_other(&args.input, &args.output)?;
    let to = FileFormat::from_path(&args.output)?;
    let given = args.look.given().into_iter().chain([("--bits", args.bits.is_some())]);
    refuse_without_screen(&args.output, to, given, args.look.look().dither, args.bits)?;
    let target = ImageWriter::new(&args.output)?;
    let denoiser = Arc::new(Denoiser::load()?);
    let options = ConvertOptions {
        denoiser: Some(denoiser.clone()),
        look: args.look.look(),
        png_depth: args.bits.unwrap_or_default(),
        dpi: args.look.dpi,
        ..ConvertOptions::default()
    };
    on_threads(args.threads, || {
        let converted = convert(&args.input, to, &options)?;
        warn_of_record(&args.input, &converted);
        target.write_with(&converted.picture, &converted.options)?;
        if !args.quiet {
            let path = args.output.display();
            print::note(format_args!("wrote {path}, denoised by {}: biased", denoiser.name()));
        }
        Ok(Exit::Done)
    })
}
