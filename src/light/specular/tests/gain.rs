//! What connections gain: the irradiance of a point, by connection and by chance.
//!
//! Measured ratios of variances at equal samples, for a lamp with an angular radius of 20 degrees
//! and of 1: mirror ball 8e2 and 3e6, reflection off glass 8e3 and 1e8, through glass 1 (the lamp
//! fills the focus) and 3e5, inner reflection 1e4 and 3e8, all three at once 1 and 1e4; a wide and
//! a small lamp inside glass 8e1 and 4e6.

use crate::geometry::{Cone, Sphere};
use crate::math::{DVec3, Frame};
use crate::sampling::{Hemisphere, Sampler, invert_disk, power_heuristic, sin_cos, sin_cos_2pi};

use super::super::{Connection, EmitterView, SpecularPath, Target};
use super::fresnel::reflectance;
use super::traced_ray::{Event, TracedRay};
use super::tracing::events_of;

const SEEDS: u32 = 32;
const SAMPLES: u32 = 10_000;
/// Points of the quadrature along each coordinate.
const POINTS: u32 = 200;
/// Directions of the quadrature along each coordinate.
const DIRECTIONS: u32 = 1000;

/// A surface point with its normal, a ball, and a lamp of radiance 1.
struct LitPoint {
    x: DVec3,
    normal: DVec3,
    ball: Sphere,
    /// 0 for a mirror.
    ior: f64,
    lamp: Sphere,
    kinds: &'static [SpecularPath],
}

impl LitPoint {
    fn view(&self, kind: SpecularPath) -> EmitterView {
        let view = match kind {
            SpecularPath::Inward => {
                EmitterView::through_boundary(&self.ball, self.ior, self.x, &self.lamp)
            }
            _ => EmitterView::from_ball(&self.ball, &self.lamp),
        };
        view.expect("the lamp is seen")
    }

    /// Factor of the radiance that takes a path.
    fn passage(&self, kind: SpecularPath, cos_outside: f64) -> f64 {
        self.choices(kind, cos_outside) * kind.radiance_scale(self.ior)
    }

    /// Probability with which chance takes a path.
    fn choices(&self, kind: SpecularPath, cos_outside: f64) -> f64 {
        if self.ior == 0.0 { 1.0 } else { kind.passage(reflectance(cos_outside, self.ior)) }
    }

    /// Density per solid angle with which chance finds a path that leaves x in this direction.
    fn chance_density(&self, kind: SpecularPath, direction: DVec3, cos_outside: f64) -> f64 {
        let cos = self.normal.dot(direction).max(0.0);
        cos * std::f64::consts::FRAC_1_PI * self.choices(kind, cos_outside)
    }

    /// One sample of each kind by connection, with the weight of multiple importance sampling.
    fn by_connection(&self, u: [f64; 2]) -> f64 {
        let one = |&kind: &SpecularPath| -> f64 {
            let view = self.view(kind);
            let at = view.sample(u);
            let irradiance = |found: &Connection| {
                let density = view.density(at.normal, found.direction_at_y, found.spread);
                let chance = self.chance_density(kind, found.direction_at_x, found.cos_outside);
                if density <= 0.0 || chance <= 0.0 {
                    return 0.0;
                }
                let cos = self.normal.dot(found.direction_at_x);
                let weight = power_heuristic(density, chance);
                weight * cos * self.passage(kind, found.cos_outside) / density
            };
            let y = Target::Point(at.point);
            kind.connect(&self.ball, self.ior, self.x, y).iter().map(irradiance).sum()
        };
        self.kinds.iter().map(one).sum()
    }

    /// The integral over all directions to the ball, by traced rays: for wide lamps, and exact at
    /// caustics.
    fn by_directions(&self) -> f64 {
        let cone = Cone::subtending(self.x, &self.ball).expect("from outside");
        let at = |i: u32| (f64::from(i) + 0.5) / f64::from(DIRECTIONS);
        let all = |i: u32, j: u32| {
            // On circles around the ball's middle.
            let (r, (sin, cos)) = (at(i).sqrt(), sin_cos_2pi(at(j)));
            let direction = cone.sample(invert_disk([r * cos, r * sin])).direction;
            let cos = self.normal.dot(direction).max(0.0);
            let of_kind = |&kind: &SpecularPath| {
                let start = TracedRay::new(self.x, direction);
                let mut events = events_of(kind).iter();
                let cos_outside = self.event(&start, false, 1.0).map_or(0.0, |(_, cos)| cos);
                let ray =
                    events.try_fold(start, |ray, &event| ray.meet(&self.ball, self.ior, event));
                let hits = ray.is_some_and(|ray| self.lamp_on(kind, &ray).is_some());
                if hits { self.passage(kind, cos_outside) } else { 0.0 }
            };
            cos * self.kinds.iter().map(of_kind).sum::<f64>()
        };
        let grid = (0..DIRECTIONS).flat_map(|i| (0..DIRECTIONS).map(move |j| (i, j)));
        let sum: f64 = grid.map(|(i, j)| all(i, j)).sum();
        sum * cone.solid_angle() / f64::from(DIRECTIONS * DIRECTIONS)
    }

