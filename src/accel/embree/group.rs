//! Groups of spheres of similar size, each with an Embree scene of its own.
//!
//! # Bounds
//!
//! Embree only finds candidates; the shim tests them in f64. So no candidate may be lost to the
//! rounding of what Embree is given. With `e = 2^-24`, let all spheres of a group lie in a ball
//! around `m` with radius `H`. The shim starts each ray where it enters that ball, so its origin
//! has `|o| <= |m| + H`, its length is at most `2 H`, and `v = c - o` has `|v| <= 2 H`. Embree
//! computes `s = (v.d) rcp(d.d)`, `p = v - s d`, and where `p.p <= R^2`, `t = s -+ sqrt((R^2 - p.p)
//! rcp(d.d))`. Each rounding moves the apparent surface by a multiple of `e |v|`, of `e R`, or of
//! the size of the coordinates:
//!
//! | step | `e \|v\|` | `e R` | `e (\|m\| + H)` |
//! |---|---|---|---|
//! | the sphere, its box, and the ray's origin | | 2 | 3 |
//! | the direction, rounded to f32 | 1 | | |
//! | `v` | 1 | | |
//! | `s`: two dot products of 3, a reciprocal by one Newton step (4), a product | 11 | | |
//! | `p`: a product and a difference | 2 | | |
//! | `p.p` and `R^2`, halved by the root | | 2 | |
//! | half the chord: (difference, `rcp(d.d)` 7, product) halved, and the root | | 5.5 | |
//! | `s -+ h` | 1 | 1 | |
//!
//! The sum is at most `e (3 |m| + 46 H)`. Radii and boxes are enlarged by `E = 16 e (|m| + 4 H)`.
//! Rays enter an enlarged sphere earlier and exit it later: the roots move by at most
//! `sqrt((R + 2 E)^2 - R^2)`, the half chord at a tangent, plus `2 E`. That is the *slack* by which
//! a ray starts earlier and ends later for Embree. (The far root would be found without starting
//! that much earlier, but not if another sphere is hit before it.)
//!
//! Most candidates need no f64. Let Embree report half a chord `w` where the ray enters a sphere.
//! Then `R^2 - p.p >= (w - E)^2`, and the sphere as written has `r^2 - p.p >= w^2 - 2 w E - 7 E R`,
//! since `R` and the perpendicular distance are each off by at most `E <= R`. With `w^2 > 32 E R`
//! this is positive: the ray hits the sphere, and at a distance that differs from Embree's by less
//! than the slack. Such a hit is *certain* if it is not excluded and lies further than the slack
//! inside the ray's interval. A certain hit more than twice the slack before all others is first,
//! and its distance is computed in f64 once, when Embree has finished.
//!
//! The slack grows with the largest radius of a group, so a few large spheres among many small ones
//! are a group of user geometry together with the giants. User geometry has no roots in f32, and
//! its slack is `2 E`.

use std::ptr;
use std::sync::Arc;

use rayon::prelude::*;

use crate::geometry::{Sphere, SphereSet};
use crate::math::{DVec3, F32_UNIT_ROUNDOFF};

use super::sys;

/// A particle larger than this many times the median radius is a large sphere.
const LARGE: f64 = 16.0;
/// If there are more large spheres, they are not separated from the others.
const MAX_LARGE: usize = 1 << 16;
/// Spheres sampled for the median radius.
const SAMPLES: usize = 1 << 12;

/// How particles are represented in Embree. Large spheres are always user geometry.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::accel) enum ParticleGeometry {
    Points,
    User,
}

/// A group as the shim reads it. Never moves or changes once inside its `Arc`.
pub(super) struct SphereGroup {
    pub(super) raw: sys::PsGroup,
    pub(super) geometry: ParticleGeometry,
    /// Owns what `raw` points to.
    _set: Arc<SphereSet>,
    _ids: Vec<u32>,
    _points: Vec<[f32; 4]>,
}

// SAFETY: the pointers lead to memory that this value owns and that is never written.
unsafe impl Send for SphereGroup {}
// SAFETY: as above.
unsafe impl Sync for SphereGroup {}

impl SphereGroup {
    /// Divides the spheres of a set into at most two groups: particles, with this geometry, and
    /// large spheres.
    pub(super) fn divide(set: &Arc<SphereSet>, particles: ParticleGeometry) -> Vec<Arc<Self>> {
        let count = set.particle_count();
        let mut large = large_particles(set);
        let small: Vec<u32> = match large.is_empty() {
            true => Vec::new(),
            false => {
                let is_small = |id: &u32| large.binary_search(id).is_err();
                (0..count as u32).into_par_iter().filter(is_small).collect()
            }
        };
        let small_count = count - large.len();
        large.extend(count as u32..set.len() as u32);
        let mut groups = Vec::with_capacity(2);
        if !large.is_empty() {
            let count = large.len();
            groups.push(Self::new(set, large, count, ParticleGeometry::User));
        }
        if small_count > 0 {
            groups.push(Self::new(set, small, small_count, particles));
        }
        groups
    }

