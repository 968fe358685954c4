//! Sampling a single emitter from a shading point: directions and their pdf.

use std::f64::consts::FRAC_1_PI;

use crate::color::Rgb;
use crate::fault::fault;
use crate::geometry::{Cone, Side, Sphere};
use crate::math::{DVec3, Frame};
use crate::sampling::Hemisphere;

use super::context::LightSampleContext;

/// An emissive sphere.
#[derive(Clone, Copy, Debug)]
pub struct Emitter {
    /// The sphere's id.
    pub id: u32,
    /// Emitted radiance.
    pub emission: Rgb,
}

/// An emitter as seen from a point on a surface.
pub(super) enum VisibleEmitter {
    /// Seen from outside: the cone that the emitter subtends.
    Outside(Cone),
    /// Seen from inside the emitter, where every direction hits it: cosine-weighted, on one side of
    /// a surface or on both.
    Inside { frame: Frame, is_two_sided: bool, point: DVec3, sphere: Sphere },
}

impl VisibleEmitter {
    /// `None` if the emitter is not visible.
    pub(super) fn new(ctx: &LightSampleContext, id: u32, emitter: &Sphere) -> Option<Self> {
        let LightSampleContext { hit, is_two_sided } = *ctx;
        let inside = |normal, is_two_sided| {
            let frame = Frame::from_z(normal);
            Some(Self::Inside { frame, is_two_sided, point: hit.point, sphere: *emitter })
        };
        if hit.id == id {
            // A surface can see itself only across the sphere's inside.
            let sees_itself = is_two_sided || hit.side == Side::Inside;
            return if sees_itself { inside(-hit.normal, false) } else { None };
        }
        if emitter.contains(hit.point) {
            return inside(hit.facing_normal(), is_two_sided);
        }
        Cone::subtending(hit.point, emitter).map(Self::Outside)
    }

    /// Samples a direction; returns it with the distance and the pdf.
    pub(super) fn sample(&self, mut u: [f64; 2]) -> (DVec3, f64, f64) {
        match self {
            Self::Outside(cone) => {
                let sample = cone.sample(u);
                (sample.direction, sample.distance, sample.pdf)
            }
            Self::Inside { frame, is_two_sided, point, sphere: emitter } => {
                let side = if *is_two_sided { sample_side(&mut u[0]) } else { 1.0 };
                let local = Hemisphere::Cosine.sample(u) * DVec3::new(1.0, 1.0, side);
                let direction = frame.to_world(local).normalize();
                let distance = emitter.roots(*point, direction).map_or(0.0, |roots| roots.far);
                (direction, distance, self.pdf(direction))
            }
        }
    }

    /// Returns the pdf of a direction that hits the emitter.
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

/// Returns 1 (above) or -1 (below) with equal probability, and remaps `u` to `[0, 1)`.
fn sample_side(u: &mut f64) -> f64 {
    let is_below = *u >= 0.5;
    *u = 2.0 * *u - f64::from(u8::from(is_below));
    if is_below { -1.0 } else { 1.0 }
}
