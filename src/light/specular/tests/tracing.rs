//! Every connection, traced again, arrives, and its spread is that of the traced ray's derivatives.

use crate::geometry::Sphere;
use crate::math::DVec3;
use crate::sampling::{Sampler, exp, hemisphere, ln};

use super::super::{Connection, SpecularPath, Target};
use super::traced_ray::{Event, TracedRay};

/// Random configurations of each kind.
const CONFIGURATIONS: u32 = 20_000;
/// Cosine of an angle of incidence below which rounding moves a traced ray too far.
const GRAZING: f64 = 1e-4;

/// A random ball with random points.
pub(super) struct Configuration {
    pub(super) ball: Sphere,
    pub(super) ior: f64,
    /// Points outside, from 1e-4 to 1e3 radii away from the surface.
    pub(super) outside: [DVec3; 2],
    pub(super) inside: DVec3,
    pub(super) direction: DVec3,
}

impl Configuration {
    pub(super) fn new(index: u32) -> Self {
        let sampler = Sampler::independent(5, index.into(), 0);
        let u = |d: u32| sampler.get(d);
        let direction = |d: u32| unit_vector([u(d), u(d + 1)]);
        let log = |u: f64, low: f64, high: f64| exp(ln(low) + u * (ln(high) - ln(low)));
        let radius = log(u(0), 0.01, 100.0);
        let center = (DVec3::new(u(1), u(2), u(3)) - 0.5) * 10.0;
        let x = direction(5);
        // Half of the others are near the axis, opposite of x or on its side.
        let axis = [DVec3::ZERO, -x, DVec3::ZERO, x][index as usize % 4];
        let other = |d: u32| match axis == DVec3::ZERO {
            true => direction(d),
            false => (axis + direction(d) * log(u(16), 1e-4, 0.5)).normalize(),
        };
        let at_distance =
            |axis: DVec3, u: f64| center + axis * (radius * (1.0 + log(u, 1e-4, 1e3)));
        Self {
            ball: Sphere { center, radius },
            ior: if index % 5 == 0 { log(u(4), 0.3, 0.98) } else { log(u(4), 1.02, 4.0) },
            outside: [at_distance(x, u(7)), at_distance(other(8), u(10))],
            inside: center + x * (radius * u(13)),
            direction: other(14),
        }
    }

    pub(super) fn targets(&self) -> [Target; 2] {
        [Target::Point(self.outside[1]), Target::Direction(self.direction)]
    }
}

fn unit_vector(u: [f64; 2]) -> DVec3 {
    let upper = hemisphere::sample_uniform_cone(2.0, u);
    upper.normalize()
}

const ALL: [SpecularPath; 5] = [
    SpecularPath::Reflection,
    SpecularPath::Through,
    SpecularPath::ThroughReflected,
    SpecularPath::Outward,
    SpecularPath::Inward,
];

/// What happens along a path.
pub(super) fn events_of(kind: SpecularPath) -> &'static [Event] {
    match kind {
        SpecularPath::Reflection => &[Event::Reflect],
        SpecularPath::Through => &[Event::Refract, Event::Refract],
        SpecularPath::ThroughReflected => &[Event::Refract, Event::Reflect, Event::Refract],
        SpecularPath::Outward | SpecularPath::Inward => &[Event::Refract],
    }
}

/// Largest errors of many connections.
#[derive(Debug, Default)]
struct Worst {
    count: usize,
    miss: f64,
    spread: f64,
    leg: f64,
}

