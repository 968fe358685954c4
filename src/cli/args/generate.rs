//! The options of `photosphere generate`.

use std::path::PathBuf;

use clap::Args;

use crate::generate::Arrangement;

use super::values::{count, explained, one_of, seed, threads};

/// Generate a sphere table for tests and benchmarks, and a scene that shows it
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  photosphere generate gas --count 1e6 -o gas.f32 --scene gas.toml
  photosphere generate clusters -n 1e8 --colors -o many.f32 --scene many.toml
  photosphere generate packed --count 100000 --seed 7 -o packed.f32

The spheres lie in a box of side 1 around the origin. Rows are x, y, z, radius and, with --colors, r, g,
b, as little-endian f32. Equal options give equal bytes, on any machine and any number of threads.")]
pub struct GenerateArgs {
    /// How the spheres are arranged
    #[arg(value_name = "ARRANGEMENT", value_parser = one_of(explained(meaning)))]
    pub arrangement: Arrangement,

    /// The number of spheres, such as 1000000 or 1e6
    #[arg(short = 'n', long, value_name = "N", value_parser = count)]
    pub count: u64,

    /// The table to write
    #[arg(short, long, value_name = "TABLE")]
    pub output: PathBuf,

    /// Also write a scene that shows the table
    #[arg(long, value_name = "FILE")]
    pub scene: Option<PathBuf>,

    /// Lay the spheres of the scene on a floor
    #[arg(long, requires = "scene")]
    pub floor: bool,

    /// Give every sphere its own colour, 12 bytes per row
    #[arg(long)]
    pub colors: bool,

    /// The seed of the random numbers
    #[arg(long, value_name = "S", default_value_t = 0, value_parser = seed())]
    pub seed: u64,

    /// Threads to use [default: all cores that affinity and CPU quota allow];
    /// the table does not depend on it
    #[arg(long, value_name = "T", value_parser = threads())]
    pub threads: Option<usize>,
}

fn meaning(arrangement: Arrangement) -> &'static str {
    match arrangement {
        Arrangement::Gas => {
            "random positions; a ray across the box hits about eight spheres, whatever their number"
        }
        Arrangement::Packed => "spheres fill half of the volume without touching",
        Arrangement::Clusters => {
            "400 clusters of very different density, with radii over two decades"
        }
        Arrangement::Lattice => "a cubic lattice",
    }
}
