//! Cases small enough to verify by hand.

use super::*;
use crate::geometry::SphereRows;
use crate::math::NO_SPHERE;

const EXACT: ErrorBound = ErrorBound { particles: 0.0, giants: 0.0, rounds_origin: false };
const COARSE: ErrorBound = ErrorBound { particles: 16.0, giants: 16.0, rounds_origin: false };
const GAP: f32 = 1.0 / (1 << 22) as f32;

/// Unit spheres on the x axis; the origin stays at the sphere at 0.
fn row_of(centers: &[[f32; 3]]) -> SphereSet {
    let table = centers.iter().map(|&[x, y, z]| [x, y, z, 1.0]).collect();
    SphereSet::new(SphereRows { table, exact: Vec::new() }).expect("few spheres")
}

fn id_of(spheres: &SphereSet, row: u32) -> u32 {
    spheres.rows().iter().position(|&r| r == row).expect("a row") as u32
}

fn ray_along_x(origin: [f64; 3], spheres: &SphereSet) -> PathRay {
    PathRay::new(DVec3::from(origin) - spheres.origin(), DVec3::X)
}

/// Judges the resolved hit of an id found before the exit point.
fn judge(case: &RayCase<'_>, found: Option<u32>, precision: &ErrorBound) -> Verdict {
    let own = (case.ray.t_exit < case.ray.t_max).then_some(case.ray.origin_sphere);
    case.judge_closest(found, found.or(own), precision)
}

#[test]
fn the_first_of_two_is_the_answer_and_the_other_is_wrong() {
    let spheres = row_of(&[[10.0, 0.0, 0.0], [20.0, 0.0, 0.0]]);
    let ray = ray_along_x([0.0; 3], &spheres);
    let case = RayCase::new(&spheres, &ray, &COARSE);
    let (near, far) = (id_of(&spheres, 0), id_of(&spheres, 1));
    let first = case.first_hit().expect("hits");
    assert_eq!((first.id, first.t), (near, 9.0));
    assert_eq!(judge(&case, Some(near), &COARSE), Verdict::Equal);
    assert_eq!(judge(&case, Some(far), &COARSE), Verdict::Wrong);
    assert_eq!(judge(&case, None, &COARSE), Verdict::Wrong);
    assert_eq!(case.judge_occluded(true, &COARSE), Verdict::Equal);
    assert_eq!(case.judge_occluded(false, &COARSE), Verdict::Wrong);
}

/// Two walls as far apart as the error bound: a backend may report either as first.
#[test]
fn a_neighbour_within_the_band_is_ambiguous_and_beyond_it_is_wrong() {
    let spheres = row_of(&[[1.0, 0.0, 0.0], [1.0 + GAP, 0.0, 0.0]]);
    let ray = ray_along_x([-9.0, 0.0, 0.0], &spheres);
    let behind = Some(id_of(&spheres, 1));
    let case = RayCase::new(&spheres, &ray, &COARSE);
    assert_eq!(judge(&case, behind, &COARSE), Verdict::Ambiguous);
    assert_eq!(judge(&case, behind, &EXACT), Verdict::Wrong);
    let hundredth = ErrorBound { particles: 0.1, ..EXACT };
    assert_eq!(judge(&case, behind, &hundredth), Verdict::Wrong);
}

#[test]
fn a_silhouette_within_the_band_may_be_hit_or_missed() {
    let spheres = row_of(&[[0.0; 3]]);
    for (y, hits) in [(1.0 + 1e-7, false), (1.0 - 1e-7, true)] {
        let ray = ray_along_x([-5.0, y, 0.0], &spheres);
        let case = RayCase::new(&spheres, &ray, &COARSE);
        assert_eq!(case.first_hit().is_some(), hits);
        let other = if hits { None } else { Some(0) };
        assert_eq!(judge(&case, other, &COARSE), Verdict::Ambiguous);
        assert_eq!(judge(&case, other, &EXACT), Verdict::Wrong);
        assert_eq!(case.judge_occluded(!hits, &COARSE), Verdict::Ambiguous);
        assert_eq!(case.judge_occluded(!hits, &EXACT), Verdict::Wrong);
    }
}

#[test]
fn an_origin_within_the_band_of_a_surface_is_on_either_side() {
    let spheres = row_of(&[[0.0; 3], [1.5, 0.0, 0.0]]);
    let (own, next) = (id_of(&spheres, 0), id_of(&spheres, 1));
    let ray = ray_along_x([1e-8 - 1.0, 0.0, 0.0], &spheres);
    let case = RayCase::new(&spheres, &ray, &COARSE);
    assert_eq!(case.first_hit().map(|first| first.id), Some(next), "starts inside its own");
    assert_eq!(judge(&case, Some(own), &COARSE), Verdict::Ambiguous);
    assert_eq!(judge(&case, Some(own), &EXACT), Verdict::Wrong);
}

#[test]
fn the_far_wall_is_an_exact_answer_and_hides_what_is_behind_it() {
    let spheres = row_of(&[[0.0; 3], [3.0, 0.0, 0.0]]);
    let (own, next) = (id_of(&spheres, 0), id_of(&spheres, 1));
    let inward =
        PathRay { origin_sphere: own, t_exit: 2.0, ..ray_along_x([-1.0, 0.0, 0.0], &spheres) };
    let case = RayCase::new(&spheres, &inward, &COARSE);
    assert_eq!(case.first_hit().map(|first| (first.id, first.t)), Some((own, 2.0)));
    assert_eq!(judge(&case, Some(next), &EXACT), Verdict::Wrong);
    assert_eq!(judge(&case, None, &COARSE), Verdict::Equal);
    assert!(!case.occluded(), "the exit point ends the ray");
    assert_eq!(case.distance_error(own, 2.0), 0.0);
    assert!(case.distance_error(own, 2.0 + 1e-15) > 1.0);
    let outward = PathRay { t_exit: f64::INFINITY, ..inward };
    let case = RayCase::new(&spheres, &outward, &COARSE);
    assert_eq!(case.first_hit().map(|first| first.id), Some(next));
    assert_eq!(judge(&case, Some(own), &COARSE), Verdict::Wrong);
    let to_emitter = PathRay { target_sphere: next, t_max: 3.0, ..outward };
    assert!(RayCase::new(&spheres, &to_emitter, &COARSE).first_hit().is_none());
    assert_eq!(inward.target_sphere, NO_SPHERE);
}

#[test]
fn distances_are_held_to_a_few_ulps() {
    let spheres = row_of(&[[0.0; 3]]);
    let ray = ray_along_x([-1001.0, 0.6, 0.0], &spheres);
    let case = RayCase::new(&spheres, &ray, &EXACT);
    let t = 1001.0 - 0.8;
    assert!(case.distance_error(0, t) < 0.1);
    assert!(case.distance_error(0, t + 1e-8) > 1.0);
    assert!(case.distance_error(0, 1001.8) > 1.0, "the other root is wrong");
}
