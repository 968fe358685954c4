//! Every sampling routine against its own density: one line each in the table below.
//!
//! A routine draws a million points with a fixed seed; they are counted in cells, and the counts
//! are compared with the density integrated over each cell (Pearson's chi-square). Cells expected to
//! hold fewer than five points are pooled. The family-wise significance is 1 %, shared over the
//! table by Sidak's correction. A failing histogram is written for plotting.

use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::fmt::Write as _;
use std::path::Path;

use photosphere::color::Rgb;
use photosphere::geometry::{Cone, PathRay, Sphere, SphereRows, SphereSet, SurfaceHit};
use photosphere::light::{Lamp, Lights};
use photosphere::material::{Bsdf, Diffuse, Phong};
use photosphere::math::{DVec3, Frame, Hit};
use photosphere::sampling::{Discrete, Filter, FilterKind, Hemisphere, Sampler, hemisphere};
use statrs::distribution::{ChiSquared, ContinuousCDF};

const SIGNIFICANCE: f64 = 0.01;
const POINTS: u32 = 1_000_000;
/// Cells along each coordinate; odd, so that none straddles a symmetry.
const CELLS: [usize; 2] = [41, 61];
/// Midpoints along each side of a cell, to integrate the density over it.
const MIDPOINTS: usize = 16;

/// A sampling routine and its density over a rectangle of two coordinates.
struct Pair {
    name: String,
    /// A point from four random numbers; `None` where the routine gives none.
    sample: Box<dyn Fn([f64; 4]) -> Option<[f64; 2]>>,
    /// Density over the coordinates, the measure's Jacobian included.
    density: Box<dyn Fn([f64; 2]) -> f64>,
    low: [f64; 2],
    high: [f64; 2],
}

#[test]
fn every_routine_draws_from_its_density() {
    let table = table();
    let each = 1.0 - (1.0 - SIGNIFICANCE).powf(1.0 / table.len() as f64);
    let mut failed = Vec::new();
    for (seed, pair) in table.iter().enumerate() {
        let p = p_value(pair, seed as u64);
        println!("{:<44} p = {p:.4}", pair.name);
        if p < each {
            failed.push(format!("{}: p = {p:.2e} < {each:.2e}", pair.name));
        }
    }
    let histograms = env!("CARGO_TARGET_TMPDIR");
    assert!(failed.is_empty(), "{failed:#?}, histograms in {histograms}");
}

#[test]
fn a_wrong_density_is_found() {
    let mut wrong = over_hemisphere(
        "cosine drawn, uniform claimed",
        |u| Some(Hemisphere::Cosine.sample([u[0], u[1]])),
        |_| 1.0 / TAU,
        FRAC_PI_2,
    );
    assert!(p_value(&wrong, 0) < 1e-9);
    // An error of one percent is seen as well.
    wrong.density = Box::new(|[theta, _]| 1.01 * theta.cos() / PI * theta.sin());
    assert!(p_value(&wrong, 0) < 1e-9);
}

fn table() -> Vec<Pair> {
    let mut table = Vec::new();
    for drawn in [Hemisphere::Cosine, Hemisphere::UniformSolidAngle, Hemisphere::UniformAngle] {
        table.push(over_hemisphere(
            &format!("hemisphere {drawn:?}"),
            move |u| Some(drawn.sample([u[0], u[1]])),
            move |w| drawn.pdf(w.z),
            FRAC_PI_2,
        ));
    }
    for (exponent, up_to) in [(1.0, FRAC_PI_2), (20.0, FRAC_PI_2), (1000.0, 0.2)] {
        table.push(over_hemisphere(
            &format!("power cosine, exponent {exponent}"),
            move |u| Some(hemisphere::sample_power_cosine(exponent, [u[0], u[1]])),
            move |w| hemisphere::power_cosine_pdf(exponent, w.z),
            up_to,
        ));
    }
    for (name, kind, radius) in [
        ("box", FilterKind::Box, 0.5),
        ("tent", FilterKind::Tent, 1.0),
        ("gaussian", FilterKind::Gaussian, 1.5),
        ("blackman-harris", FilterKind::BlackmanHarris, 2.0),
    ] {
        table.push(filter(name, kind, radius));
    }
    for distance in [1.001, 2.0, 1e4, 1e9] {
        table.push(cone(distance));
    }
    for degrees in [0.0, 45.0, 85.0] {
        table.extend(bsdfs(degrees));
    }
    table.push(inside_a_lamp());
    table.push(choice_of_a_lamp());
    table.push(discrete());
    table
}

