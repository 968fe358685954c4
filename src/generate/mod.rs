//! Generates scenes with any number of spheres, for tests and benchmarks (`photosphere generate`).
//!
//! Every sphere is a pure function of the recipe and its index, so a table has the same bytes for
//! any number of threads. The generator is fixed (`Xoshiro256PlusPlus` of `rand`, whose output is
//! guaranteed to stay stable), and transcendental functions come from `libm`, so the bytes are
//! identical on every machine.

mod arrangement;
mod color;
mod placement;
mod rng;
mod scene;
mod table;

use crate::error::{Error, Result, Suggestion};
use crate::math::NO_SPHERE;

use placement::Placement;

pub use arrangement::Arrangement;
pub use scene::scene_text;
pub use table::write_rows;

/// Maximum number of spheres in a scene.
const MAX_SPHERES: u64 = NO_SPHERE as u64 - 2;

/// Parameters of a generated scene.
#[derive(Clone, Debug)]
pub struct Recipe {
    arrangement: Arrangement,
    count: u64,
    seed: u64,
    colors: bool,
    placement: Placement,
}

/// One sphere of a table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GeneratedSphere {
    /// Center and radius.
    pub sphere: [f32; 4],
    /// Linear albedo, in `[0, 1]`.
    pub color: [f32; 3],
}

impl Recipe {
    /// Creates a recipe for `count` spheres; with `colors`, each has its own color.
    ///
    /// # Errors
    /// When `count` is zero or more than a scene can hold.
    pub fn new(arrangement: Arrangement, count: u64, seed: u64, colors: bool) -> Result<Self> {
        if count == 0 {
            return Err(Error::input("a table has at least one sphere")
                .with_help("use a larger count")
                .with_suggestion(Suggestion::Count, "1"));
        }
        if count > MAX_SPHERES {
            let message =
                format!("{count} spheres are more than the {MAX_SPHERES} that a scene can hold");
            return Err(Error::input(message)
                .with_help("use a smaller count")
                .with_suggestion(Suggestion::Count, MAX_SPHERES.to_string()));
        }
        let places = Placement::new(arrangement, count, seed);
        Ok(Self { arrangement, count, seed, colors, placement: places })
    }

    /// How the spheres are arranged.
    pub fn arrangement(&self) -> Arrangement {
        self.arrangement
    }

    /// Number of spheres.
    pub fn count(&self) -> u64 {
        self.count
    }

    /// Returns true if the table has colors.
    pub fn has_colors(&self) -> bool {
        self.colors
    }

