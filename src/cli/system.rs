//! What the operating system says of this machine, `None` where it does not say; this very run, and
//! its threads.

use crate::error::{Error, Result};

/// Runs `work` on so many threads, all cores by default; rayon inside it uses no others.
///
/// # Errors
/// When the threads cannot be started, and those of the work.
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

/// The most memory that this process has held so far, in bytes.
pub(super) fn peak_memory() -> Option<u64> {
    kibibytes("/proc/self/status", "VmHWM:")
}

/// The memory of this machine, in bytes.
pub(super) fn memory() -> Option<u64> {
    kibibytes("/proc/meminfo", "MemTotal:")
}

/// The memory that could still be had without swapping, in bytes.
pub(super) fn available_memory() -> Option<u64> {
    kibibytes("/proc/meminfo", "MemAvailable:")
}

/// The name of the processor.
pub(super) fn processor() -> Option<String> {
    let text = std::fs::read_to_string("/proc/cpuinfo").ok()?;
    let line = text.lines().find(|line| line.starts_with("model name"))?;
    Some(line.split_once(':')?.1.trim().to_owned())
}

/// The cores of this machine, and how busy they were during the last minute.
pub(super) fn load() -> String {
    let cores = std::thread::available_parallelism().map_or(0, usize::from);
    let load = std::fs::read_to_string("/proc/loadavg").unwrap_or_default();
    format!("{cores} cores, load {}", load.split(' ').next().unwrap_or_default())
}

/// The command line, quoted for a shell, with the program by its name.
pub(super) fn command_line() -> String {
    let arguments: Vec<String> =
        std::env::args_os().skip(1).map(|word| word.to_string_lossy().into_owned()).collect();
    let words = std::iter::once("photosphere").chain(arguments.iter().map(String::as_str));
    // What cannot be quoted holds a zero byte, which no argument can.
    shlex::try_join(words).unwrap_or_default()
}

/// A line such as `VmHWM:    1234 kB`, in bytes.
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
