//! Path rays in lanes (structure of arrays), for loops that compile to vector instructions.

use crate::math::{Isa, LANES, Lanes, Lanes3, MAX_COORDINATE, NO_SPHERE, SimdKernel};

use super::PathRay;

/// An ordered list of rays, in blocks of [`LANES`].
#[derive(Debug, Default)]
pub struct PathRays {
    /// Blocks are kept for reuse; lanes at and beyond `len` hold stale data.
    blocks: Vec<RayBlock>,
    len: usize,
}

/// A block of [`PathRays`]; its fields are those of [`PathRay`].
#[derive(Clone, Debug, Default)]
pub struct RayBlock {
    /// Origins.
    pub origin: Lanes3,
    /// Directions.
    pub direction: Lanes3,
    /// Hits at or before this distance do not count.
    pub t_min: Lanes<f64>,
    /// Hits at or beyond this distance do not count.
    pub t_max: Lanes<f64>,
    /// Distances at which inward rays hit their origin sphere again; infinite for outward rays.
    pub t_exit: Lanes<f64>,
    /// The sphere whose surface they start on.
    pub origin_sphere: Lanes<u32>,
    /// The target spheres of shadow rays.
    pub target_sphere: Lanes<u32>,
}

impl PathRays {
    /// Number of rays.
    pub fn len(&self) -> usize {
        self.len
    }

    /// Returns true if there are no rays.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// Removes all rays.
    pub fn clear(&mut self) {
        self.len = 0;
    }

    /// Appends a ray.
    #[inline(always)]
    pub fn push(&mut self, ray: &PathRay) {
        if self.len / LANES == self.blocks.len() {
            self.blocks.push(RayBlock::default());
        }
        self.len += 1;
        self.set(self.len - 1, ray);
    }

    /// Appends at most one block of rays after complete blocks. They start at points in space; the
    /// caller sets their directions.
    ///
    /// # Panics
    /// If the last block is incomplete.
    pub fn push_block(&mut self, count: usize) -> &mut RayBlock {
        assert!(self.len % LANES == 0 && count <= LANES, "behind whole blocks");
        let index = self.len / LANES;
        if index == self.blocks.len() {
            self.blocks.push(RayBlock::default());
        }
        self.len += count;
        let block = &mut self.blocks[index];
        block.t_max = Lanes::splat(f64::INFINITY);
        block.t_exit = Lanes::splat(f64::INFINITY);
        block.origin_sphere = Lanes::splat(NO_SPHERE);
        block.target_sphere = Lanes::splat(NO_SPHERE);
        block
    }

    /// Replaces a ray.
    #[inline(always)]
    pub fn set(&mut self, index: usize, ray: &PathRay) {
        let (block, lane) = (&mut self.blocks[index / LANES], index % LANES);
        block.origin.set(lane, ray.origin);
        block.direction.set(lane, ray.direction);
        block.t_min.0[lane] = ray.t_min;
        block.t_max.0[lane] = ray.t_max;
        block.t_exit.0[lane] = ray.t_exit;
        block.origin_sphere.0[lane] = ray.origin_sphere;
        block.target_sphere.0[lane] = ray.target_sphere;
    }

    /// Returns a ray.
    #[inline(always)]
    pub fn get(&self, index: usize) -> PathRay {
        let (block, lane) = (&self.blocks[index / LANES], index % LANES);
        PathRay {
            origin: block.origin.get(lane),
            direction: block.direction.get(lane),
            t_min: block.t_min.0[lane],
            t_max: block.t_max.0[lane],
            origin_sphere: block.origin_sphere.0[lane],
            target_sphere: block.target_sphere.0[lane],
            t_exit: block.t_exit.0[lane],
        }
    }

    /// Returns true if a ray goes into its origin sphere.
    #[inline(always)]
    pub fn is_inward(&self, index: usize) -> bool {
        self.blocks[index / LANES].t_exit.0[index % LANES] < f64::INFINITY
    }

