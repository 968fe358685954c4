//! The options of `photosphere cite`.

use std::path::PathBuf;

use clap::Args;

/// Print how a picture was made, for the methods section of a paper, and what to cite
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  photosphere cite fig2.exr
  photosphere cite fig2.png --bibtex >> references.bib
  photosphere cite --bibtex

The sentences are made of the picture's own record: its size, the method, samples, error, options that
bias it, the version of the program, and the first digits of the hashes that `photosphere info` prints
in full. --bibtex prints entries for the program, in the version that made the picture, and for the
methods; without a picture, for this version alone.")]
pub struct CiteArgs {
    /// The picture, part or checkpoint
    #[arg(value_name = "PICTURE", required_unless_present = "bibtex")]
    pub picture: Option<PathBuf>,

    /// Print BibTeX entries instead
    #[arg(long)]
    pub bibtex: bool,
}
