//! The options of `photosphere verify`.

use std::path::PathBuf;

use clap::Args;

use crate::verify::check::Effort;

use super::accel::AccelsArg;
use super::values::threads;

/// Test the installation: intersectors, sampling, materials, and whole renders
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  photosphere verify --quick
  photosphere verify --report report.html
  photosphere verify --full --accel native --report native.html
  photosphere verify --list --only glass

There are five groups of checks, each against answers that are known without what is checked:
  crosscheck    every intersector against double-double arithmetic
  chi-square    every sampling routine against its pdf
  materials     energy conservation and reciprocity of every material
  connections   light over polished balls in closed form, against chance
  closed forms  whole renders, for every estimator, sampler and intersector,
                against answers derived on paper (docs/verification.md)

Statistical checks are judged by their deviation from the answer in standard deviations (sigma). All
share one limit, so high that a correct build fails by chance with probability at most 0.001. Random
numbers are fixed: the same build gives the same result on every run. A failure by chance is a single
check a little over the limit that passes with other samples (--quick, the default or --full); a bug
is far over the limit, or fails again.

The exit code is 1 if a check failed. Ctrl-C stops at once and writes no report.")]
pub struct VerifyArgs {
    /// Few samples: about two minutes on two cores
    #[arg(long, conflicts_with = "full")]
    quick: bool,

    /// Every combination, and four times the default samples: half an hour or more
    #[arg(long)]
    full: bool,

    /// Write a self-contained HTML report with pictures
    #[arg(long, value_name = "FILE.html")]
    pub report: Option<PathBuf>,

    #[command(flatten)]
    pub accels: AccelsArg,

    /// Run only checks whose name or group contains this, such as occluder; may be repeated
    #[arg(long, value_name = "TEXT")]
    pub only: Vec<String>,

    /// Print the group and the name of each check without running it
    #[arg(long, conflicts_with_all = ["report", "json"])]
    pub list: bool,

    /// Threads to use [default: all cores that affinity and CPU quota allow];
    /// the result does not depend on it
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