    /// The integral over the lamp, by height and azimuth around the direction to the ball: for
    /// small lamps away from caustics.
    fn by_lamp(&self) -> f64 {
        let frame = Frame::from_z((self.ball.center - self.lamp.center).normalize());
        let step = 2.0 / f64::from(POINTS);
        let area = self.lamp.radius * self.lamp.radius * step * step * std::f64::consts::PI;
        let at = |i: u32, j: u32| {
            let z = (f64::from(i) + 0.5) * step - 1.0;
            let (sin_phi, cos_phi) = sin_cos_2pi((f64::from(j) + 0.5) * 0.5 * step);
            let sin = (1.0 - z * z).sqrt();
            let normal = frame.to_world(DVec3::new(sin * cos_phi, sin * sin_phi, z));
            let y = Target::Point(self.lamp.center + normal * self.lamp.radius);
            let irradiance = |kind: SpecularPath, found: &Connection| {
                let cosines =
                    [self.normal.dot(found.direction_at_x), normal.dot(found.direction_at_y)];
                let [at_x, at_y] = cosines.map(|cos| cos.max(0.0));
                at_x * at_y * self.passage(kind, found.cos_outside) / found.spread
            };
            let of_kind = |&kind: &SpecularPath| -> f64 {
                let all = kind.connect(&self.ball, self.ior, self.x, y);
                all.iter().map(|found| irradiance(kind, found)).sum()
            };
            self.kinds.iter().map(of_kind).sum::<f64>()
        };
        let grid = (0..POINTS).flat_map(|i| (0..POINTS).map(move |j| (i, j)));
        grid.map(|(i, j)| at(i, j)).sum::<f64>() * area
    }

    /// One path that starts by the cosine, if it is of one of the kinds and ends at the lamp; with
    /// its weight if connections are used, too.
    fn by_chance(&self, u: [f64; 2], choose: impl Fn(u32) -> f64, is_weighted: bool) -> f64 {
        let direction = Frame::from_z(self.normal).to_world(Hemisphere::Cosine.sample(u));
        let mut ray = TracedRay::new(self.x, direction.normalize());
        let start = ray.direction;
        let (mut is_inside, mut cos_outside) = (false, 0.0);
        for step in 0..3 {
            let Some((event, cos)) = self.event(&ray, is_inside, choose(step)) else { return 0.0 };
            let Some(next) = ray.meet(&self.ball, self.ior, event) else { return 0.0 };
            if step == 0 {
                cos_outside = cos;
            }
            (ray, is_inside) = (next, is_inside ^ (event == Event::Refract));
            let kind = match (step, is_inside) {
                (0, false) => SpecularPath::Reflection,
                (0, true) => SpecularPath::Inward,
                (1, false) => SpecularPath::Through,
                (2, false) => SpecularPath::ThroughReflected,
                _ => continue,
            };
            if let Some((normal, y)) = self.lamp_on(kind, &ray) {
                let worth = std::f64::consts::PI * kind.radiance_scale(self.ior);
                let chance = self.chance_density(kind, start, cos_outside);
                let ends = ((self.x, start), (Target::Point(y), -ray.direction));
                let spread = kind.spread((&self.ball, self.ior), ends.0, ends.1);
                let spread = spread.expect("the path exists");
                let density = self.view(kind).density(normal, -ray.direction, spread);
                return worth * if is_weighted { power_heuristic(chance, density) } else { 1.0 };
            }
            if !is_inside {
                break;
            }
        }
        0.0
    }

    /// What happens where the ray meets the ball next, by chance, and the cosine there.
    fn event(&self, ray: &TracedRay, is_inside: bool, u: f64) -> Option<(Event, f64)> {
        let roots = self.ball.roots(ray.origin, ray.direction)?;
        let t = if is_inside { roots.far } else { roots.near };
        let (_, normal) = self.ball.reproject(ray.origin, ray.direction, t);
        let cos = normal.dot(ray.direction).abs().min(1.0);
        let ior = if is_inside { 1.0 / self.ior } else { self.ior };
        let reflects = self.ior == 0.0 || u < reflectance(cos, ior);
        (t > 0.0).then_some((if reflects { Event::Reflect } else { Event::Refract }, cos))
    }

    /// The normal and point where a path of one of the kinds ends at the lamp.
    fn lamp_on(&self, kind: SpecularPath, ray: &TracedRay) -> Option<(DVec3, DVec3)> {
        if !self.kinds.contains(&kind) {
            return None;
        }
        let t = self.lamp.first_root(ray.origin, ray.direction, 0.0, f64::INFINITY)?;
        let (point, normal) = self.lamp.reproject(ray.origin, ray.direction, t);
        Some((normal, point))
    }
}

/// Mean and variance of one sample, and the standard error of the mean of all seeds.
fn estimate(sample: impl Fn(&Sampler) -> f64) -> [f64; 3] {
    let (mut sum, mut squares) = (0.0, 0.0);
    for seed in 0..SEEDS {
        for index in 0..SAMPLES {
            let value = sample(&Sampler::independent(seed.into(), index.into(), 0));
            (sum, squares) = (sum + value, squares + value * value);
        }
    }
    let count = f64::from(SAMPLES * SEEDS);
    let mean = sum / count;
    let variance = squares / count - mean * mean;
    [mean, variance, (variance / count).sqrt()]
}