impl Worst {
    fn check(
        &mut self,
        connection: &Connection,
        kind: SpecularPath,
        (ball, ior): (&Sphere, f64),
        (x, y): (DVec3, Target),
    ) {
        self.count += 1;
        let cosines = [connection.cos_outside, connection.cos_inside];
        if cosines.iter().any(|&cos| cos > 0.0 && cos < GRAZING) {
            return;
        }
        let ray =
            TracedRay::along(connection, ball, ior, x, events_of(kind)).expect("the path exists");
        self.miss = self.miss.max(ray.miss(ball, y));
        let traced = ray.spread(y);
        // At a caustic the traced derivatives cancel, too: there, compared with a straight path.
        let length = match y {
            Target::Point(_) => connection.leg_at_x + connection.chord + connection.leg_at_y,
            Target::Direction(_) => 1.0,
        };
        let scale = traced + 1e-4 * length * length;
        self.spread = self.spread.max((connection.spread - traced).abs() / scale);
        let last = *connection.points().last().expect("at least one");
        self.leg = self.leg.max(last.distance(ray.origin) / ball.radius);
        if let Target::Point(y) = y {
            let back = last - y;
            let off = back.cross(connection.direction_at_y).length() / y.distance(ball.center);
            self.miss = self.miss.max(off);
            self.leg = self.leg.max((back.length() - connection.leg_at_y).abs() / length);
        }
        let first = connection.points()[0] - x;
        let distance = x.distance(ball.center);
        self.leg = self.leg.max((first.length() - connection.leg_at_x).abs() / distance);
        for pair in connection.points().windows(2) {
            self.leg =
                self.leg.max((pair[0].distance(pair[1]) - connection.chord).abs() / ball.radius);
        }
    }

    #[track_caller]
    fn assert(&self, min_count: usize) {
        let Self { count, miss, spread, leg } = *self;
        assert!(count >= min_count, "{self:?}");
        assert!(miss < 1e-9 && leg < 1e-9 && spread < 1e-5, "{self:?}");
    }
}

/// The largest errors of all connections of a kind, over points inside or outside.
fn worst(kind: SpecularPath) -> Worst {
    let mut worst = Worst::default();
    for index in 0..CONFIGURATIONS {
        let configuration = Configuration::new(index);
        let Configuration { ball, ior, inside, outside: [outside, y], .. } = configuration;
        let [a, b] = configuration.targets();
        let (x, targets) = match kind {
            SpecularPath::Outward => (inside, [a, b]),
            SpecularPath::Inward => (y, [Target::Point(inside); 2]),
            _ => (outside, [a, b]),
        };
        for y in targets {
            for found in kind.connect(&ball, ior, x, y).iter() {
                worst.check(found, kind, (&ball, ior), (x, y));
            }
        }
    }
    worst
}

#[test]
fn connections_arrive_and_spread_as_traced_rays_do() {
    worst(SpecularPath::Reflection).assert(23_000);
    worst(SpecularPath::Through).assert(21_000);
    worst(SpecularPath::ThroughReflected).assert(33_000);
    worst(SpecularPath::Outward).assert(37_000);
    worst(SpecularPath::Inward).assert(37_000);
}

#[test]
fn directions_have_the_spread_of_their_connection() {
    for kind in ALL {
        let mut off = 0.0f64;
        for index in 0..2000 {
            let configuration = Configuration::new(index);
            let Configuration { ball, ior, inside, outside: [outside, y], .. } = configuration;
            let (x, y) = match kind {
                SpecularPath::Outward => (inside, Target::Point(y)),
                SpecularPath::Inward => (y, Target::Point(inside)),
                _ => (outside, Target::Point(y)),
            };
            for found in kind.connect(&ball, ior, x, y).iter() {
                let ends = ((x, found.direction_at_x), (y, found.direction_at_y));
                let spread = kind.spread((&ball, ior), ends.0, ends.1).expect("the path exists");
                let length = found.leg_at_x + found.chord + found.leg_at_y;
                let is_grazing = found.cos_outside < GRAZING;
                let scale = spread + 1e-4 * length * length;
                if !is_grazing {
                    off = off.max((spread - found.spread).abs() / scale);
                }
            }
        }
        assert!(off < 1e-5, "{kind:?}: {off}");
    }
}