    /// Iterates over all rays in order.
    pub fn iter(&self) -> impl Iterator<Item = PathRay> + '_ {
        (0..self.len).map(|index| self.get(index))
    }

    /// Returns all blocks in use; the unused lanes of the last one hold stale data.
    pub fn blocks(&self) -> &[RayBlock] {
        &self.blocks[..self.len.div_ceil(LANES)]
    }

    /// Counts the rays that a backend traces: those that are valid and whose interval is not empty.
    pub fn count_traced(&self, isa: Isa) -> usize {
        let mut count = 0;
        let mut remaining = self.len;
        for block in self.blocks() {
            let mut is_traced = Lanes::default();
            isa.run(FindTraced { block, is_traced: &mut is_traced });
            let used = remaining.min(LANES);
            count += is_traced.0[..used].iter().sum::<u32>() as usize;
            remaining -= used;
        }
        count
    }
}

impl RayBlock {
    /// Returns the end of the interval in which a lane's ray may hit anything but its exit point;
    /// minus infinity if the ray is invalid, by the rule of [`crate::math::Ray::is_valid`].
    #[inline(always)]
    pub fn t_end(&self, lane: usize) -> f64 {
        const LIMIT: f64 = 4.0 * MAX_COORDINATE;
        let [origin, direction] =
            [self.origin.get(lane), self.direction.get(lane)].map(|v| v.abs());
        let t_min = self.t_min.0[lane];
        let (t_max, t_exit) = (self.t_max.0[lane], self.t_exit.0[lane]);
        let t_max = if t_exit < t_max { t_exit } else { t_max };
        // Branch-free, because branches would prevent vectorisation.
        let is_valid = (origin.x <= LIMIT)
            & (origin.y <= LIMIT)
            & (origin.z <= LIMIT)
            & (direction.x <= LIMIT)
            & (direction.y <= LIMIT)
            & (direction.z <= LIMIT)
            & (t_min >= 0.0)
            & (t_max >= 0.0)
            & (t_min <= LIMIT);
        if is_valid { t_max } else { f64::NEG_INFINITY }
    }
}

/// Finds the rays of a block that are traced.
struct FindTraced<'a> {
    block: &'a RayBlock,
    /// 1 or 0.
    is_traced: &'a mut Lanes<u32>,
}