/// Compares chance, and connection and chance together, with quadrature; returns the ratio of their
/// variances.
fn gain(name: &str, point: &LitPoint, exact: f64) -> f64 {
    let choose = |sampler: &Sampler| {
        let sampler = *sampler;
        move |step| sampler.get(4 + step)
    };
    let [both, small, error] = estimate(|sampler| {
        let by_connection = point.by_connection([sampler.get(0), sampler.get(1)]);
        let u = [sampler.get(2), sampler.get(3)];
        by_connection + point.by_chance(u, choose(sampler), true)
    });
    let [chance, large, chance_error] = estimate(|sampler| {
        point.by_chance([sampler.get(2), sampler.get(3)], choose(sampler), false)
    });
    // A path by chance is worth at most this, which bounds the error if it finds no lamp.
    let worth = std::f64::consts::PI * f64::max(1.0, point.kinds[0].radiance_scale(point.ior));
    let count = f64::from(SEEDS * SAMPLES);
    let chance_error = chance_error.max((exact * worth / count).sqrt());
    let [sigmas, chance_sigmas] = [(both - exact) / error, (chance - exact) / chance_error];
    let is_close = sigmas.abs() < 4.0 && chance_sigmas.abs() < 4.0;
    assert!(is_close, "{name}: {exact:e}, {sigmas} and {chance_sigmas} standard errors");
    large / small
}

/// A lamp with an angular radius in degrees as seen from the centre of a ball.
fn lamp(ball: &Sphere, direction: DVec3, distance: f64, degrees: f64) -> Sphere {
    let radius = distance * sin_cos(degrees.to_radians()).0;
    Sphere { center: ball.center + direction.normalize() * distance, radius }
}

const BALL: Sphere = Sphere { center: DVec3::new(0.0, 1.0, 0.0), radius: 1.0 };

/// Points on the ground beside a ball, lit over it by a lamp.
fn lit_ground(x: [f64; 2], ior: f64, kinds: &'static [SpecularPath], degrees: f64) -> LitPoint {
    LitPoint {
        x: DVec3::new(x[0], 0.0, x[1]),
        normal: DVec3::Y,
        ball: BALL,
        ior,
        lamp: lamp(&BALL, DVec3::new(-1.0, 2.0, 0.3), 20.0, degrees),
        kinds,
    }
}

#[test]
fn one_mirror_ball() {
    let point = |degrees| lit_ground([-1.5, 0.5], 0.0, &[SpecularPath::Reflection], degrees);
    let (wide, small) = (point(20.0), point(1.0));
    assert!(gain("mirror, 20 degrees", &wide, wide.by_directions()) > 300.0);
    assert!(gain("mirror, 1 degree", &small, small.by_lamp()) > 1e6);
}

#[test]
fn one_glass_ball() {
    for (name, x, kinds, gains) in [
        ("reflection", [-1.5, 0.5], &[SpecularPath::Reflection][..], [1e3, 1e6]),
        ("through", [0.7, -0.1], &[SpecularPath::Through], [0.5, 1e5]),
        ("all", [0.55, -0.1], &SpecularPath::OVER_DIELECTRIC, [0.5, 5e3]),
    ] {
        let [wide, small] = [20.0, 1.0].map(|degrees| lit_ground(x, 1.5, kinds, degrees));
        assert!(gain(&format!("{name}, 20 degrees"), &wide, wide.by_directions()) > gains[0]);
        assert!(gain(&format!("{name}, 1 degree"), &small, small.by_lamp()) > gains[1]);
    }
}

/// Within 23 degrees of the lamp, as seen from a glass ball.
#[test]
fn an_inner_reflection_in_a_glass_ball() {
    let point = |degrees| {
        let axis = DVec3::new(-1.0, 2.0, 0.7).normalize();
        let kinds = &[SpecularPath::ThroughReflected];
        let on_ground = lit_ground([0.0, 0.0], 1.5, kinds, degrees);
        LitPoint { x: BALL.center + axis * 4.0, normal: -axis, ..on_ground }
    };
    let (wide, small) = (point(20.0), point(1.0));
    assert!(gain("inner reflection, 20 degrees", &wide, wide.by_directions()) > 10.0);
    assert!(gain("inner reflection, 1 degree", &small, small.by_lamp()) > 1e3);
}

#[test]
fn a_lamp_inside_a_glass_ball() {
    let point = |radius| LitPoint {
        x: DVec3::new(1.5, 0.0, 0.5),
        normal: DVec3::Y,
        ball: BALL,
        ior: 1.5,
        lamp: Sphere { center: BALL.center + DVec3::new(-0.3, 0.2, 0.1), radius },
        kinds: &[SpecularPath::Inward],
    };
    let (wide, small) = (point(0.4), point(0.02));
    assert!(gain("lamp inside, wide", &wide, wide.by_directions()) > 50.0);
    assert!(gain("lamp inside, small", &small, small.by_lamp()) > 1e5);
}
