//! How `photosphere bench` measures a scene or the suite.

use crate::cli::args::BenchArgs;
use crate::cli::interrupt::Interrupt;
use crate::cli::{print, system};
use crate::verify::bench::{BenchOptions, BenchPlan};

/// Returns the plan that the options describe.
pub(super) fn bench_plan(args: &BenchArgs, interrupt: &Interrupt) -> BenchPlan {
    BenchPlan {
        rounds: args.rounds.into(),
        builds: args.builds.into(),
        quality: args.build.quality,
        batches: args.batches.iter().map(|&batch| batch as usize).collect(),
        scaling: args.scaling,
        cancel: interrupt.cancel(),
    }
}

/// Describes the machine and the measurement.
pub(super) fn circumstances(rounds: BenchOptions) -> String {
    let threads = print::count(rayon::current_num_threads(), "thread");
    let processor = system::processor().map_or(String::new(), |name| format!(" of {name}"));
    let rays = print::count(rounds.batch, "ray");
    format!(
        "{threads}{processor}, {rays} a call, median of {}",
        print::count(rounds.rounds, "round")
    )
}