/// A pair over directions around +z, in polar angle and azimuth.
fn over_hemisphere(
    name: &str,
    sample: impl Fn([f64; 4]) -> Option<DVec3> + 'static,
    pdf: impl Fn(DVec3) -> f64 + 'static,
    up_to: f64,
) -> Pair {
    let direction = |[theta, phi]: [f64; 2]| {
        DVec3::new(theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos())
    };
    Pair {
        name: name.into(),
        sample: Box::new(move |u| sample(u).map(polar)),
        density: Box::new(move |at| pdf(direction(at)) * at[0].sin()),
        low: [0.0, 0.0],
        high: [up_to, TAU],
    }
}

/// Polar angle, accurate near the axis, and azimuth.
fn polar(w: DVec3) -> [f64; 2] {
    let theta = w.x.hypot(w.y).atan2(w.z);
    [theta, w.y.atan2(w.x).rem_euclid(TAU)]
}

fn filter(name: &str, kind: FilterKind, radius: f64) -> Pair {
    let filter = Filter::new(kind, radius);
    let density = filter.clone();
    Pair {
        name: format!("filter {name}"),
        sample: Box::new(move |u| Some(filter.sample([u[0], u[1]]))),
        density: Box::new(move |at| density.pdf(at)),
        low: [-radius; 2],
        high: [radius; 2],
    }
}

/// The visible cone of a unit sphere, in polar coordinates around its axis scaled to the cone.
fn cone(distance: f64) -> Pair {
    let sphere = Sphere { center: DVec3::new(0.6, -0.48, 0.64) * distance, radius: 1.0 };
    let cone = Cone::seen_from(DVec3::ZERO, &sphere).expect("seen from outside");
    let axis = Frame::around(sphere.center.normalize());
    let widest = (1.0 / distance).asin();
    Pair {
        name: format!("cone of a sphere {distance} radii away"),
        sample: Box::new(move |u| {
            let [theta, phi] = polar(axis.to_local(cone.sample([u[0], u[1]]).direction));
            Some([theta / widest, phi])
        }),
        density: Box::new(move |[theta, _]| cone.pdf() * (theta * widest).sin() * widest),
        low: [0.0, 0.0],
        // Rounding may put a direction a last bit outside the cone.
        high: [1.0 + 1e-6, TAU],
    }
}

fn bsdfs(degrees: f64) -> Vec<Pair> {
    let angle = f64::to_radians(degrees);
    let wo = DVec3::new(angle.sin(), 0.0, angle.cos());
    let phong = |exponent, normalized| {
        let (albedo, specular) = (Rgb::splat(0.3), Rgb::splat(0.6));
        Bsdf::Phong(Phong { albedo, specular, exponent, normalized })
    };
    let diffuse = Bsdf::Diffuse(Diffuse { albedo: Rgb::ONE }, Hemisphere::Cosine);
    [
        ("diffuse".to_string(), diffuse),
        ("phong, exponent 3".to_string(), phong(3.0, true)),
        ("classic phong, exponent 30".to_string(), phong(30.0, false)),
    ]
    .map(|(name, bsdf)| {
        over_hemisphere(
            &format!("bsdf {name}, wo at {degrees} degrees"),
            move |u| bsdf.sample(wo, u[2], [u[0], u[1]]).map(|sample| sample.wi),
            move |wi| bsdf.pdf(wo, wi),
            FRAC_PI_2,
        )
    })
    .into()
}

