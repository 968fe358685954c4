//! A single emitter as seen from a shading point: directions and their pdf.

use std::f64::consts::FRAC_1_PI;

use crate::fault::fault;
use crate::geometry::{Cone, ConeSample, ProjectedCap, Side, Sphere, VisibleCap};
use crate::math::{DVec3, Frame};
use crate::sampling::Hemisphere;

use super::context::LightSampleContext;
use super::cut::EmitterCut;

/// An emitter as seen from a point on a surface.
pub(super) enum VisibleEmitter {
    /// Seen from outside: the cone that the emitter subtends.
    Outside(Cone),
    /// Seen from outside and from a Lambertian surface: the cone, by the cosine.
    Projected(ProjectedCap, Cone),
    /// Seen from outside: the cap that a wall does not hide.
    Cap(VisibleCap),
    /// Seen from inside the emitter, where every direction hits it: cosine-weighted, on one side of
    /// a surface or on both.
    Inside { frame: Frame, is_two_sided: bool, point: DVec3, sphere: Sphere },
}

impl VisibleEmitter {
    /// `None` if the emitter is not visible. `cut` is where walls cut it.
    #[inline(always)]
    pub(super) fn new(
        ctx: &LightSampleContext,
        id: u32,
        emitter: &Sphere,
        cut: Option<&EmitterCut>,
    ) -> Option<Self> {
        let LightSampleContext { hit, is_two_sided, is_lambertian } = *ctx;
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
        match cap.filter(|cap| cap.is_narrower_than(&cone)) {
            Some(cap) => Some(Self::Cap(cap)),
            None if is_lambertian => {
                ProjectedCap::new(&cone, hit.facing_normal()).map(|cap| Self::Projected(cap, cone))
            }
            None => Some(Self::Outside(cone)),
        }
    }

    /// Returns the probability of sampling the far wall of an emitter rather than the near one. In
    /// proportion to their light, as both are seen in the same directions.
    pub(super) fn far_wall_pmf(&self, transmittance: f32) -> f64 {
        let transmittance = f64::from(transmittance);
        match self {
            Self::Inside { .. } => 0.0,
            _ => transmittance / (1.0 + transmittance),
        }
    }

    /// Returns true if samples vary in nothing but visibility, at a Lambertian surface: no other
    /// way to find the emitter is needed.
    pub(super) fn is_projected(&self) -> bool {
        matches!(self, Self::Projected(..))
    }

    /// Samples a direction; returns it with the distance and the pdf.
    #[inline(always)]
    pub(super) fn sample(&self, mut u: [f64; 2]) -> (DVec3, f64, f64) {
        match self {
            Self::Outside(cone) => {
                let sample = cone.sample(u);
                (sample.direction, sample.distance, sample.pdf)
            }
            Self::Projected(cap, cone) => {
                let direction = cap.sample(u);
                (direction, cone.distance_along(direction), cap.pdf(direction))
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
            Self::Projected(cap, _) => cap.pdf(direction),
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

/// A sample of an emitter from a Lambertian surface, for loops over lanes.
pub struct LaneLightSample {
    /// The direction, the distance and the pdf, as `VisibleEmitter::sample` returns them.
    pub sample: ConeSample,
    /// True if the emitter is sampled in proportion to the cosine.
    pub is_projected: bool,
    /// True if this is no sample, because the horizon cuts the emitter.
    pub is_cut_by_horizon: bool,
}

/// Samples an emitter by the cosine from a point outside it.
#[inline(always)]
pub fn sample_projected(
    point: DVec3,
    normal: DVec3,
    emitter: &Sphere,
    u: [f64; 2],
) -> LaneLightSample {
    let to_center = emitter.center - point;
    let cone = Cone::from_axis(to_center, to_center.length(), emitter.radius);
    let cap = ProjectedCap::above_horizon(&cone, normal);
    let direction = cap.sample_whole(u);
    let pdf = if cap.is_above_horizon() { cap.pdf(direction) } else { 0.0 };
    let distance = cone.distance_along(direction);
    LaneLightSample {
        sample: ConeSample { direction, distance, pdf },
        is_projected: true,
        is_cut_by_horizon: cap.is_cut_by_horizon(),
    }
}

/// Samples an emitter, which a wall cuts, from a point outside it on the sphere `id`, hit from
/// outside.
#[inline(always)]
pub fn sample_cut_emitter(
    cut: &EmitterCut,
    id: u32,
    (point, normal): (DVec3, DVec3),
    emitter: &Sphere,
    u: [f64; 2],
) -> LaneLightSample {
    let to_center = emitter.center - point;
    let cone = Cone::from_axis(to_center, to_center.length(), emitter.radius);
    let cap = exposed_cap(cut, id, Side::Outside, point, emitter);
    let of_whole = sample_projected(point, normal, emitter, u);
    let is_narrow = cap.is_narrower_than(&cone);
    LaneLightSample {
        sample: if is_narrow { cap.sample(u) } else { of_whole.sample },
        is_projected: !is_narrow,
        is_cut_by_horizon: !is_narrow && of_whole.is_cut_by_horizon,
    }
}

/// Returns 1 (above) or -1 (below) with equal probability, and remaps `u` to `[0, 1)`.
fn sample_side(u: &mut f64) -> f64 {
    let is_below = *u >= 0.5;
    *u = 2.0 * *u - f64::from(u8::from(is_below));
    if is_below { -1.0 } else { 1.0 }
}
