//! What the operating system says of memory, `None` where it does not say; and of this very run.

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