fn ball(x: f64, radius: f64) -> Sphere {
    Sphere { center: DVec3::new(x, 0.0, 0.0), radius }
}

fn set_of(spheres: Vec<Sphere>) -> SphereSet {
    SphereSet::new(SphereRows { exact: spheres, table: Vec::new() }).expect("few spheres")
}

fn id_of_row(set: &SphereSet, row: u32) -> u32 {
    set.rows().iter().position(|&r| r == row).expect("every row has an id") as u32
}

/// A point on the first sphere of a set, seen from the direction `-towards`.
fn point_on(set: &SphereSet, towards: DVec3) -> SurfaceHit {
    let id = id_of_row(set, 0);
    let center = set.sphere(id).center;
    let ray = PathRay::free(center - towards * 3.0, towards);
    set.answer(&ray, Hit { t: 0.0, id }).expect("hits")
}

/// From a ball inside a glowing sphere, every direction above the surface meets the lamp.
fn inside_a_lamp() -> Pair {
    let set = set_of(vec![ball(0.5, 1.0), ball(0.0, 10.0)]);
    let lamp = id_of_row(&set, 1);
    let lights = Lights::new(vec![Lamp { id: lamp, emission: Rgb::ONE }], &set);
    let hit = point_on(&set, DVec3::new(0.0, 0.6, -0.8));
    let frame = Frame::around(hit.facing_normal());
    let (sets, again) = (std::rc::Rc::new((set, lights)), frame);
    let other = sets.clone();
    over_hemisphere(
        "light from inside a lamp",
        move |u| {
            let sample = sets.1.sample(&sets.0, &hit, u[2], [u[0], u[1]])?;
            Some(frame.to_local(sample.direction))
        },
        move |w| other.1.pdf(&other.0, &hit, lamp, again.to_world(w)),
        FRAC_PI_2,
    )
}

/// Three lamps of different power and distance: how often each is chosen, from `pdf` divided by the
/// density of its cone.
fn choice_of_a_lamp() -> Pair {
    let spheres = vec![ball(0.0, 1.0), ball(5.0, 1.0), ball(9.0, 0.5), ball(-30.0, 8.0)];
    let set = set_of(spheres.clone());
    let lamps =
        (1..4).map(|row| Lamp { id: id_of_row(&set, row), emission: Rgb::splat(row as f32) });
    let lights = Lights::new(lamps.collect(), &set);
    let hit = point_on(&set, DVec3::new(0.0, 0.0, -1.0));
    let probability = |row: u32| {
        let id = id_of_row(&set, row);
        let cone = Cone::seen_from(hit.point, &set.sphere(id)).expect("outside");
        lights.pdf(&set, &hit, id, DVec3::X) / cone.pdf()
    };
    over_indices("choice among three lamps", (1..4).map(probability).collect(), {
        let rows: Vec<u32> = set.rows().to_vec();
        move |u| {
            let sample = lights.sample(&set, &hit, u[2], [u[0], u[1]]).expect("visible");
            rows[sample.lamp.id as usize] as usize - 1
        }
    })
}

fn discrete() -> Pair {
    let choice = Discrete::new([0.1, 3.0, 0.0, 0.7, 1e-3]).expect("valid");
    let probabilities = (0..5).map(|i| choice.pmf(i)).collect();
    over_indices("discrete choice", probabilities, move |u| choice.sample(u[0]))
}

/// A discrete routine: index `i` is the middle of the cell `i` along the first coordinate.
fn over_indices(
    name: &str,
    probabilities: Vec<f64>,
    sample: impl Fn([f64; 4]) -> usize + 'static,
) -> Pair {
    assert!(probabilities.len() <= CELLS[0]);
    Pair {
        name: name.into(),
        sample: Box::new(move |u| Some([sample(u) as f64 + 0.5, u[3]])),
        density: Box::new(move |[x, _]| probabilities.get(x as usize).copied().unwrap_or(0.0)),
        low: [0.0; 2],
        high: [CELLS[0] as f64, 1.0],
    }
}

