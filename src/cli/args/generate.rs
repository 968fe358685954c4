//! The options of `photosphere generate`.

use std::path::PathBuf;

use clap::Args;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};

use crate::generate::Arrangement;

use super::{seed, threads};

/// Make a sphere table to test and to measure with, and a scene that shows it
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  photosphere generate gas --count 1e6 -o gas.f32 --scene gas.toml
  photosphere generate clusters -n 1e8 --colors -o many.f32 --scene many.toml
  photosphere generate packed --count 100000 --seed 7 -o packed.f32

The spheres lie in a box of side 1 around the origin. Rows are x, y, z, radius and, with --colors, r, g,
b, as little-endian f32. The same recipe and seed give the same bytes, whatever the number of threads
and the machine.")]
pub(in crate::cli) struct GenerateArgs {
    /// How the spheres are arranged
    #[arg(value_name = "ARRANGEMENT", value_parser = arrangements())]
    pub(in crate::cli) arrangement: Arrangement,

    /// How many spheres; 1000000 may be written as 1e6
    #[arg(short = 'n', long, value_name = "N", value_parser = count)]
    #[arg(allow_negative_numbers = true)]
    pub(in crate::cli) count: u64,

    /// The table that is written
    #[arg(short, long, value_name = "TABLE")]
    pub(in crate::cli) output: PathBuf,

    /// Write a scene that shows the table, too
    #[arg(long, value_name = "FILE")]
    pub(in crate::cli) scene: Option<PathBuf>,

    /// Give every sphere a colour of its own, 12 bytes a row
    #[arg(long)]
    pub(in crate::cli) colors: bool,

    /// Chooses the random numbers
    #[arg(long, value_name = "S", default_value_t = 0, value_parser = seed())]
    #[arg(allow_negative_numbers = true)]
    pub(in crate::cli) seed: u64,

    /// Threads to use; all cores by default. The bytes do not depend on it
    #[arg(long, value_name = "T", value_parser = threads(), allow_negative_numbers = true)]
    pub(in crate::cli) threads: Option<usize>,
}

fn arrangements() -> impl TypedValueParser<Value = Arrangement> {
    let named = Arrangement::NAMES;
    let possible: Vec<_> =
        named.iter().map(|&(name, which)| PossibleValue::new(name).help(meaning(which))).collect();
    PossibleValuesParser::new(possible).try_map(move |given: String| {
        Arrangement::named(&given).ok_or("there is no such arrangement")
    })
}

fn meaning(arrangement: Arrangement) -> &'static str {
    match arrangement {
        Arrangement::Gas => {
            "random places; a ray meets about eight spheres, however many there are"
        }
        Arrangement::Packed => "half of the volume is filled, and none touch",
        Arrangement::Clusters => "400 clusters of very different density, radii over two decades",
        Arrangement::Lattice => "a cubic lattice",
    }
}

/// A whole number, perhaps with an exponent.
pub(super) fn count(text: &str) -> Result<u64, String> {
    let whole = || text.parse::<u64>().ok();
    let with_exponent = || {
        let number = text.parse::<f64>().ok()?;
        // Above 2^53 not every whole number is an f64.
        ((0.0..9e15).contains(&number) && number.fract() == 0.0).then_some(number as u64)
    };
    let refused = "it must be a whole number, as in 250000 or 1e6";
    whole().or_else(with_exponent).ok_or_else(|| refused.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_may_have_exponents_but_no_fractions() {
        assert_eq!(count("1e6"), Ok(1_000_000));
        assert_eq!(count("250000"), Ok(250_000));
        assert_eq!(count("2.5e3"), Ok(2500));
        assert_eq!(count("4294967295"), Ok(4_294_967_295));
        for wrong in ["-1", "1.5", "1e40", "nan", "many", ""] {
            assert!(count(wrong).is_err(), "{wrong}");
        }
    }
}
