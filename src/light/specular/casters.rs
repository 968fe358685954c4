//! The balls of a scene over which connections are made.

use std::ops::ControlFlow;

use rayon::prelude::*;

use crate::geometry::{Sphere, SphereSet};

use super::super::sphere_tree::SphereTree;

/// Candidates that one task tests.
const CHUNK: usize = 1024;

/// A polished ball.
#[derive(Clone, Copy, Debug)]
pub struct Caster {
    /// The sphere's id.
    pub id: u32,
    /// The sphere.
    pub ball: Sphere,
    /// What the ball does with light.
    pub surface: CasterSurface,
}

/// A polished surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CasterSurface {
    /// A mirror or a smooth metal, with its reflectance at normal incidence, in luminance.
    Opaque(f64),
    /// A smooth dielectric, with its index of refraction relative to vacuum.
    Dielectric(f64),
}

/// The balls of a scene over which connections are made, sorted by id.
#[derive(Debug, Default)]
pub struct Casters {
    casters: Vec<Caster>,
}

impl Casters {
    /// Keeps the candidates, sorted by id, that no other of the `dielectrics`, given by id,
    /// touches: connections know no other media than vacuum and the ball's. A dielectric inside of
    /// a ball, such as a bubble, does not touch it, but may hide what is behind it.
    ///
    /// The time is about proportional to the number of candidates, except where very many bubbles
    /// lie in one ball.
    pub fn find(candidates: &[Caster], dielectrics: &[u32], spheres: &SphereSet) -> Self {
        debug_assert!(candidates.is_sorted_by_key(|caster| caster.id));
        if candidates.is_empty() {
            return Self::default();
        }
        let tree = SphereTree::new(dielectrics.iter().map(|&id| spheres.sphere(id)));
        let kept = |chunk: &[Caster]| {
            let mut pending = Vec::new();
            let mut is_free = |caster: &Caster| {
                let mut is_touched = false;
                tree.visit(
                    &mut pending,
                    |bounds| {
                        let [nearest, farthest] = bounds.distances_squared(caster.ball.center);
                        let reach = caster.ball.radius + bounds.radii[1];
                        let depth = (caster.ball.radius - bounds.radii[1]).max(0.0);
                        nearest < reach * reach && farthest > depth * depth
                    },
                    |index, other| {
                        let is_other = dielectrics[index as usize] != caster.id;
                        is_touched = is_other && touches(&caster.ball, other);
                        if is_touched { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
                    },
                );
                !is_touched
            };
            chunk.iter().filter(|&caster| is_free(caster)).copied().collect::<Vec<_>>()
        };
        Self { casters: candidates.par_chunks(CHUNK).flat_map_iter(kept).collect() }
    }

    /// All balls, sorted by id.
    pub fn all(&self) -> &[Caster] {
        &self.casters
    }

    /// Returns the index of refraction of a ball, relative to vacuum; `None` if it is opaque.
    pub fn ior(&self, index: u32) -> Option<f64> {
        match self.casters[index as usize].surface {
            CasterSurface::Opaque(_) => None,
            CasterSurface::Dielectric(ior) => Some(ior),
        }
    }

    /// Returns true if there are none.
    pub fn is_empty(&self) -> bool {
        self.casters.is_empty()
    }

    /// Returns the index of a sphere among the balls.
    pub fn index_of(&self, id: u32) -> Option<u32> {
        let index = self.casters.binary_search_by_key(&id, |caster| caster.id).ok()?;
        Some(index as u32)
    }
}

/// Returns true if a sphere meets the surface of a ball or contains the ball.
fn touches(ball: &Sphere, other: &Sphere) -> bool {
    let distance = ball.center.distance(other.center);
    distance < ball.radius + other.radius && distance + other.radius >= ball.radius
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::SphereRows;
    use crate::math::DVec3;
    use crate::sampling::Sampler;

    fn set(exact: Vec<Sphere>) -> SphereSet {
        SphereSet::new(SphereRows { exact, table: Vec::new() }).expect("few spheres")
    }

    fn ball(x: f64, radius: f64) -> Sphere {
        Sphere { center: DVec3::new(x, 0.0, 0.0), radius }
    }

    /// The rows of the balls that are kept among glass balls in these places.
    fn kept(balls: &[Sphere]) -> Vec<u32> {
        let spheres = set(balls.to_vec());
        let ids: Vec<u32> = (0..balls.len() as u32).collect();
        let caster = |id| {
            let (ball, surface) = (spheres.sphere(id), CasterSurface::Dielectric(1.5));
            Caster { id, ball, surface }
        };
        let candidates: Vec<_> = ids.iter().map(|&id| caster(id)).collect();
        let casters = Casters::find(&candidates, &ids, &spheres);
        let mut rows: Vec<u32> = casters.all().iter().map(|kept| spheres.row(kept.id)).collect();
        rows.sort_unstable();
        rows
    }

    #[test]
    fn balls_that_another_dielectric_touches_are_left_out() {
        assert_eq!(kept(&[ball(0.0, 1.0), ball(3.0, 1.0)]), [0, 1], "apart");
        assert_eq!(kept(&[ball(0.0, 1.0), ball(1.5, 1.0), ball(9.0, 1.0)]), [2], "overlapping");
        assert_eq!(kept(&[ball(0.0, 1.0), ball(0.2, 0.5)]), [0], "a bubble, which is inside");
        assert_eq!(kept(&[ball(0.0, 1.0), ball(2.0, 1.0)]), [0, 1], "only tangent");
    }

    #[test]
    fn the_search_keeps_what_all_pairs_keep() {
        let balls: Vec<Sphere> = (0..3000)
            .map(|i| {
                let sampler = Sampler::independent(4, i, 0);
                let [x, y, z, r] = [0, 1, 2, 3].map(|d| sampler.get(d));
                Sphere { center: DVec3::new(x, y, z), radius: 0.1 * r * r * r * r + 1e-3 }
            })
            .collect();
        let is_free = |i: usize| (0..balls.len()).all(|j| j == i || !touches(&balls[i], &balls[j]));
        let expected: Vec<u32> =
            (0..balls.len()).filter(|&i| is_free(i)).map(|i| i as u32).collect();
        assert!((200..2800).contains(&expected.len()), "{}", expected.len());
        assert_eq!(kept(&balls), expected);
    }

    /// A gas of a hundred thousand balls; all pairs would take minutes.
    #[test]
    fn a_gas_is_searched_fast() {
        let ball = |i: u64| {
            let sampler = Sampler::independent(4, i, 0);
            let center = DVec3::new(sampler.get(0), sampler.get(1), sampler.get(2));
            Sphere { center, radius: 3e-3 }
        };
        let kept = kept(&(0..100_000).map(ball).collect::<Vec<_>>()).len();
        // The probability of no other centre within two radii is exp(-N 4/3 pi (2 r)^3).
        assert!((90_400..92_200).contains(&kept), "{kept}");
    }
}
