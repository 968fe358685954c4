//! What the operating system says of memory; `None` where it does not say.

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