/// The probability of counts at least as far from the density as those found.
fn p_value(pair: &Pair, seed: u64) -> f64 {
    let observed = count(pair, seed);
    let expected = expect(pair);
    let total: f64 = expected.iter().sum();
    let lost = f64::from(POINTS) - total;
    if lost < -1e-3 * f64::from(POINTS) {
        return 0.0; // a density that adds up to more than one
    }

    // What the routine gave up on, or put outside, is one more cell; small cells are pooled.
    let inside: u64 = observed.iter().sum();
    let mut cells: Vec<(f64, f64)> =
        expected.iter().zip(&observed).map(|(&e, &o)| (e, o as f64)).collect();
    cells.push((lost.max(0.0), (u64::from(POINTS) - inside) as f64));
    let (small, mut large): (Vec<_>, Vec<_>) = cells.into_iter().partition(|(e, _)| *e < 5.0);
    let pooled = small.iter().fold((0.0, 0.0), |sum, cell| (sum.0 + cell.0, sum.1 + cell.1));
    if pooled.0 >= 5.0 {
        large.push(pooled);
    } else if pooled.1 > pooled.0 + 30.0 {
        return 0.0; // points where there is no density
    }
    let statistic: f64 = large.iter().map(|(e, o)| (o - e) * (o - e) / e).sum();
    let p = ChiSquared::new((large.len() - 1) as f64).expect("some cells").sf(statistic);
    if p < 1e-3 {
        write_histogram(pair, &expected, &observed);
    }
    p
}

fn count(pair: &Pair, seed: u64) -> Vec<u64> {
    let mut counts = vec![0; CELLS[0] * CELLS[1]];
    for i in 0..POINTS {
        let sampler = Sampler::new(seed, u64::from(i), 0);
        let u = std::array::from_fn(|dimension| sampler.get(dimension as u32));
        let Some(at) = (pair.sample)(u) else { continue };
        let cell: [Option<usize>; 2] = std::array::from_fn(|axis| {
            let place = (at[axis] - pair.low[axis]) / (pair.high[axis] - pair.low[axis]);
            let inside = (0.0..=1.0).contains(&place);
            inside.then(|| ((place * CELLS[axis] as f64) as usize).min(CELLS[axis] - 1))
        });
        if let [Some(row), Some(column)] = cell {
            counts[row * CELLS[1] + column] += 1;
        }
    }
    counts
}

fn expect(pair: &Pair) -> Vec<f64> {
    let side: [f64; 2] = std::array::from_fn(|axis| {
        (pair.high[axis] - pair.low[axis]) / (CELLS[axis] * MIDPOINTS) as f64
    });
    let middle = |axis: usize, index: usize| pair.low[axis] + (index as f64 + 0.5) * side[axis];
    let mut expected = vec![0.0; CELLS[0] * CELLS[1]];
    for row in 0..CELLS[0] * MIDPOINTS {
        for column in 0..CELLS[1] * MIDPOINTS {
            let density = (pair.density)([middle(0, row), middle(1, column)]);
            expected[row / MIDPOINTS * CELLS[1] + column / MIDPOINTS] +=
                density * side[0] * side[1] * f64::from(POINTS);
        }
    }
    expected
}

fn write_histogram(pair: &Pair, expected: &[f64], observed: &[u64]) {
    let mut text = format!("# {}\n# row column expected observed\n", pair.name);
    for (i, (e, o)) in expected.iter().zip(observed).enumerate() {
        writeln!(text, "{} {} {e} {o}", i / CELLS[1], i % CELLS[1]).expect("a string has room");
    }
    let name: String =
        pair.name.chars().map(|c| if c.is_alphanumeric() { c } else { '-' }).collect();
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("chi2-{name}.txt"));
    std::fs::write(path, text).expect("the target directory can be written to");
}