impl SimdKernel for FindTraced<'_> {
    #[inline(always)]
    fn run(self) {
        for lane in 0..LANES {
            let is_traced = self.block.t_min.0[lane] < self.block.t_end(lane);
            self.is_traced.0[lane] = u32::from(is_traced);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{SphereRows, SphereSet};
    use crate::math::DVec3;

    fn from(x: f64) -> PathRay {
        PathRay::new(DVec3::new(x, 1.0, 2.0), DVec3::Z)
    }

    #[test]
    fn rays_come_back_as_they_were_pushed_and_those_that_cannot_be_traced_do_not_count() {
        let mut rays = PathRays::default();
        for round in 0..2 {
            rays.clear();
            for i in 0..100u32 {
                let x = f64::from(i + round);
                let ray =
                    PathRay { origin_sphere: i, ..PathRay::new(DVec3::new(x, 1.0, 2.0), DVec3::Z) };
                rays.push(&match i % 4 {
                    0 => ray,
                    1 => PathRay { t_exit: 0.0, ..ray },
                    2 => PathRay { origin: DVec3::splat(f64::NAN), ..ray },
                    _ => PathRay { t_min: 1.0, t_max: 3.0, ..ray },
                });
            }
            let found: Vec<PathRay> = rays.iter().collect();
            assert_eq!(found.len(), 100);
            assert_eq!(found[43].origin.x, 43.0 + f64::from(round));
            assert!((0..100).all(|i| found[i as usize].origin_sphere == i));
            assert!(Isa::available().into_iter().all(|isa| rays.count_traced(isa) == 50));
        }
    }

    #[test]
    fn rays_are_counted_and_what_an_earlier_batch_left_behind_them_is_not() {
        let mut rays = PathRays::default();
        assert!(rays.is_empty() && rays.blocks().is_empty());
        (0..2 * LANES).for_each(|i| rays.push(&from(i as f64)));
        assert_eq!((rays.len(), rays.blocks().len()), (2 * LANES, 2));
        (0..LANES * LANES).for_each(|i| rays.push(&from(i as f64)));
        let last = rays.get(LANES * (LANES + 2) - 1);
        assert_eq!(last.origin.x, (LANES * LANES - 1) as f64);
        rays.clear();
        assert!(rays.is_empty());
        (0..LANES + 3).for_each(|i| rays.push(&from(i as f64)));
        rays.set(2, &PathRay { t_max: 0.0, ..from(0.0) });
        assert_eq!((rays.len(), rays.blocks().len()), (LANES + 3, 2));
        assert!(!rays.is_empty());
        assert!(Isa::available().into_iter().all(|isa| rays.count_traced(isa) == LANES + 2));
    }

    #[test]
    fn a_block_of_rays_stands_behind_the_others_and_aims_at_nothing() {
        let mut rays = PathRays::default();
        let shadow =
            PathRay { t_max: 1.0, origin_sphere: 3, target_sphere: 4, t_exit: 0.5, ..from(0.0) };
        (0..3).for_each(|_| _ = rays.push_block(LANES));
        assert!((0..3 * LANES).all(|index| !rays.is_inward(index)));
        rays.set(LANES + 1, &shadow);
        let into = (0..3 * LANES).filter(|&index| rays.is_inward(index));
        assert!(into.eq([LANES + 1]));
        rays.clear();
        (0..LANES).for_each(|_| rays.push(&shadow));
        rays.push_block(3).origin.set(2, DVec3::X);
        assert_eq!(rays.len(), LANES + 3);
        let PathRay { origin, t_max, origin_sphere, target_sphere, t_exit, .. } =
            rays.get(LANES + 2);
        assert_eq!((origin, t_max, t_exit), (DVec3::X, f64::INFINITY, f64::INFINITY));
        assert_eq!((origin_sphere, target_sphere), (NO_SPHERE, NO_SPHERE));
        assert!(rays.is_inward(LANES - 1) && !rays.is_inward(LANES));
        assert_eq!(rays.get(LANES - 1).t_exit, 0.5);
    }

    /// Sets each number of a ray out of range, one at a time.
    #[test]
    fn a_ray_of_a_block_ends_where_that_of_a_backend_does() {
        let limit = 4.0 * MAX_COORDINATE;
        let mut rays = vec![PathRay { t_exit: 3.0, t_max: 5.0, ..from(0.0) }];
        for value in [limit, -limit, 1.1 * limit, -1.1 * limit, f64::INFINITY, f64::NAN] {
            for axis in 0..3 {
                let mut bent = [from(0.0); 2];
                bent[0].origin[axis] = value;
                bent[1].direction[axis] = value;
                rays.extend(bent);
            }
            rays.push(PathRay { t_min: value, ..from(0.0) });
        }
        let ends = [0.0, 2.0, -1.0, limit, f64::INFINITY];
        rays.extend(ends.map(|t_max| PathRay { t_max, ..from(0.0) }));
        rays.extend(ends.map(|t_min| PathRay { t_min, ..from(0.0) }));
        let set = SphereSet::new(SphereRows::default()).expect("nothing");
        let end = |ray: &PathRay| {
            let mut rays = PathRays::default();
            rays.push(ray);
            rays.blocks()[0].t_end(0)
        };
        for ray in &rays {
            let is_valid = set.to_query(ray).is_valid();
            let expected = if is_valid { ray.t_max.min(ray.t_exit) } else { f64::NEG_INFINITY };
            assert_eq!(end(ray), expected, "{ray:?}");
        }
    }
}
