//! Giants: spheres too large, relative to their neighbouring spheres, to be rounded to f32.
//!
//! A ground sphere of radius 1e5 under balls of radius 1 would sink or float by half a percent of a
//! ball if its numbers were f32. Such a sphere is a *giant*: it keeps its f64 numbers.
//!
//! The criterion: rounding moves a surface by at most `2^-24 (|c| + r)`. A sphere is a giant if
//! that is more than a thousandth of the radius of its smallest neighbouring sphere. Neighbours are
//! found by distance from the origin (the median of all centres): space is divided into shells
//! `2^k <= |p| < 2^(k+1)`, and each shell stores the smallest radius of any sphere whose surface
//! enters it. A shell counts only if the sphere's own numbers are more than eight times larger than
//! the coordinates there: elsewhere its neighbours are rounded as much as it is, and keeping only
//! it in f64 would not help.

use rayon::prelude::*;

use crate::math::F32_UNIT_ROUNDOFF;

use super::Sphere;

const MIN_EXPONENT: i32 = -60;
const MAX_EXPONENT: i32 = 60;
const SHELLS: usize = (MAX_EXPONENT - MIN_EXPONENT + 1) as usize;

/// Maximum displacement of a surface by rounding, as a fraction of the smallest neighbour's radius.
const TOLERANCE: f64 = 1e-3;
/// Minimum ratio of a giant's own numbers to the coordinates of a shell.
const SCALE_RATIO: f64 = 8.0;

/// The smallest radius whose surface enters each shell around the origin.
pub(super) struct Shells {
    smallest_radius: [f64; SHELLS],
    /// The smallest radius overall.
    smallest: f64,
}

impl Shells {
    /// Computes the shells of `count` spheres, given by index, relative to the origin.
    pub(super) fn new(count: usize, sphere: impl Fn(usize) -> Sphere + Sync) -> Self {
        let empty = || [f64::INFINITY; SHELLS];
        let smallest_radius = (0..count)
            .into_par_iter()
            .with_min_len(4096)
            .fold(empty, |mut shells, index| {
                let sphere = sphere(index);
                for shell in &mut shells[shell_range(&sphere)] {
                    *shell = shell.min(sphere.radius);
                }
                shells
            })
            .reduce(empty, |mut a, b| {
                a.iter_mut().zip(b).for_each(|(a, b)| *a = a.min(b));
                a
            });
        let smallest = smallest_radius.iter().copied().fold(f64::INFINITY, f64::min);
        Self { smallest_radius, smallest }
    }

    /// Returns true if the sphere is a giant among those spheres.
    pub(super) fn is_giant(&self, sphere: &Sphere) -> bool {
        let scale = sphere.center.length() + sphere.radius;
        let displacement = F32_UNIT_ROUNDOFF * scale;
        if displacement <= TOLERANCE * self.smallest {
            return false; // nearly always
        }
        shell_range(sphere).any(|shell| {
            let shell_end = 2f64.powi(MIN_EXPONENT + shell as i32 + 1);
            scale > SCALE_RATIO * shell_end
                && displacement > TOLERANCE * self.smallest_radius[shell]
        })
    }
}

/// Returns the shells that a sphere's surface enters.
fn shell_range(sphere: &Sphere) -> std::ops::Range<usize> {
    let distance = sphere.center.length();
    let nearest = (distance - sphere.radius).abs();
    shell_at(nearest)..shell_at(distance + sphere.radius) + 1
}

