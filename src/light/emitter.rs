//! One lamp, seen from a point: the directions in which it is aimed at, with their density.

use std::f64::consts::FRAC_1_PI;

use crate::color::Rgb;
use crate::fault::fault;
use crate::geometry::{Cone, Side, Sphere};
use crate::math::{DVec3, Frame};
use crate::sampling::Hemisphere;

use super::receiver::LightSampleContext;

/// An emissive sphere.
#[derive(Clone, Copy, Debug)]
pub struct Emitter {
    /// The sphere's id.
    pub id: u32,
    /// The radiance it sends out.
    pub emission: Rgb,
}

/// How a lamp is seen from a point on a surface.
pub(super) enum VisibleEmitter {
    /// From outside: the cone that the lamp fills.
    Outside(Cone),
    /// From inside the lamp, where every direction meets it: by the cosine, on one side of a surface
    /// or on both.
    Inside { frame: Frame, is_two_sided: bool, point: DVec3, sphere: Sphere },
}

impl VisibleEmitter {
    /// `None` where the lamp cannot be seen.
    pub(super) fn new(from: &LightSampleContext, id: u32, lamp: &Sphere) -> Option<Self> {
        let LightSampleContext { hit, is_two_sided } = *from;
        let inside = |normal, is_two_sided| {
            let frame = Frame::from_z(normal);
            Some(Self::Inside { frame, is_two_sided, point: hit.point, sphere: *lamp })
        };
        if hit.id == id {
            // A surface sees itself only across its inside.
            let sees_itself = is_two_sided || hit.side == Side::Inside;
            return if sees_itself { inside(-hit.normal, false) } else { None };
        }
        if lamp.contains(hit.point) {
            return inside(hit.facing_normal(), is_two_sided);
        }
        Cone::subtending(hit.point, lamp).map(Self::Outside)
    }

    /// Direction, distance and density.
    pub(super) fn sample(&self, mut u: [f64; 2]) -> (DVec3, f64, f64) {
        match self {
            Self::Outside(cone) => {
                let sample = cone.sample(u);
                (sample.direction, sample.distance, sample.pdf)
            }
            Self::Inside { frame, is_two_sided, point, sphere: lamp } => {
                let side = if *is_two_sided { sample_side(&mut u[0]) } else { 1.0 };
                let local = Hemisphere::Cosine.sample(u) * DVec3::new(1.0, 1.0, side);
                let direction = frame.to_world(local).normalize();
                let distance = lamp.roots(*point, direction).map_or(0.0, |roots| roots.far);
                (direction, distance, self.pdf(direction))
            }
        }
    }

    /// The density of a direction that meets the lamp.
    pub(super) fn pdf(&self, direction: DVec3) -> f64 {
        match self {
            Self::Outside(cone) => cone.pdf(),
            Self::Inside { frame, is_two_sided: true, .. } => {
                0.5 * FRAC_1_PI * direction.dot(frame.z).abs()
            }
            Self::Inside { .. } if fault!(InsideEmitterPdfWithoutCosine) => 0.5 * FRAC_1_PI,
            Self::Inside { frame, .. } => FRAC_1_PI * direction.dot(frame.z).max(0.0),
        }
    }
}

/// Above (1) or below (-1), alike; what is left of `u` is again uniform.
fn sample_side(u: &mut f64) -> f64 {
    let is_below = *u >= 0.5;
    *u = 2.0 * *u - f64::from(u8::from(is_below));
    if is_below { -1.0 } else { 1.0 }
}
