//! Memory of this machine and of this process, from the operating system; `None` where unknown.

use std::path::Path;

use super::memory_limits::{self, kibibytes};

/// Returns the peak memory of this process so far, in bytes.
pub fn peak_memory() -> Option<u64> {
    kibibytes(Path::new("/proc/self/status"), "VmHWM:")
}

/// Returns the memory of this machine, in bytes.
pub fn total_memory() -> Option<u64> {
    kibibytes(Path::new("/proc/meminfo"), "MemTotal:")
}

/// Returns the memory that this process may still take, in bytes.
pub fn available_memory() -> Option<u64> {
    memory_limits::free().map(|free| free.bytes)
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::*;

    #[test]
    fn linux_says_all_of_it() {
        let (peak, memory) = (peak_memory().unwrap(), total_memory().unwrap());
        assert!(peak > 1 << 16 && peak < memory);
        assert!(available_memory().unwrap() <= memory);
    }
}