fn shell_at(distance: f64) -> usize {
    // The exponent as f64 stores it; below the lowest shell for 0 and subnormal numbers.
    let exponent = (distance.to_bits() >> 52) as i32 - 1023;
    (exponent.clamp(MIN_EXPONENT, MAX_EXPONENT) - MIN_EXPONENT) as usize
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::DVec3;

    fn giants(spheres: &[Sphere]) -> Vec<bool> {
        let shells = Shells::new(spheres.len(), |i| spheres[i]);
        spheres.iter().map(|s| shells.is_giant(s)).collect()
    }

    fn ball(x: f64, y: f64, z: f64, radius: f64) -> Sphere {
        Sphere { center: DVec3::new(x, y, z), radius }
    }

    #[test]
    fn a_huge_ground_under_small_balls_is_a_giant_and_the_balls_are_not() {
        let ground = ball(0.0, -1e5, 0.0, 1e5);
        assert_eq!(giants(&[ground, ball(0.0, 1.0, 0.0, 1.0)]), [true, false]);
    }

    #[test]
    fn shells_begin_at_powers_of_two() {
        let shell = |distance| shell_at(distance) as i32 + MIN_EXPONENT;
        assert_eq!([1.0, 1.999, 2.0, 0.75].map(shell), [0, 0, 1, -1]);
        assert_eq!([0.0, 1e-320, 1e300].map(shell), [MIN_EXPONENT, MIN_EXPONENT, MAX_EXPONENT]);
    }

    #[test]
    fn a_moderate_ground_is_not() {
        assert_eq!(giants(&[ball(0.0, -250.0, 0.0, 250.0), ball(0.0, 1.0, 0.0, 1.0)]), [false; 2]);
    }

    #[test]
    fn particles_far_from_the_origin_are_not_giants_for_each_other() {
        assert_eq!(giants(&[ball(1e6, 0.0, 0.0, 1.0), ball(1e6, 3.0, 0.0, 1e-3)]), [false; 2]);
    }

    #[test]
    fn radii_over_six_decades_in_one_box_make_no_giants() {
        let mut spheres = Vec::new();
        for i in 0..1000 {
            let x = |k: u32| f64::from((i * k) % 997) / 997.0 - 0.5;
            spheres.push(ball(x(7), x(31), x(83), 10f64.powf(-6.0 * f64::from(i) / 1000.0) * 0.1));
        }
        assert_eq!(giants(&spheres).iter().filter(|&&g| g).count(), 0);
    }

    #[test]
    fn shells_are_powers_of_two() {
        let lowest = [0.0, 1e-30, 0.99, 1.0, 1.99, 2.0, 3.9, 1e30].map(shell_at);
        assert_eq!(lowest, [0, 0, 59, 60, 60, 61, 61, 120]);
        // From the nearest to the farthest point of the surface.
        assert_eq!(shell_range(&ball(3.0, 0.0, 0.0, 1.0)), 61..63);
        assert_eq!(shell_range(&ball(1.0, 0.0, 0.0, 4.0)), 61..63);
    }

    #[test]
    fn a_giant_is_moved_by_a_thousandth_of_the_smallest_radius() {
        // 2^-24 of twice its radius is a thousandth of 1 at a radius of 8389.
        let ground = |radius: f64| ball(0.0, -radius, 0.0, radius);
        let beside = ball(0.0, 1.0, 0.0, 1.0);
        assert_eq!(giants(&[ground(8300.0), beside]), [false, false]);
        assert_eq!(giants(&[ground(8500.0), beside]), [true, false]);
        // The smallest sphere decides.
        let smaller = ball(5.0, 0.5, 0.0, 0.5);
        assert_eq!(giants(&[ground(4100.0), smaller, beside]), [false; 3]);
        assert_eq!(giants(&[ground(4300.0), beside, smaller]), [true, false, false]);
    }

    #[test]
    fn only_what_is_near_the_origin_makes_a_giant() {
        // The ground's numbers reach 40000: more than 8 times 4096, where the first shell ends, and
        // less than 8 times 8192.
        let ground = ball(0.0, -20000.0, 0.0, 20000.0);
        assert_eq!(giants(&[ground, ball(3000.0, 0.0, 0.0, 1.0)]), [true, false]);
        assert_eq!(giants(&[ground, ball(5000.0, 0.0, 0.0, 1.0)]), [false, false]);
    }
}
