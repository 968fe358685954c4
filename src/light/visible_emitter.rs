//! A single emitter as seen from a shading point: directions and their pdf.

use std::f64::consts::FRAC_1_PI;

use crate::fault::fault;
use crate::geometry::{Cone, ConeSample, Side, Sphere, VisibleCap};
use crate::math::{DVec3, Frame};
use crate::sampling::Hemisphere;

use super::context::LightSampleContext;
use super::cut::EmitterCut;

/// An emitter as seen from a point on a surface.
pub(super) enum VisibleEmitter {
    /// Seen from outside: the cone that the emitter subtends.
    Outside(Cone),
    /// Seen from outside: the cap that a wall does not hide.
    Cap(VisibleCap),
    /// Seen from inside the emitter, where every direction hits it: cosine-weighted, on one side of
    /// a surface or on both.
    Inside { frame: Frame, is_two_sided: bool, point: DVec3, sphere: Sphere },
}

impl VisibleEmitter {
    /// `None` if the emitter is not visible. `cut` is where walls cut it.
    pub(super) fn new(
        ctx: &LightSampleContext,
        id: u32,
        emitter: &Sphere,
        cut: Option<&EmitterCut>,
    ) -> Option<Self> {
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
        let cone = Cone::subtending(hit.point, emitter)?;
        let cap = cut.map(|cut| exposed_cap(cut, hit.id, hit.side, hit.point, emitter));
        let narrow = cap.filter(|cap| cap.is_narrower_than(cone.solid_angle()));
        Some(narrow.map_or(Self::Outside(cone), Self::Cap))
    }

    /// Returns the probability of sampling the far wall of an emitter rather than the near one. In
    /// proportion to their light, as both are seen in the same directions.
    pub(super) fn far_wall_pmf(&self, transmittance: f32) -> f64 {
        let transmittance = f64::from(transmittance);
        match self {
            Self::Inside { .. } => 0.0,
            Self::Outside(_) | Self::Cap(_) => transmittance / (1.0 + transmittance),
        }
    }

    /// Samples a direction; returns it with the distance and the pdf.
    pub(super) fn sample(&self, mut u: [f64; 2]) -> (DVec3, f64, f64) {
        match self {
            Self::Outside(cone) => {
                let sample = cone.sample(u);
                (sample.direction, sample.distance, sample.pdf)
            }
            Self::Cap(cap) => {
                let sample = cap.sample(u);
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
            Self::Cap(cap) => cap.pdf(direction),
            Self::Inside { frame, is_two_sided: true, .. } => {
                0.5 * FRAC_1_PI * direction.dot(frame.z).abs()
            }
            Self::Inside { .. } if fault!(InsideEmitterPdfWithoutCosine) => 0.5 * FRAC_1_PI,
            Self::Inside { frame, .. } => FRAC_1_PI * direction.dot(frame.z).max(0.0),
        }
    }
}

/// Returns the cap of an emitter that its cut leaves exposed to a point.
#[inline(always)]
fn exposed_cap(
    cut: &EmitterCut,
    id: u32,
    hit_side: Side,
    point: DVec3,
    emitter: &Sphere,
) -> VisibleCap {
    cut.exposed_cap(id, point, hit_side).seen_from(point, emitter)
}

/// Samples a direction to an emitter, which a wall cuts, from a point outside it on the sphere
/// `id`, hit from outside; as [`VisibleEmitter::sample`] does, for loops over lanes.
#[inline(always)]
pub fn sample_cut_emitter(
    cut: &EmitterCut,
    id: u32,
    point: DVec3,
    emitter: &Sphere,
    u: [f64; 2],
) -> ConeSample {
    let to_center = emitter.center - point;
    let cone = Cone::from_axis(to_center, to_center.length(), emitter.radius);
    let cap = exposed_cap(cut, id, Side::Outside, point, emitter);
    let (from_cone, from_cap) = (cone.sample(u), cap.sample(u));
    if cap.is_narrower_than(cone.solid_angle()) { from_cap } else { from_cone }
}

/// Returns 1 (above) or -1 (below) with equal probability, and remaps `u` to `[0, 1)`.
fn sample_side(u: &mut f64) -> f64 {
    let is_below = *u >= 0.5;
    *u = 2.0 * *u - f64::from(u8::from(is_below));
    if is_below { -1.0 } else { 1.0 }
}
