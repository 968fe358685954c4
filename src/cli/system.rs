//! Facts about this machine from the operating system (`None` where unknown), about this process,
//! and thread pools.

use crate::error::{Error, Result};

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

/// Returns the peak memory of this process so far, in bytes.
pub(super) fn peak_memory() -> Option<u64> {
    kibibytes("/proc/self/status", "VmHWM:")
}

/// Returns the memory of this machine, in bytes.
pub(super) fn memory() -> Option<u64> {
    kibibytes("/proc/meminfo", "MemTotal:")
}

/// Returns the memory available without swapping, in bytes.
pub(super) fn available_memory() -> Option<u64> {
    kibibytes("/proc/meminfo", "MemAvailable:")
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

/// Reads a line such as `VmHWM:    1234 kB` and returns bytes.
fn kibibytes(file: &str, key: &str) -> Option<u64> {
    let text = std::fs::read_to_string(file).ok()?;
    let value = text.lines().find_map(|line| line.strip_prefix(key))?;
    Some(1024 * value.split_whitespace().next()?.parse::<u64>().ok()?)
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::*;

    #[test]
    fn linux_says_all_of_it() {
        let (peak, memory) = (peak_memory().unwrap(), memory().unwrap());
        assert!(peak > 1 << 16 && peak < memory);
        assert!(available_memory().unwrap() <= memory);
    }
}
