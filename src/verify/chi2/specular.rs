//! Specular connections over a ball: the directions in which they leave x, against their density.

use std::f64::consts::TAU;
use std::sync::Arc;

use crate::geometry::Sphere;
use crate::light::specular::{EmitterView, MAX_CONNECTIONS, SpecularPath, Target};
use crate::math::{DVec3, Frame};
use crate::sampling::{atan2, sin_cos};

use super::SamplingTest;
use super::sampling_test::polar;

pub(super) fn tests() -> Vec<SamplingTest> {
    let beside = DVec3::new(-2.5, 0.5, 1.0);
    let [above, aside] = [DVec3::new(0.3, 0.2, 4.0), DVec3::new(-3.0, 1.0, 4.0)];
    vec![
        connection("off a ball", SpecularPath::Reflection, beside, lamp(above)),
        connection(
            "through glass",
            SpecularPath::Through,
            DVec3::new(0.6, -0.2, -2.0),
            lamp(above),
        ),
        connection("through glass, reflected", SpecularPath::ThroughReflected, aside, lamp(above)),
        connection("out of glass", SpecularPath::Outward, DVec3::new(0.1, 0.3, -0.5), lamp(above)),
        connection("into glass", SpecularPath::Inward, beside, inner_lamp()),
    ]
}

fn lamp(center: DVec3) -> Sphere {
    Sphere { center, radius: 1.2 }
}

fn inner_lamp() -> Sphere {
    Sphere { center: DVec3::new(0.2, 0.1, -0.3), radius: 0.4 }
}

/// A glass ball of radius 1 around the origin, a point x and a lamp.
struct LitBall {
    kind: SpecularPath,
    x: DVec3,
    lamp: Sphere,
    view: EmitterView,
}

const BALL: Sphere = Sphere { center: DVec3::ZERO, radius: 1.0 };
const IOR: f64 = 1.5;

/// Connections of one kind from x to a lamp, of which one is drawn, in polar coordinates around
/// their mean direction.
fn connection(name: &str, kind: SpecularPath, x: DVec3, lamp: Sphere) -> SamplingTest {
    let view = match kind {
        SpecularPath::Inward => EmitterView::through_boundary(&BALL, IOR, x, &lamp),
        _ => EmitterView::from_ball(&BALL, &lamp),
    };
    let scene = Arc::new(LitBall { kind, x, lamp, view: view.expect("the lamp is seen") });
    let (axis, widest) = scene.image();
    let frame = Frame::from_z(axis);
    let density = scene.clone();
    SamplingTest::over_rectangle(
        format!("connection {name}"),
        [[0.0, 0.0], [widest, TAU]],
        move |u| Some(polar(frame.to_local(scene.sample(u)?))),
        move |[theta, phi]| {
            let ((sin, cos), (sin_phi, cos_phi)) = (sin_cos(theta), sin_cos(phi));
            let direction = frame.to_world(DVec3::new(sin * cos_phi, sin * sin_phi, cos));
            density.pdf(direction) * sin
        },
    )
    .with_discontinuities()
}

impl LitBall {
    /// A cone around all directions in which connections leave x, by its axis and half angle, with
    /// some room.
    fn image(&self) -> (DVec3, f64) {
        let at = |i: u32| (f64::from(i) + 0.5) / 40.0;
        let grid = (0..4).flat_map(|k| (0..1600).map(move |i| [i / 40, i % 40, k]));
        let directions: Vec<DVec3> = grid
            .filter_map(|[i, j, k]| self.sample([at(i), at(j), (f64::from(k) + 0.5) / 4.0, 0.0]))
            .collect();
        let axis = directions.iter().sum::<DVec3>().normalize();
        let angle = |w: &DVec3| atan2(axis.cross(*w).length(), axis.dot(*w));
        let widest = directions.iter().map(angle).fold(0.0, f64::max);
        (axis, 1.1 * widest)
    }

    /// Draws a point of the lamp and one of its connections.
    fn sample(&self, u: [f64; 4]) -> Option<DVec3> {
        let at = self.view.sample([u[0], u[1]]);
        let all = self.kind.connect(&BALL, IOR, self.x, Target::Point(at.point));
        let found = all.get((u[2] * MAX_CONNECTIONS as f64) as usize)?;
        (at.normal.dot(found.direction_at_y) > 0.0).then_some(found.direction_at_x)
    }

    /// The density of a direction, by the ray that is traced in it.
    fn pdf(&self, direction: DVec3) -> f64 {
        let traced = match self.kind {
            SpecularPath::Reflection => trace(self.x, direction, &[false]),
            SpecularPath::Through => trace(self.x, direction, &[true, true]),
            SpecularPath::ThroughReflected => trace(self.x, direction, &[true, false, true]),
            SpecularPath::Outward | SpecularPath::Inward => trace(self.x, direction, &[true]),
        };
        let hit = traced.and_then(|(origin, last)| {
            let t = self.lamp.first_root(origin, last, 0.0, f64::INFINITY)?;
            Some((self.lamp.reproject(origin, last, t), last))
        });
        let Some(((point, normal), last)) = hit else { return 0.0 };
        let ends = ((self.x, direction), (Target::Point(point), -last));
        let spread = self.kind.spread((&BALL, IOR), ends.0, ends.1).unwrap_or(0.0);
        self.view.density(normal, -last, spread) / MAX_CONNECTIONS as f64
    }
}

/// Traces a ray at the ball, refracted (true) or reflected at each point; `None` if it misses or is
/// reflected totally.
fn trace(mut origin: DVec3, mut direction: DVec3, refracts: &[bool]) -> Option<(DVec3, DVec3)> {
    let mut is_inside = BALL.contains(origin);
    for &refracts in refracts {
        let roots = BALL.roots(origin, direction)?;
        let t = if is_inside { roots.far } else { roots.near };
        let (point, outward) = BALL.reproject(origin, direction, t);
        if t <= 0.0 {
            return None;
        }
        let (normal, eta) = if is_inside { (-outward, IOR) } else { (outward, 1.0 / IOR) };
        let cos = -direction.dot(normal);
        let cos_squared = 1.0 - eta * eta * (1.0 - cos * cos);
        if refracts && cos_squared <= 0.0 {
            return None;
        }
        direction = match refracts {
            true => direction * eta + normal * (eta * cos - cos_squared.sqrt()),
            false => direction + normal * (2.0 * cos),
        }
        .normalize();
        (origin, is_inside) = (point, is_inside ^ refracts);
    }
    Some((origin, direction))
}
