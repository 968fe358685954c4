//! One ray in f64, and the best hit so far: where a tree's candidates are judged.

use crate::fault::fault;
use crate::geometry::Sphere;
use crate::math::{DVec3, Hit, NO_SPHERE, Ray};

/// One ray in f64, and the best hit so far.
#[derive(Clone, Copy)]
pub(super) struct Query {
    pub(super) origin: DVec3,
    pub(super) direction: DVec3,
    pub(super) t_min: f64,
    exclude: [u32; 2],
    /// Distance of the best hit so far, in units of the direction's length; at first, the ray's end.
    pub(super) t: f64,
    /// The sphere hit, or [`NO_SPHERE`].
    id: u32,
}

impl Query {
    /// `None` for a ray that is not valid, and so hits nothing.
    #[inline(always)]
    pub(super) fn new(ray: &Ray) -> Option<Self> {
        let (origin, direction) = (ray.origin_f64(), ray.direction_f64());
        let (t_min, t) = (f64::from(ray.t_min), f64::from(ray.t_max));
        let query = Self { origin, direction, t_min, exclude: ray.exclude, t, id: NO_SPHERE };
        ray.is_valid().then_some(query)
    }

    /// Whether the ray is told to overlook the sphere.
    #[inline(always)]
    pub(super) fn excludes(&self, id: u32) -> bool {
        self.exclude.contains(&id)
    }

    /// Takes the sphere's hit if it is better: nearer, or as near and of a smaller id.
    #[inline(always)]
    pub(super) fn offer(&mut self, id: u32, sphere: &Sphere) {
        if self.excludes(id) {
            return;
        }
        let root = sphere.first_root(self.origin, self.direction, self.t_min, f64::INFINITY);
        let Some(t) = root else { return };
        let is_better = t < self.t
            || fault!(NotTheNearest)
            || (t == self.t && id < self.id && self.id != NO_SPHERE);
        if is_better {
            self.t = t;
            self.id = id;
        }
    }

    #[inline(always)]
    pub(super) fn has_hit(&self) -> bool {
        self.id != NO_SPHERE
    }

    #[inline(always)]
    pub(super) fn hit(&self) -> Hit {
        if self.has_hit() { Hit { t: self.t as f32, id: self.id } } else { Hit::MISS }
    }
}
