//! All the spheres of a scene, as one array.
//!
//! Spheres are stored as the user wrote them ([`super::storage`]), sorted along a Morton curve,
//! without duplicates. Hits are computed from those numbers, for all backends. All results are
//! relative to an origin ([`super::origin`]) near most spheres, subtracted in f64, so that f32
//! copies in acceleration structures are good at finding candidates. Giants ([`super::giants`]) are
//! those for which f32 is too coarse for that: ids below `particle_count()` are particles, all
//! further ids are giants.

use std::hint::black_box;

use crate::fault::fault;
use crate::math::{DVec3, Hit, NO_SPHERE, Ray};

use super::morton::MortonCurve;
use super::storage::{SphereStorage, to_f32, to_f64};
use super::{PathRay, Side, Sphere, SurfaceHit};

/// All the spheres of a scene. Immutable.
#[derive(Debug)]
pub struct SphereSet {
    pub(super) origin: DVec3,
    /// The spheres that are not giants, in the user's coordinates.
    pub(super) spheres: SphereStorage,
    /// The giants, in the user's coordinates.
    pub(super) giants: Vec<Sphere>,
    /// The user's row of each id.
    pub(super) rows: Vec<u32>,
    pub(super) curve: MortonCurve,
    pub(super) duplicates: usize,
    pub(super) is_exact_in_f32: bool,
}

/// Spheres as a [`SphereSet`] stores them.
#[cfg(has_embree)]
pub(crate) struct RawRows<'a> {
    /// Particles in f32; a negative radius marks one that is in `f64`, at the index given by the
    /// bits of x. `None` if all are in `f64`.
    pub(crate) f32: Option<&'a [[f32; 4]]>,
    pub(crate) f64: &'a [Sphere],
    pub(crate) giants: &'a [Sphere],
}

impl SphereSet {
    /// Number of spheres; ids are below it.
    pub fn len(&self) -> usize {
        self.rows.len()
    }

    /// Returns true if there are no spheres.
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// Returns the origin of this set, in the user's coordinates.
    pub fn origin(&self) -> DVec3 {
        self.origin
    }

    /// Number of spheres that are not giants; their ids come first.
    pub fn particle_count(&self) -> usize {
        self.spheres.len()
    }

    /// Returns a particle rounded to f32, relative to the origin: `[x, y, z, radius]`. Rounding
    /// moves its centre by at most `2^-24 |c|` and its surface by at most `2^-24 (|c| + r)`.
    #[inline(always)]
    pub fn rounded_particle(&self, id: u32) -> [f32; 4] {
        let sphere = self.spheres.sphere(id as usize).relative_to(self.origin);
        to_f32(&sphere)
    }

    /// Returns true if [`Self::rounded_particle`] is exact for all particles.
    pub fn is_exact_in_f32(&self) -> bool {
        self.is_exact_in_f32
    }

    /// Returns a sphere's position along the Morton curve; particles are in ascending order. Three
    /// bits per halving of space.
    pub(crate) fn morton_code(&self, sphere: &[f32; 4]) -> u64 {
        self.curve.fine_code(sphere)
    }

    /// Returns the giants relative to the origin; their ids follow the particles'.
    pub fn giants(&self) -> impl ExactSizeIterator<Item = Sphere> {
        self.giants.iter().map(|giant| giant.relative_to(self.origin))
    }

    /// Returns the user's row of a sphere.
    pub fn row(&self, id: u32) -> u32 {
        self.rows[id as usize]
    }

    /// Returns the user's row of every id, in the order of the ids.
    pub fn rows(&self) -> &[u32] {
        &self.rows
    }

    /// Returns the number of rows removed because an earlier row is the same sphere.
    pub fn duplicates(&self) -> usize {
        self.duplicates
    }

    /// Returns the sphere as written, relative to the origin.
    #[inline(always)]
    pub fn sphere(&self, id: u32) -> Sphere {
        match (id as usize).checked_sub(self.spheres.len()) {
            Some(giant) => self.giants[giant].relative_to(self.origin),
            None if fault!(SpheresRoundedToF32) => to_f64(&self.rounded_particle(id)),
            None => self.spheres.sphere(id as usize).relative_to(self.origin),
        }
    }

    /// Returns the sphere as written, in the user's coordinates.
    pub fn sphere_as_written(&self, id: u32) -> Sphere {
        match (id as usize).checked_sub(self.spheres.len()) {
            Some(giant) => self.giants[giant],
            None => self.spheres.sphere(id as usize),
        }
    }

