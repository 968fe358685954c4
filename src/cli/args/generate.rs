//! The options of `photosphere generate`.

use std::path::PathBuf;

use clap::Args;

use crate::generate::Arrangement;

use super::values::{count, explained, one_of, seed, threads};

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
pub struct GenerateArgs {
    /// How the spheres are arranged
    #[arg(value_name = "ARRANGEMENT", value_parser = one_of(explained(meaning)))]
    pub arrangement: Arrangement,

    /// How many spheres; 1000000 may be written as 1e6
    #[arg(short = 'n', long, value_name = "N", value_parser = count)]
    pub count: u64,

    /// The table that is written
    #[arg(short, long, value_name = "TABLE")]
    pub output: PathBuf,

    /// Write a scene that shows the table, too
    #[arg(long, value_name = "FILE")]
    pub scene: Option<PathBuf>,

    /// Give every sphere a colour of its own, 12 bytes a row
    #[arg(long)]
    pub colors: bool,

    /// Chooses the random numbers
    #[arg(long, value_name = "S", default_value_t = 0, value_parser = seed())]
    pub seed: u64,

    /// Threads to use; all cores by default. The bytes do not depend on it
    #[arg(long, value_name = "T", value_parser = threads())]
    pub threads: Option<usize>,
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
