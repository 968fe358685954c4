//! `photosphere cite`: text for the methods section of a paper.

use std::path::Path;

use crate::error::{Error, Result};
use crate::image_io::has_picture_extension;
use crate::report::{FileRecords, citation};

use super::args::CiteArgs;
use super::exit::Exit;
use super::outputs::is_part;
use super::print;

/// Runs the command.
///
/// # Errors
/// If the picture cannot be read, or does not say how it was made.
pub(super) fn run(args: &CiteArgs) -> Result<Exit> {
    let records = args.picture.as_deref().map(read).transpose()?;
    let metadata = records.as_ref().map(FileRecords::metadata);
    print::result(&match metadata.filter(|_| !args.bibtex) {
        Some(metadata) => citation::methods(metadata),
        None => citation::bibtex(metadata),
    })?;
    Ok(Exit::Done)
}

fn read(path: &Path) -> Result<FileRecords> {
    if has_picture_extension(path) || is_part(path) {
        return FileRecords::read(path);
    }
    let message = format!("`{}` is no picture", path.display());
    Err(Error::input(message).with_help(
        "cite takes a picture that photosphere wrote, as .png or .exr, which says how it was made; \
         also a part or a checkpoint",
    ))
}
