//! The choice of a scene's origin, such that f32 is precise enough to find candidates.
//!
//! Spheres are stored as written, so the origin affects speed only. It stays 0 if no sphere
//! is badly rounded there: then the f32 spheres of a table are also those of the acceleration
//! structure. Otherwise it is the per-axis median of the centres, which one huge ground sphere
//! hardly moves, unlike the centre of the bounding box. If small spheres are badly rounded there
//! too, as for one ball on one ground sphere, whose median is a tie, other origins are tried.

use rayon::prelude::*;

use crate::math::{DVec3, F32_UNIT_ROUNDOFF};

use super::median::lower_median;
use super::storage::SphereStorage;

/// Displacement by rounding, as a fraction of the radius, above which another origin is tried.
const TOLERANCE: f64 = 1e-3;
/// Spheres larger than this many times the smallest may turn out to be giants, which f32 need not
/// represent: `TOLERANCE / F32_UNIT_ROUNDOFF` is 16777.
const SMALL_RADIUS_RATIO: f64 = 1e4;

/// Returns the origin, representable in f32.
pub(super) fn choose_origin(spheres: &SphereStorage) -> DVec3 {
    if count_badly_rounded(spheres, DVec3::ZERO) == 0 {
        return DVec3::ZERO;
    }
    let radius = |i: usize| spheres.sphere(i).radius;
    let indices = (0..spheres.len()).into_par_iter();
    let smallest = indices.map(radius).reduce(|| f64::INFINITY, f64::min);
    let median_radius = lower_median(spheres.len(), |i| Some(radius(i) as f32));
    let largest = [f64::INFINITY, f64::from(median_radius), SMALL_RADIUS_RATIO * smallest];
    let medians = largest.map(|largest| median(spheres, largest));
    // `min_by_key` keeps the first of equals.
    let candidates = std::iter::once(DVec3::ZERO).chain(medians);
    candidates.min_by_key(|&origin| count_badly_rounded(spheres, origin)).unwrap_or_default()
}

/// Returns the per-axis median of the centres of the spheres up to a radius.
fn median(spheres: &SphereStorage, largest: f64) -> DVec3 {
    let axis_median = |axis: usize| {
        let coordinate = |i: usize| {
            let sphere = spheres.sphere(i);
            (sphere.radius <= largest).then_some(sphere.center[axis] as f32)
        };
        f64::from(lower_median(spheres.len(), coordinate))
    };
    DVec3::new(axis_median(0), axis_median(1), axis_median(2))
}

/// Counts the spheres that rounding relative to `origin` could move by too much of their radius.
fn count_badly_rounded(spheres: &SphereStorage, origin: DVec3) -> usize {
    let is_badly_rounded = |&i: &usize| {
        let sphere = spheres.sphere(i);
        F32_UNIT_ROUNDOFF * sphere.center.distance(origin) > TOLERANCE * sphere.radius
    };
    (0..spheres.len()).into_par_iter().with_min_len(4096).filter(is_badly_rounded).count()
}

#[cfg(test)]
mod tests {
    use super::super::SphereRows;
    use super::*;

    /// So far away that balls of radius 1 are badly rounded to f32.
    const AWAY: f32 = 1e6;
    const GROUND: [f32; 4] = [AWAY, -1e5, 0.0, 1e5];

    fn origin(spheres: &[[f32; 4]]) -> DVec3 {
        choose_origin(&SphereStorage::new(SphereRows { exact: vec![], table: spheres.to_vec() }))
    }

    fn away(x: f32, y: f32, radius: f32) -> [f32; 4] {
        [AWAY + x, y, 0.0, radius]
    }

    fn median_at(x: f32, y: f32) -> DVec3 {
        DVec3::new(f64::from(AWAY + x), f64::from(y), 0.0)
    }

    #[test]
    fn it_stays_where_f32_serves_all_spheres() {
        let ground = [0.0, -1e5, 0.0, 1e5];
        assert_eq!(origin(&[ground, [3.0, 1.0, 0.0, 1.0]]), DVec3::ZERO);
        assert_eq!(origin(&[[1e4, 0.0, 0.0, 1.0], [1.2e4, 0.0, 0.0, 1.0]]), DVec3::ZERO);
        assert_eq!(origin(&[]), DVec3::ZERO);
    }

    #[test]
    fn one_ball_on_one_ground_is_where_the_origin_is() {
        assert_eq!(origin(&[GROUND, away(3.0, 1.0, 1.0)]), median_at(3.0, 1.0));
        assert_eq!(origin(&[away(3.0, 1.0, 1.0), GROUND]), median_at(3.0, 1.0));
    }

    #[test]
    fn many_grounds_do_not_outvote_two_balls() {
        let mut spheres = vec![GROUND; 200];
        spheres.extend([away(3.0, 1.0, 1.0), away(5.0, 1.0, 1.0)]);
        assert_eq!(origin(&spheres), median_at(3.0, 1.0));
    }

    #[test]
    fn one_speck_far_away_does_not_drag_the_origin_along() {
        let mut spheres = vec![[0.0, 0.0, 0.0, 1.0]; 10];
        spheres.push([1e6, 0.0, 0.0, 1e-6]);
        assert_eq!(origin(&spheres), DVec3::ZERO);
    }

    #[test]
    fn where_another_origin_serves_all_it_is_the_median() {
        let spheres = [away(1.0, 5.0, 0.1), away(2.0, 7.0, 9.0), away(3.0, 6.0, 0.2)];
        assert_eq!(origin(&spheres), median_at(2.0, 6.0));
    }

    #[test]
    fn small_is_measured_by_the_smallest() {
        // The ground spheres are larger than 1e4 times the balls, and smaller than 1e4.
        let mut spheres = vec![[AWAY, -1000.0, 0.0, 1000.0]; 200];
        spheres.extend([away(3.0, 1.0, 0.01), away(5.0, 1.0, 0.01)]);
        assert_eq!(origin(&spheres), median_at(3.0, 1.0));
    }
}
