//! `photosphere cite`: text for the methods section of a paper.

use crate::error::Result;
use crate::report::{FileRecords, citation};

use super::args::CiteArgs;
use super::exit::Exit;
use super::print;

/// Runs the command.
///
/// # Errors
/// If the picture cannot be read, or does not say how it was made.
pub(super) fn run(args: &CiteArgs) -> Result<Exit> {
    let records = args.picture.as_deref().map(FileRecords::read).transpose()?;
    let metadata = records.as_ref().map(FileRecords::metadata);
    print::result(&match metadata.filter(|_| !args.bibtex) {
        Some(metadata) => citation::methods(metadata),
        None => citation::bibtex(metadata),
    })?;
    Ok(Exit::Done)
}
