//! Random numbers determined by an index.

use rand::rngs::Xoshiro256PlusPlus;
use rand::{RngExt, SeedableRng};

use crate::math::DVec3;

/// The random number stream of one sphere or cluster.
pub(super) struct IndexedRng(Xoshiro256PlusPlus);

/// The stream of a sphere.
pub(super) fn for_sphere(seed: u64, index: u64) -> IndexedRng {
    seeded(seed, 0, index)
}

/// The stream of a cluster.
pub(super) fn for_cluster(seed: u64, cluster: u64) -> IndexedRng {
    seeded(seed, 1, cluster)
}

/// Seeds a stream. `seed_from_u64` scrambles its argument (with SplitMix64), so neighboring indices
/// give independent numbers.
fn seeded(seed: u64, stream: u64, index: u64) -> IndexedRng {
    let mut keys = Xoshiro256PlusPlus::seed_from_u64(seed);
    let key = (0..=stream).map(|_| keys.random::<u64>()).last().unwrap_or(seed);
    IndexedRng(Xoshiro256PlusPlus::seed_from_u64(key ^ index))
}

impl IndexedRng {
    /// Uniform in `[0, 1)`.
    pub(super) fn uniform(&mut self) -> f64 {
        self.0.random()
    }

    /// Uniform in `[low, high)`.
    pub(super) fn uniform_in(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.uniform()
    }

    /// Log-uniform between `low` and `high`.
    pub(super) fn log_uniform_in(&mut self, low: f64, high: f64) -> f64 {
        low * libm::pow(high / low, self.uniform())
    }

    /// A uniform integer less than `count`.
    pub(super) fn index_below(&mut self, count: usize) -> usize {
        ((self.uniform() * count as f64) as usize).min(count - 1)
    }

    /// Uniform in a cube of side 1 around the origin.
    pub(super) fn in_cube(&mut self) -> DVec3 {
        DVec3::from_array([(); 3].map(|()| self.uniform() - 0.5))
    }

    /// Uniform in the unit ball.
    pub(super) fn in_ball(&mut self) -> DVec3 {
        loop {
            let place = 2.0 * self.in_cube();
            if place.length_squared() < 1.0 {
                return place;
            }
        }
    }

    /// Three independent standard normal numbers (Box and Muller 1958).
    pub(super) fn normal(&mut self) -> DVec3 {
        let mut pair = || {
            let radius = libm::sqrt(-2.0 * libm::log(1.0 - self.uniform()));
            let (sin, cos) = libm::sincos(std::f64::consts::TAU * self.uniform());
            [radius * cos, radius * sin]
        };
        let ([x, y], [z, _]) = (pair(), pair());
        DVec3::new(x, y, z)
    }
}