    /// Creates the group of these ids, or of the first `count` if there are none.
    fn new(
        set: &Arc<SphereSet>,
        ids: Vec<u32>,
        count: usize,
        geometry: ParticleGeometry,
    ) -> Arc<Self> {
        let id = |index: usize| ids.get(index).copied().unwrap_or(index as u32);
        let spheres = (0..count).into_par_iter().map(|index| set.sphere(id(index)));
        let Bounds { center, radius, smallest, largest } = Bounds::around(spheres.clone());
        let bound = 16.0 * F32_UNIT_ROUNDOFF * (center.length() + 4.0 * radius);
        let enlarge = match geometry {
            ParticleGeometry::Points if set.is_exact_in_f32() => {
                Enlargement::reversible(bound, smallest, largest)
            }
            _ => Enlargement::By(bound),
        };
        let points: Vec<[f32; 4]> = match geometry {
            ParticleGeometry::Points => spheres.map(|s| point(&s, enlarge)).collect(),
            ParticleGeometry::User => Vec::new(),
        };
        let enlargement = enlarge.at_most(largest);
        let tangent = match geometry {
            ParticleGeometry::Points => (4.0 * enlargement * (largest + enlargement)).sqrt(),
            ParticleGeometry::User => 0.0,
        };
        let raw = sys::PsGroup {
            spheres: all_spheres(set),
            ids: if ids.is_empty() { ptr::null() } else { ids.as_ptr() },
            // A set has less than 2^32 spheres.
            count: count as u32,
            points: if points.is_empty() { ptr::null() } else { points.as_ptr().cast() },
            radius_steps: enlarge.steps(),
            center: center.to_array(),
            radius: radius + 2.0 * enlargement,
            enlargement,
            slack: 2.0 * enlargement + tangent,
            certain_chord: (32.0 * enlargement) as f32,
        };
        Arc::new(Self { raw, geometry, _set: set.clone(), _ids: ids, _points: points })
    }

    /// Bytes held, without the spheres of the set.
    pub(super) fn bytes(&self) -> usize {
        size_of_val(&*self._ids) + size_of_val(&*self._points)
    }
}

/// Returns the ids of the few particles that are much larger than most, ascending; none if there
/// are too many.
fn large_particles(set: &SphereSet) -> Vec<u32> {
    let count = set.particle_count();
    let step = count.div_ceil(SAMPLES).max(1);
    let radius = |id: usize| set.sphere(id as u32).radius;
    let mut radii: Vec<f64> = (0..count).step_by(step).map(radius).collect();
    radii.sort_unstable_by(f64::total_cmp);
    let Some(&median) = radii.get(radii.len() / 2) else { return Vec::new() };
    let is_large = |&id: &u32| set.sphere(id).radius > LARGE * median;
    let number = (0..count as u32).into_par_iter().filter(is_large).count();
    if number > MAX_LARGE {
        return Vec::new();
    }
    (0..count as u32).into_par_iter().filter(is_large).collect()
}

/// How a group's radii are enlarged.
#[derive(Clone, Copy)]
enum Enlargement {
    By(f64),
    /// To the f32 number so many numbers above. This can be undone exactly, so the radius as
    /// written need not be read from other memory.
    Steps(u32),
}

impl Enlargement {
    /// Enlarges all radii of these limits by at least `bound`; reversibly, unless that would
    /// enlarge the largest by much more.
    fn reversible(bound: f64, smallest: f64, largest: f64) -> Self {
        let above = ((smallest + bound) as f32).to_bits() + 1;
        let steps = Self::Steps(above - (smallest as f32).to_bits());
        if steps.at_most(largest) <= 4.0 * bound { steps } else { Self::By(bound) }
    }

    fn radius(self, radius: f64) -> f32 {
        match self {
            Self::By(bound) => (radius + bound) as f32,
            Self::Steps(steps) => f32::from_bits((radius as f32).to_bits() + steps),
        }
    }

    /// The most by which it enlarges radii. Distances of f32 numbers grow with the numbers.
    fn at_most(self, largest: f64) -> f64 {
        match self {
            Self::By(bound) => bound,
            Self::Steps(_) => f64::from(self.radius(largest)) - largest,
        }
    }

    fn steps(self) -> u32 {
        match self {
            Self::By(_) => 0,
            Self::Steps(steps) => steps,
        }
    }
}

/// The sphere with an enlarged radius.
fn point(sphere: &Sphere, enlargement: Enlargement) -> [f32; 4] {
    let center = sphere.center.as_vec3();
    [center.x, center.y, center.z, enlargement.radius(sphere.radius)]
}

fn all_spheres(set: &SphereSet) -> sys::PsSpheres {
    let rows = set.raw_rows();
    sys::PsSpheres {
        f32_rows: rows.f32.map_or(ptr::null(), |rows| rows.as_ptr().cast()),
        f64_rows: rows.f64.as_ptr().cast(),
        giants: rows.giants.as_ptr().cast(),
        origin: set.origin().to_array(),
        particle_count: set.particle_count() as u32,
    }
}

/// A ball around spheres, and the limits of their radii.
struct Bounds {
    center: DVec3,
    radius: f64,
    smallest: f64,
    largest: f64,
}

impl Bounds {
    fn around(spheres: impl ParallelIterator<Item = Sphere> + Clone) -> Self {
        let extent = |s: Sphere| [(s.center - s.radius, s.radius), (s.center + s.radius, s.radius)];
        let empty = || [(DVec3::INFINITY, f64::INFINITY), (DVec3::NEG_INFINITY, 0.0)];
        let add = |[a, b]: [(DVec3, f64); 2], [c, d]: [(DVec3, f64); 2]| {
            [(a.0.min(c.0), a.1.min(c.1)), (b.0.max(d.0), b.1.max(d.1))]
        };
        let [(low, smallest), (high, largest)] = spheres.clone().map(extent).reduce(empty, add);
        let center = (low + high) * 0.5;
        let reach = |s: Sphere| s.center.distance(center) + s.radius;
        let radius = spheres.map(reach).reduce(|| 0.0, f64::max);
        Self { center, radius, smallest, largest }
    }
}
