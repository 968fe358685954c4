//! Facts about this machine from the operating system (`None` where unknown), about this process,
//! and thread pools.

use std::ffi::OsString;
use std::sync::OnceLock;

use crate::error::{Error, Result};

pub(super) use crate::task::{peak_memory, total_memory};

/// Maximum number of threads. More than any machine has cores would not start.
pub(super) const MAX_THREADS: u16 = 4096;

/// Checks the number of threads that the environment asks for, and starts the thread for parallel
/// work outside any pool, which rayon would otherwise start itself, or panic.
///
/// # Errors
/// If the number is too large, or no thread can be started.
pub(super) fn prepare_threads() -> Result<()> {
    for name in ["RAYON_NUM_THREADS", "RAYON_RS_NUM_CPUS"] {
        let asked = std::env::var(name).unwrap_or_default();
        let is_number = !asked.is_empty() && asked.bytes().all(|digit| digit.is_ascii_digit());
        if is_number && asked.parse().map_or(true, |threads: u64| threads > MAX_THREADS.into()) {
            let message = format!(
                "the environment variable {name} asks for {asked} threads, more than {MAX_THREADS}"
            );
            return Err(Error::input(message).with_help("set it to a smaller number, or unset it"));
        }
    }
    rayon::ThreadPoolBuilder::new().num_threads(1).build_global().map_err(no_threads)
}

fn no_threads(e: rayon::ThreadPoolBuildError) -> Error {
    Error::input(format!("cannot start the threads: {e}"))
        .with_help("ask for fewer with --threads, or raise the limits of the system (ulimit -a)")
}

/// Runs `work` on a rayon pool of this many threads, by default one per core.
///
/// # Errors
/// If the threads cannot be started, and the errors of `work`.
pub(super) fn on_threads<T: Send>(
    threads: Option<usize>,
    work: impl FnOnce() -> Result<T> + Send,
) -> Result<T> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads.unwrap_or(0)).build();
    pool.map_err(no_threads)?.install(work)
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

/// The program's arguments, if they are not those of the process.
static ARGUMENTS: OnceLock<Vec<OsString>> = OnceLock::new();

/// Sets the arguments of the program.
pub(super) fn set_arguments(words: Vec<OsString>) {
    ARGUMENTS.get_or_init(|| words);
}

/// Returns the arguments of the program, the first of which is its name.
pub(super) fn arguments() -> impl Iterator<Item = OsString> {
    ARGUMENTS.get_or_init(|| std::env::args_os().collect()).iter().cloned()
}

/// Returns the command line quoted for a shell, starting with the program's name.
pub(super) fn command_line() -> String {
    let arguments: Vec<String> =
        arguments().skip(1).map(|word| word.to_string_lossy().into_owned()).collect();
    let words = std::iter::once("photosphere").chain(arguments.iter().map(String::as_str));
    // Only a zero byte cannot be quoted, and no argument contains one.
    shlex::try_join(words).unwrap_or_default()
}
