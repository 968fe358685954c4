//! `photosphere bench --suite`: measures the standard scenes at increasing sizes, for one page.

use std::io::Write;
use std::path::Path;

use crate::accel::{EmbreeInfo, embree_info};
use crate::cli::args::BenchArgs;
use crate::cli::exit::Exit;
use crate::cli::interrupt::Interrupt;
use crate::cli::{print, system};
use crate::error::Result;
use crate::image_io::AtomicFile;
use crate::job::COMMIT;
use crate::report::speed::{entries_json, page};
use crate::task::memory_limits;
use crate::verify::bench::{BenchOptions, Suite, SuiteEvent};

use super::plan::{bench_plan, circumstances};

/// Sphere count of the largest scene, unless `--largest` is given.
const LARGEST: u64 = 100_000_000;

/// Runs the command.
///
/// # Errors
/// If an intersector cannot be built, or the page cannot be written.
pub(super) fn run(args: &BenchArgs, path: &Path, interrupt: &Interrupt) -> Result<Exit> {
    let file = AtomicFile::with_extension(path, "html")?;
    let suite = Suite {
        plan: bench_plan(args, interrupt),
        backends: args.accels.backends().to_vec(),
        max_spheres: args.largest.unwrap_or(LARGEST),
        memory: args.memory.limit.or_else(|| memory_limits::free().map(|free| free.bytes)),
    };
    let entries = suite.measure(&mut |event| {
        match event {
            SuiteEvent::Skipped(backend, spheres) => {
                let name = backend.name();
                print::note(format_args!("{spheres} spheres with {name} do not fit into memory"));
            }
            SuiteEvent::Finished(entry) => {
                print::note(entry);
                interrupt.enable_saving();
            }
        };
    })?;
    let rounds = suite.plan.rounds();
    let text = page(&facts(rounds), &entries)?;
    file.write(|to| to.write_all(text.as_bytes()))?;
    print::note(format_args!("wrote {}", path.display()));
    if args.json {
        print::json(&entries_json(&entries, rounds))?;
    }
    Ok(if suite.plan.cancel.is_cancelled() { Exit::Stopped } else { Exit::Done })
}

fn facts(rounds: BenchOptions) -> [(&'static str, String); 4] {
    let embree = match embree_info() {
        Some(Ok(EmbreeInfo { runtime_version, instruction_set, .. })) => {
            format!("{runtime_version}, {instruction_set}")
        }
        _ => "none".to_owned(),
    };
    [
        ("program", format!("photosphere {}, {COMMIT}", env!("CARGO_PKG_VERSION"))),
        ("embree", embree),
        ("measured with", circumstances(rounds)),
        ("memory", system::total_memory().map_or("unknown".to_owned(), print::bytes)),
    ]
}
