//! The choice of a scene's origin, such that f32 represents its spheres well.
//!
//! The origin is the per-axis median of the centres: unlike the middle of the bounding box, one
//! huge ground sphere cannot drag it away from the rest. Only if that leaves small spheres badly
//! rounded, as for one ball on one ground sphere, whose median is a tie, are other origins tried.

use rayon::prelude::*;

use crate::math::{DVec3, F32_UNIT_ROUNDOFF};

use super::median::lower_median;

/// Displacement by rounding, as a fraction of the radius, above which another origin is tried.
const TOLERANCE: f64 = 1e-3;
/// Spheres larger than this many times the smallest may turn out to be giants, which f32 need not
/// represent: `TOLERANCE / F32_UNIT_ROUNDOFF` is 16777.
const SMALL: f32 = 1e4;

/// Returns the origin for `[x, y, z, radius]`, representable in f32.
pub(super) fn choose_origin(spheres: &[[f32; 4]]) -> DVec3 {
    let all = median(spheres, f32::INFINITY);
    if count_badly_rounded(spheres, all) == 0 {
        return all;
    }
    let smallest = spheres.par_iter().map(|s| s[3]).reduce(|| f32::INFINITY, f32::min);
    let smaller_half = median(spheres, lower_median(spheres, |s| Some(s[3])));
    let small = median(spheres, SMALL * smallest);
    // `min_by_key` keeps the first of equals.
    let places = [all, smaller_half, small];
    places.into_iter().min_by_key(|&place| count_badly_rounded(spheres, place)).unwrap_or(all)
}

/// Returns the per-axis median of the centres of the spheres up to a radius.
fn median(spheres: &[[f32; 4]], largest: f32) -> DVec3 {
    let of_axis = |axis: usize| {
        let chosen = |sphere: &[f32; 4]| (sphere[3] <= largest).then_some(sphere[axis]);
        f64::from(lower_median(spheres, chosen))
    };
    DVec3::new(of_axis(0), of_axis(1), of_axis(2))
}

/// Counts the spheres that rounding relative to `place` could move by too much of their radius.
fn count_badly_rounded(spheres: &[[f32; 4]], place: DVec3) -> usize {
    let is_bad = |&&[x, y, z, radius]: &&[f32; 4]| {
        let center = DVec3::new(f64::from(x), f64::from(y), f64::from(z));
        F32_UNIT_ROUNDOFF * center.distance(place) > TOLERANCE * f64::from(radius)
    };
    spheres.par_iter().with_min_len(4096).filter(is_bad).count()
}

#[cfg(test)]
mod tests {
    use super::*;

    const GROUND: [f32; 4] = [0.0, -1e5, 0.0, 1e5];

    #[test]
    fn one_ball_on_one_ground_is_where_the_origin_is() {
        assert_eq!(choose_origin(&[GROUND, [3.0, 1.0, 0.0, 1.0]]), DVec3::new(3.0, 1.0, 0.0));
        assert_eq!(choose_origin(&[[3.0, 1.0, 0.0, 1.0], GROUND]), DVec3::new(3.0, 1.0, 0.0));
    }

    #[test]
    fn many_grounds_do_not_outvote_two_balls() {
        let mut spheres = vec![GROUND; 200];
        spheres.extend([[3.0, 1.0, 0.0, 1.0], [5.0, 1.0, 0.0, 1.0]]);
        assert_eq!(choose_origin(&spheres), DVec3::new(3.0, 1.0, 0.0));
    }

    #[test]
    fn one_speck_far_away_does_not_drag_the_origin_along() {
        let mut spheres = vec![[0.0, 0.0, 0.0, 1.0]; 10];
        spheres.push([1e6, 0.0, 0.0, 1e-6]);
        assert_eq!(choose_origin(&spheres), DVec3::ZERO);
    }

    #[test]
    fn where_all_are_served_well_it_is_the_median() {
        let spheres = [[1.0, 5.0, 0.0, 0.1], [2.0, 7.0, 0.0, 9.0], [3.0, 6.0, 0.0, 0.2]];
        assert_eq!(choose_origin(&spheres), DVec3::new(2.0, 6.0, 0.0));
        assert_eq!(choose_origin(&[]), DVec3::ZERO);
    }

    #[test]
    fn small_is_measured_by_the_smallest() {
        // The ground spheres are larger than 1e4 times the balls, and smaller than 1e4.
        let mut spheres = vec![[0.0, -1000.0, 0.0, 1000.0]; 200];
        spheres.extend([[3.0, 1.0, 0.0, 0.01], [5.0, 1.0, 0.0, 0.01]]);
        assert_eq!(choose_origin(&spheres), DVec3::new(3.0, 1.0, 0.0));
    }
}