    /// Returns the addresses of a sphere and its row, for prefetching only; meaningless for giants.
    #[inline(always)]
    pub(crate) fn addresses(&self, id: u32) -> [*const u8; 2] {
        let index = id as usize;
        [self.spheres.address(index), self.rows.as_ptr().wrapping_add(index).cast()]
    }

    /// Returns all spheres as stored, in the user's coordinates.
    #[cfg(has_embree)]
    pub(crate) fn raw_rows(&self) -> RawRows<'_> {
        match &self.spheres {
            SphereStorage::F32 { rows, wide } => {
                RawRows { f32: Some(rows), f64: wide, giants: &self.giants }
            }
            SphereStorage::F64(spheres) => {
                RawRows { f32: None, f64: spheres, giants: &self.giants }
            }
        }
    }

    /// Prefetches spheres into the cache before they are needed one by one: no read here waits for
    /// another.
    pub fn prefetch(&self, ids: impl Iterator<Item = u32>) {
        let read = |id: u32| u64::from(self.row(id)) ^ self.sphere(id).radius.to_bits();
        black_box(ids.fold(0, |all, id| all ^ read(id)));
    }

    /// Returns the bytes held.
    pub fn bytes(&self) -> usize {
        self.spheres.bytes() + size_of_val(&*self.giants) + size_of_val(&*self.rows)
    }

    /// Converts a path ray to a backend query: the first hit before its exit point.
    pub fn to_query(&self, ray: &PathRay) -> Ray {
        let t_max = ray.t_max.min(ray.t_exit);
        let origin_sphere = if fault!(ExclusionLost) { NO_SPHERE } else { ray.origin_sphere };
        let target = if fault!(EmitterOccludesItself) { NO_SPHERE } else { ray.target_sphere };
        Ray::new(ray.origin, ray.direction, ray.t_min, t_max, [origin_sphere, target])
    }

    /// Resolves a backend's hit to a point on a sphere, identically for all backends: only the id
    /// is taken from the backend, the rest is computed again in f64. The exit point of the origin
    /// sphere is returned if it lies before the backend's hit.
    pub fn resolve_hit(&self, ray: &PathRay, hit: Hit) -> Option<SurfaceHit> {
        let sphere_hit = (!hit.is_miss()).then(|| {
            let sphere = self.sphere(hit.id);
            (hit.id, sphere.hit_distance(ray.origin, ray.direction, ray.t_min))
        });
        let (id, t, is_exit) = match sphere_hit {
            Some((id, t)) if t < ray.t_exit => (id, t, false),
            _ if ray.t_exit < ray.t_max => (ray.origin_sphere, ray.t_exit, true),
            _ => return None,
        };
        let sphere = self.sphere(id);
        let (point, normal) = sphere.reproject(ray.origin, ray.direction, t);
        let side = match is_exit {
            // On a short chord, rounding may give d.n either sign.
            true => Side::Inside,
            false => Side::of_incoming(ray.direction, normal),
        };
        Some(SurfaceHit { id, t, point, normal, radius: sphere.radius, side })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::SphereRows;
    use crate::geometry::storage::to_f64;

    fn ball(x: f64, y: f64, z: f64, radius: f64) -> Sphere {
        Sphere { center: DVec3::new(x, y, z), radius }
    }

    fn set(exact: Vec<Sphere>, table: Vec<[f32; 4]>) -> SphereSet {
        SphereSet::new(SphereRows { exact, table }).expect("few spheres")
    }

    #[test]
    fn every_row_is_found_again_under_its_id() {
        let exact = vec![ball(0.0, -1e5, 0.0, 1e5), ball(3.0, 1.0, 2.0, 1.0)];
        let table: Vec<_> = (0..50u32).map(|i| [(i * 17 % 50) as f32, 2.0, 3.0, 0.25]).collect();
        let set = set(exact.clone(), table.clone());
        assert_eq!(set.len(), 52);
        assert_eq!(set.giants().len(), 1);
        for id in 0..set.len() as u32 {
            let row = set.row(id) as usize;
            let given = exact.get(row).copied().unwrap_or_else(|| to_f64(&table[row - 2]));
            let stored = set.sphere(id);
            assert!((stored.center + set.origin()).distance(given.center) < 1e-5);
            assert_eq!(stored.radius, given.radius);
        }
        assert_eq!(set.row(51), 0, "the giant is the last id");
        let mut rows = set.rows().to_vec();
        rows.sort_unstable();
        assert!(rows.into_iter().eq(0..52), "every row has one id");
        assert_eq!(set.bytes(), 51 * 16 + 32 + 52 * 4);
    }

    #[test]
    fn equal_spheres_are_one_and_the_first_row_stays() {
        let same = ball(1.0, 2.0, 3.0, 1.0);
        let set = set(vec![ball(0.0, 0.0, 0.0, 1.0), same, same], vec![[1.0, 2.0, 3.0, 1.0]]);
        assert_eq!((set.len(), set.duplicates()), (2, 2));
        assert!(set.rows().contains(&1));
    }

    #[test]
    fn what_stands_between_and_behind_equal_spheres_stays() {
        let xs = [4, 2, 0, 2, 1, 3, 4, 2, 3, 5];
        let set = set(vec![], xs.map(|x| [x as f32, 0.0, 0.0, 0.25]).to_vec());
        assert_eq!((set.len(), set.duplicates()), (6, 4));
        // In order along the curve, which is a line here; each with its first row.
        assert_eq!(set.rows(), [2, 4, 1, 5, 0, 9]);
        let stored: Vec<f64> = (0..6).map(|id| (set.sphere(id).center + set.origin()).x).collect();
        assert_eq!(stored, [0.0, 1.0, 2.0, 3.0, 4.0, 5.0]);
        let in_f32 = |id| f64::from(set.rounded_particle(id)[0]) + set.origin().x;
        assert_eq!(set.particle_count(), 6);
        assert!((0..6).map(in_f32).eq(stored));
        let codes: Vec<u64> = (0..6).map(|id| set.morton_code(&set.rounded_particle(id))).collect();
        assert!(codes.is_sorted_by(|a, b| a < b), "{codes:?}");
    }

    #[test]
    fn a_zero_has_no_sign() {
        let zeros = [0.0, -0.0].map(|zero| ball(zero, zero, zero, 1.0));
        let signs = [[0.0, 0.0, -0.0], [0.0, -0.0, 0.0], [-0.0, 0.0, 0.0]];
        let table = signs.map(|[x, y, z]| [x, y, z, 1.0]);
        let set = set(zeros.to_vec(), table.to_vec());
        assert_eq!((set.len(), set.duplicates()), (1, 4));
    }

    #[test]
    fn equal_giants_are_one_and_the_first_row_stays() {
        let [ground, wall] = [ball(0.0, -1e5, 0.0, 1e5), ball(0.0, -2e5, -0.0, 2e5)];
        let wall_again = ball(0.0, -2e5, 0.0, 2e5);
        let around = [1.0, 2.0, 3.0].map(|x| ball(x, 1.0, 0.0, 1.0));
        let cellar = ball(0.0, -3e5, 0.0, 3e5);
        let giants = vec![ground, wall, ground, wall_again, cellar];
        let set = set([giants, around.to_vec()].concat(), vec![]);
        assert_eq!((set.giants().len(), set.duplicates()), (3, 2));
        assert_eq!(set.rows()[3..], [0, 1, 4]);
    }

    #[test]
    fn a_set_without_spheres_is_empty() {
        let empty = set(vec![], vec![]);
        assert!(empty.is_empty());
        assert_eq!((empty.len(), empty.bytes()), (0, 0));
        assert!(!set(vec![ball(0.0, 0.0, 0.0, 1.0)], vec![]).is_empty());
    }

    #[test]
    fn spheres_stay_as_written_whatever_f32_can_hold() {
        // The last digits of f64, beside an f32 table and alone.
        let written = [ball(0.1, 1e9 + 0.3, -1e-9, 1.0 + 1e-15), ball(0.1, 1e9 + 0.3, -1e-9, 1.0)];
        for table in [vec![], vec![[0.5f32, 2.0, 3.0, 0.25]; 1], vec![[1e9, 0.3, 0.0, 1e-3]; 3]] {
            let set = set(written.to_vec(), table.clone());
            assert_eq!(set.len(), 2 + table.len().min(1), "shells in the last digit are two");
            for id in 0..set.len() as u32 {
                let row = set.row(id) as usize;
                let given = written.get(row).copied().unwrap_or_else(|| to_f64(&table[row - 2]));
                assert_eq!(set.sphere_as_written(id), given);
                assert_eq!(set.sphere(id).center, given.center - set.origin());
                assert_eq!(set.sphere(id).radius, given.radius);
            }
        }
    }

    #[test]
    fn f32_spheres_near_the_origin_are_exact_in_f32_and_others_are_not() {
        let is_exact = |exact, table| set(exact, table).is_exact_in_f32();
        assert!(is_exact(vec![], vec![[0.1, 0.2, 0.3, 0.4], [0.5, 0.1, 0.7, 0.3]]));
        assert!(is_exact(vec![ball(0.5, 0.25, 0.0, 1.0)], vec![[0.1, 0.2, 0.3, 0.4]]));
        assert!(!is_exact(vec![ball(0.1, 0.0, 0.0, 1.0)], vec![[0.1, 0.2, 0.3, 0.4]]));
        assert!(!is_exact(vec![], vec![[1e6, 0.1, 0.0, 1e-3], [1e6, 0.3, 0.0, 1e-3]]));
    }

    #[test]
    fn a_surface_hit_lies_on_the_sphere_and_has_its_side() {
        let set = set(vec![ball(10.0, 0.0, 0.0, 2.0)], vec![]);
        let ray = PathRay::new(DVec3::new(5.0, 0.0, 0.0) - set.origin(), DVec3::X);
        let hit = set.resolve_hit(&ray, Hit { t: 99.0, id: 0 }).expect("hits");
        assert_eq!((hit.t, hit.normal, hit.side), (3.0, -DVec3::X, Side::Outside));
        let inward = hit.spawn_ray(DVec3::X).expect("a chord");
        assert_eq!(inward.t_exit, 4.0);
        let far = set.resolve_hit(&inward, Hit::MISS).expect("the exit point");
        assert_eq!((far.id, far.t, far.side), (0, 4.0, Side::Inside));
    }

    /// Here rounding the end point gives a normal on the wrong side of the ray.
    #[test]
    fn the_exit_point_of_a_grazing_chord_is_reached_from_inside() {
        let around = [-1e4, 0.0, 1e4].map(|x| ball(x, 0.0, 0.0, 0.1));
        let set = set([around.to_vec(), vec![ball(1e3, 2e3, 0.0, 1e-3)]].concat(), vec![]);
        let id = (0..4).find(|&id| set.row(id) == 3).expect("row 3");
        let Sphere { center, radius } = set.sphere(id);
        for i in 1..100 {
            let normal = DVec3::new(f64::from(i), 3.0, 1.0).normalize();
            let point = center + normal * radius;
            let start = SurfaceHit { id, t: 0.0, point, normal, radius, side: Side::Outside };
            let along = normal.any_orthonormal_vector();
            let inward = start.spawn_ray((along - normal * 1e-11).normalize()).expect("a chord");
            let far = set.resolve_hit(&inward, Hit::MISS).expect("the exit point");
            assert_eq!((far.id, far.side), (id, Side::Inside));
        }
    }

    /// The camera stands 1e9 from the origin and 5 before a ball there.
    #[test]
    fn a_normal_is_as_precise_as_the_ray_is_short() {
        let set = set(vec![ball(0.0, 0.0, 0.0, 1.0); 1], vec![[1e9, 0.0, 0.0, 1.0]; 1]);
        let id = (0..2).find(|&id| set.row(id) == 1).expect("row 1");
        let center = set.sphere(id).center;
        let ray = PathRay::new(center - DVec3::X * 5.0, DVec3::new(0.99, 0.1, 0.0).normalize());
        let hit = set.resolve_hit(&ray, Hit { t: 4.0, id }).expect("hits");
        let expected = ray.direction * hit.t - DVec3::X * 5.0;
        assert!((hit.normal - expected).length() < 1e-14);
    }

    #[test]
    fn the_first_of_the_exit_point_and_the_hit_is_the_result() {
        let set = set(vec![ball(0.0, 0.0, 0.0, 2.0), ball(3.0, 0.0, 0.0, 2.0)], vec![]);
        let [left, right] = [0, 1].map(|row| (0..2).find(|&id| set.row(id) == row).expect("row"));
        let start = DVec3::new(-2.0, 0.0, 0.0) - set.origin();
        let inward = PathRay { origin_sphere: left, t_exit: 4.0, ..PathRay::new(start, DVec3::X) };
        let resolve = |ray: &PathRay, hit| set.resolve_hit(ray, hit).map(|hit| (hit.id, hit.t));
        let hit = Hit { t: 3.0, id: right };
        assert_eq!(resolve(&inward, hit), Some((right, 3.0)));
        let nearer_exit = PathRay { t_exit: 2.5, ..inward };
        assert_eq!(resolve(&nearer_exit, hit), Some((left, 2.5)));
        assert_eq!(resolve(&inward, Hit::MISS), Some((left, 4.0)));
        let up_to = |t_max| resolve(&PathRay { t_max, ..inward }, Hit::MISS);
        assert_eq!([4.5, 4.0, 3.5].map(up_to), [Some((left, 4.0)), None, None]);
        assert_eq!(resolve(&PathRay::new(start, -DVec3::X), Hit::MISS), None);
    }
}
