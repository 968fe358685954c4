//! Facts about this machine from the operating system (`None` where unknown), about this process,
//! and thread pools.

use crate::error::{Error, Result};

pub(super) use crate::task::{available_memory, peak_memory, total_memory};

/// Runs `work` on a rayon pool of this many threads, by default one per core.
///
/// # Errors
/// If the threads cannot be started, and the errors of `work`.
pub(super) fn on_threads<T: Send>(
    threads: Option<usize>,
    work: impl FnOnce() -> Result<T> + Send,
) -> Result<T> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads.unwrap_or(0)).build();
    let pool = pool.map_err(|e| {
        Error::input(format!("cannot start the threads: {e}"))
            .with_help("ask for fewer with --threads")
    })?;
    pool.install(work)
}

/// Returns the name of the processor.
pub(super) fn processor() -> Option<String> {
    let text = std::fs::read_to_string("/proc/cpuinfo").ok()?;
    let line = text.lines().find(|line| line.starts_with("model name"))?;
    Some(line.split_once(':')?.1.trim().to_owned())
}

/// Describes the cores of this machine and their load over the last minute.
pub(super) fn load() -> String {
    let cores = std::thread::available_parallelism().map_or(0, usize::from);
    let load = std::fs::read_to_string("/proc/loadavg").unwrap_or_default();
    format!("{cores} cores, load {}", load.split(' ').next().unwrap_or_default())
}

/// Returns the command line quoted for a shell, starting with the program's name.
pub(super) fn command_line() -> String {
    let arguments: Vec<String> =
        std::env::args_os().skip(1).map(|word| word.to_string_lossy().into_owned()).collect();
    let words = std::iter::once("photosphere").chain(arguments.iter().map(String::as_str));
    // Only a zero byte cannot be quoted, and no argument contains one.
    shlex::try_join(words).unwrap_or_default()
}