    /// Generates the sphere with this index, which must be less than the count.
    pub fn sphere(&self, index: u64) -> GeneratedSphere {
        let mut numbers = rng::for_sphere(self.seed, index);
        let placed = self.placement.sphere_at(index, &mut numbers);
        let color = color::albedo(self.arrangement, &placed, &mut numbers);
        let [x, y, z] = placed.center.as_vec3().to_array();
        GeneratedSphere { sphere: [x, y, z, placed.radius as f32], color }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::DVec3;
    use std::f64::consts::PI;

    fn rows(arrangement: Arrangement, count: u64) -> Vec<GeneratedSphere> {
        let recipe = Recipe::new(arrangement, count, 7, true).expect("a small count");
        (0..count).map(|index| recipe.sphere(index)).collect()
    }

    fn parts(row: &GeneratedSphere) -> (DVec3, f64) {
        let [x, y, z, radius] = row.sphere.map(f64::from);
        (DVec3::new(x, y, z), radius)
    }

    fn mean(values: impl Iterator<Item = f64>, count: usize) -> f64 {
        values.sum::<f64>() / count as f64
    }

    #[test]
    fn every_arrangement_gives_spheres_and_colours_that_a_table_may_have() {
        for &(name, arrangement) in Arrangement::NAMES {
            assert_eq!(arrangement.name(), name);
            for count in [1, 2, 3, 9, 1000, 4097] {
                for row in rows(arrangement, count) {
                    let (center, radius) = parts(&row);
                    assert!(center.abs().max_element() < 1.5, "{name} {count}: {row:?}");
                    assert!(radius > 1e-6 && radius < 1.0, "{name} {count}: {row:?}");
                    assert!(row.color.iter().all(|c| (0.0..=1.0).contains(c)), "{name}: {row:?}");
                }
            }
        }
    }

    #[test]
    fn a_sphere_depends_on_its_index_and_the_recipe_alone() {
        for &(_, arrangement) in Arrangement::NAMES {
            let recipe = Recipe::new(arrangement, 1000, 7, true).expect("a small count");
            let alone = recipe.sphere(123);
            assert_eq!(rows(arrangement, 1000)[123], alone);
            let other = Recipe::new(arrangement, 1000, 8, true).expect("a small count").sphere(123);
            if arrangement != Arrangement::Lattice {
                assert_ne!(other.sphere, alone.sphere);
            }
        }
    }

    /// The standard error of each mean is far below the tolerance.
    #[test]
    fn a_ray_through_the_gas_meets_about_eight() {
        let rows = rows(Arrangement::Gas, 20_000);
        let (count, radii) = (rows.len(), rows.iter().map(|row| parts(row).1));
        let radius = mean(radii.clone(), count);
        assert!((count as f64 * PI * radius * radius - 8.0).abs() < 0.05);
        let (least, most) = radii.fold((1.0, 0.0), |(a, b), r| (r.min(a), r.max(b)));
        assert!((least / radius - 0.75).abs() < 0.01 && (most / radius - 1.25).abs() < 0.01);
        for axis in 0..3 {
            let at = |row: &GeneratedSphere| parts(row).0[axis];
            assert!(mean(rows.iter().map(at), count).abs() < 0.01);
            assert!((mean(rows.iter().map(|r| at(r).powi(2)), count) - 1.0 / 12.0).abs() < 0.005);
        }
        assert!(rows_of_three_are_small());
    }

    fn rows_of_three_are_small() -> bool {
        rows(Arrangement::Gas, 3).iter().all(|row| parts(row).1 <= 0.25)
    }

    #[test]
    fn packed_spheres_fill_half_of_the_box_and_do_not_touch() {
        let rows = rows(Arrangement::Packed, 4 * 9 * 9 * 9);
        let volume: f64 = rows.iter().map(|row| 4.0 / 3.0 * PI * parts(row).1.powi(3)).sum();
        assert!((volume - 0.5).abs() < 0.01, "{volume}");
        for (i, a) in rows.iter().enumerate() {
            for b in &rows[..i] {
                let ((a, ra), (b, rb)) = (parts(a), parts(b));
                assert!(a.distance(b) > ra + rb, "{a} {b}");
            }
        }
    }

    #[test]
    fn the_radii_of_clusters_span_two_decades_evenly() {
        let radii = rows(Arrangement::Clusters, 40_000).into_iter().map(|row| parts(&row).1);
        let mut radii: Vec<f64> = radii.collect();
        radii.sort_unstable_by(f64::total_cmp);
        let (least, median, most) = (radii[0], radii[20_000], radii[39_999]);
        assert!((most / least / 100.0 - 1.0).abs() < 0.01);
        assert!((median / least / 10.0 - 1.0).abs() < 0.1);
    }

    #[test]
    fn the_lattice_is_one() {
        let rows = rows(Arrangement::Lattice, 1000);
        let (first, second) = (parts(&rows[0]).0, parts(&rows[1]).0);
        // The layers go from the front to the back.
        assert!(first.distance(DVec3::new(-0.45, -0.45, 0.45)) < 1e-6);
        assert!((second - first).distance(DVec3::X * 0.1) < 1e-6);
        assert!(parts(&rows[999]).0.distance(DVec3::new(0.45, 0.45, -0.45)) < 1e-6);
    }

    #[test]
    fn impossible_counts_are_refused() {
        let refused = |count| {
            let recipe = Recipe::new(Arrangement::Gas, count, 0, false);
            recipe.expect_err("too few or too many").to_string()
        };
        assert_eq!(refused(0), "a table has at least one sphere");
        assert_eq!(
            refused(1 << 32),
            "4294967296 spheres are more than the 4294967293 that a scene can hold"
        );
    }
}
