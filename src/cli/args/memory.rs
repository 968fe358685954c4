//! The option that limits memory.

use clap::Args;

/// How much memory may be used.
#[derive(Args, Clone, Copy, Debug)]
pub(in crate::cli) struct MemoryArg {
    /// Refuse, before anything is loaded, what would need more memory than this, as in 8GiB
    #[arg(long = "memory-limit", value_name = "SIZE", value_parser = bytes)]
    pub(in crate::cli) limit: Option<u64>,
}

/// A number of bytes with a unit.
fn bytes(text: &str) -> Result<u64, String> {
    const UNITS: [(&str, f64); 9] = [
        ("KiB", 1024.0),
        ("MiB", 1_048_576.0),
        ("GiB", 1_073_741_824.0),
        ("TiB", 1_099_511_627_776.0),
        ("kB", 1e3),
        ("MB", 1e6),
        ("GB", 1e9),
        ("TB", 1e12),
        ("B", 1.0),
    ];
    let refused = || "it must be a size with its unit, as in 8GiB or 500MB".to_owned();
    let (number, unit) = UNITS
        .iter()
        .find_map(|(name, unit)| Some((text.strip_suffix(name)?, unit)))
        .ok_or_else(refused)?;
    let number: f64 = number.trim().parse().map_err(|_| refused())?;
    let size = number * unit;
    if (1.0..1e18).contains(&size) { Ok(size as u64) } else { Err(refused()) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_have_a_number_and_a_unit() {
        assert_eq!(bytes("8GiB"), Ok(8 << 30));
        assert_eq!(bytes("1.5 MiB"), Ok(3 << 19));
        assert_eq!(bytes("500MB"), Ok(500_000_000));
        assert_eq!(bytes("42B"), Ok(42));
        for wrong in ["8", "GiB", "-1GiB", "0B", "1e30GiB", "nanGB", "8 gigabytes"] {
            assert!(bytes(wrong).is_err(), "{wrong}");
        }
    }
}
