//! Families of scenes for tests: each a function of its size and a seed.

use photosphere::geometry::Sphere;
use photosphere::math::DVec3;
use rand::rngs::StdRng;
use rand::{RngExt, SeedableRng};

/// Random spheres in the unit box, about 8 mean free paths deep: `N pi r^2 = 8`, `r <= 0.2`, radii
/// 25 % up and down.
pub(crate) fn gas(count: usize, seed: u64) -> Vec<Sphere> {
    let radius = (8.0 / (std::f64::consts::PI * count as f64)).sqrt().min(0.2);
    let mut rng = StdRng::seed_from_u64(seed);
    let mut sphere = || ball(in_box(&mut rng), radius * rng.random_range(0.75..1.25));
    (0..count).map(|_| sphere()).collect()
}

/// Equal spheres in the unit box, moved off a grid by a little and filling about half of it.
pub(crate) fn packed(count: usize, seed: u64) -> Vec<Sphere> {
    let side = (count as f64).cbrt().ceil() as usize;
    let step = 1.0 / side as f64;
    let mut rng = StdRng::seed_from_u64(seed);
    let mut place = |i: usize| {
        let cell =
            DVec3::new((i % side) as f64, (i / side % side) as f64, (i / side / side) as f64);
        ball((cell + 0.5 + (in_box(&mut rng) - 0.5) * 0.04) * step, 0.48 * step)
    };
    (0..count).map(&mut place).collect()
}

/// Clusters inside clusters: distances and radii over six decades.
pub(crate) fn clusters(count: usize, seed: u64) -> Vec<Sphere> {
    let mut rng = StdRng::seed_from_u64(seed);
    let mut sphere = || {
        let size = 10f64.powf(rng.random_range(-6.0..0.0));
        let home = DVec3::splat(0.5) + direction(&mut rng) * size;
        ball(home + (in_box(&mut rng) - 0.5) * size * 0.5, size * rng.random_range(0.01..0.1))
    };
    (0..count).map(|_| sphere()).collect()
}

/// Spheres around one centre, each larger than the one before.
pub(crate) fn concentric(count: usize) -> Vec<Sphere> {
    (0..count).map(|i| ball(DVec3::splat(0.5), 0.1 + 0.4 * i as f64 / count as f64)).collect()
}

/// Spheres in a row along one axis of the unit box.
pub(crate) fn collinear(count: usize, axis: usize) -> Vec<Sphere> {
    let sphere = |i: usize| {
        let mut center = DVec3::splat(0.5);
        center[axis] = (i as f64 + 0.5) / count as f64;
        ball(center, 0.4 / count as f64)
    };
    (0..count).map(sphere).collect()
}

/// Random spheres with their centres in one plane of the unit box.
pub(crate) fn coplanar(count: usize, axis: usize, seed: u64) -> Vec<Sphere> {
    let mut spheres = gas(count, seed);
    spheres.iter_mut().for_each(|sphere| sphere.center[axis] = 0.5);
    spheres
}

/// Random spheres so large that most overlap.
pub(crate) fn overlapping(count: usize, seed: u64) -> Vec<Sphere> {
    let mut spheres = gas(count, seed);
    spheres.iter_mut().for_each(|sphere| sphere.radius *= 8.0);
    spheres
}

/// Many small spheres above one huge one, which is not a giant yet at a radius of 20.
pub(crate) fn on_a_huge_ball(count: usize, radius: f64, seed: u64) -> Vec<Sphere> {
    let mut spheres = gas(count, seed);
    spheres.push(ball(DVec3::new(0.5, -radius, 0.5), radius));
    spheres
}

/// Spheres that must stay in f64: each huge, its surface passing near one of the small ones that
/// come with them.
pub(crate) fn giants(count: usize, seed: u64) -> Vec<Sphere> {
    let mut rng = StdRng::seed_from_u64(seed);
    let mut giant = || {
        let radius = 10f64.powf(rng.random_range(5.0..7.0));
        let touched = in_box(&mut rng);
        ball(touched + direction(&mut rng) * radius, radius)
    };
    let mut spheres: Vec<_> = (0..count).map(|_| giant()).collect();
    spheres.extend(gas(100, seed + 1).iter().map(|s| ball(s.center, s.radius * 0.05)));
    spheres
}

/// A sphere from its two parts.
pub(crate) fn ball(center: DVec3, radius: f64) -> Sphere {
    Sphere { center, radius }
}

/// A random point of the unit box.
pub(crate) fn in_box(rng: &mut StdRng) -> DVec3 {
    DVec3::new(rng.random(), rng.random(), rng.random())
}

/// A random unit vector.
pub(crate) fn direction(rng: &mut StdRng) -> DVec3 {
    loop {
        let v = in_box(rng) * 2.0 - 1.0;
        let squared = v.length_squared();
        if squared <= 1.0 && squared > 1e-6 {
            return v / squared.sqrt();
        }
    }
}
