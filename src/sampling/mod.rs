//! Addressable random numbers, and the warps that turn them into directions and positions.
//!
//! Every warp is a group of three functions: `sample` maps the unit square to the domain, `pdf` is
//! the density that this map produces, `invert` is its inverse. `verify::chi2` checks each pair
//! against the other.

mod circular_segment;
mod discrete;
mod disk;
mod filter;
pub mod hemisphere;
mod independent;
mod mis;
mod sampler;
mod sobol;
mod stratified;
mod transcendental;

pub use circular_segment::{one_minus_cos_of_segment, segment_area};
pub use discrete::DiscreteDistribution;
pub use disk::{DiskPoint, invert_disk, sample_disk};
pub use filter::{Filter, FilterKind, sample_box};
pub use hemisphere::Hemisphere;
pub use mis::power_heuristic;
pub use sampler::{Sampler, SamplerKind};
pub use sobol::SobolLanes;
pub use transcendental::{atan2, cos, exp, ln, powf, safe_acos, sin_cos, sin_cos_2pi, tan};
