//! The options of `photosphere verify`.

use std::path::PathBuf;

use clap::Args;

use crate::verify::check::Effort;

use super::accel::AccelsArg;
use super::values::threads;

/// Check this program on this machine: its intersectors, its sampling, its materials and its light
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  photosphere verify --quick
  photosphere verify --report report.html
  photosphere verify --full --accel native --report native.html
  photosphere verify --list --only glass

Four groups of checks, each against something that is known without the renderer:
  crosscheck    every intersector against arithmetic of twice the digits of f64
  chi-square    every sampling routine against its density
  materials     no material creates energy, and every one is reciprocal
  closed forms  whole renders, for every estimator, sampler and intersector,
                against answers known on paper (docs/verification.md)

What is random is judged by how far it is from the answer, in standard deviations (sigma). The limit
is the same for all and so high that a right program fails any of the checks by chance with a
probability of at most 1 in 1000. The random numbers are fixed: the same build gives the same result
on every run. A failure by chance would be one check a little over its limit that is gone with other
samples (another of --quick and --full); an error is far over, or comes back.

The exit code is 1 if a check failed. Ctrl-C stops at once and writes no report.")]
pub struct VerifyArgs {
    /// Few samples: less than a minute on two cores
    #[arg(long, conflicts_with = "full")]
    quick: bool,

    /// Every combination with four times the samples of the default: half an hour or more
    #[arg(long)]
    full: bool,

    /// Write a report with pictures, one HTML file that needs nothing beside it
    #[arg(long, value_name = "FILE.html")]
    pub report: Option<PathBuf>,

    #[command(flatten)]
    pub accels: AccelsArg,

    /// Only checks whose name or group contains this, as in --only occluder; may be repeated
    #[arg(long, value_name = "TEXT")]
    pub only: Vec<String>,

    /// Print the group and the name of each check, and run none
    #[arg(long, conflicts_with_all = ["report", "json"])]
    pub list: bool,

    /// Threads to use; all cores by default. The result does not depend on it
    #[arg(long, value_name = "T", value_parser = threads())]
    pub threads: Option<usize>,

    /// Print one JSON object with every check instead of the table
    #[arg(long)]
    pub json: bool,

    /// Show no progress
    #[arg(short, long)]
    pub quiet: bool,
}

impl VerifyArgs {
    /// Returns the requested effort.
    pub fn effort(&self) -> Effort {
        match (self.quick, self.full) {
            (true, _) => Effort::Quick,
            (_, true) => Effort::Full,
            _ => Effort::Normal,
        }
    }
}
