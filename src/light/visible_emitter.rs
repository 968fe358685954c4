//! A single emitter as seen from a shading point: directions and their pdf.

use std::f64::consts::FRAC_1_PI;

use crate::fault::fault;
use crate::geometry::{Cone, ConeSample, ProjectedCap, Side, Sphere, VisibleCap};
use crate::math::{DVec3, Frame};
use crate::sampling::Hemisphere;

use super::context::LightSampleContext;
use super::cut::EmitterCut;
use super::emitter::Emitter;

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
    pub(super) fn far_wall_pmf(&self, emitter: &Emitter) -> f64 {
        let fraction = f64::from(emitter.far_wall_fraction);
        match self {
            Self::Inside { .. } => 0.0,
            _ => fraction / (1.0 + fraction),
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

/// A point on a surface, for loops over lanes.
pub struct LanePoint {
    /// The sphere that it lies on.
    pub id: u32,
    /// The point.
    pub point: DVec3,
    /// The unit normal on the side that was hit.
    pub facing_normal: DVec3,
    /// The side that was hit.
    pub side: Side,
}

/// A sample of an emitter, for loops over lanes.
pub struct LaneLightSample {
    /// The direction, the distance and the pdf, as `VisibleEmitter::sample` returns them; a pdf of
    /// 0 if nothing of the emitter is visible.
    pub sample: ConeSample,
    /// True if the emitter is sampled in proportion to the cosine.
    pub is_projected: bool,
    /// True if this is no sample: from inside the emitter. [`super::Lights::sample`] has to sample
    /// it.
    pub is_missing: bool,
    /// What the horizon of a Lambertian surface makes of the emitter.
    pub horizon: LaneHorizon,
}

/// What the horizon makes of an emitter, for loops over lanes.
#[derive(Clone, Copy)]
pub struct LaneHorizon {
    /// True if the horizon cuts the emitter, so that this is no sample yet:
    /// [`sample_at_horizon`] has to sample it.
    pub is_cut: bool,
    /// True if the emitter's centre is below the horizon.
    pub is_lune: bool,
}

/// Samples an emitter from a point on another sphere; a Lambertian surface samples it by the
/// cosine.
#[inline(always)]
pub fn sample_in_lane<const IS_LAMBERTIAN: bool>(
    at: &LanePoint,
    emitter: &Sphere,
    u: [f64; 2],
) -> LaneLightSample {
    let (cone, is_inside) = cone_in_lane(at, emitter);
    let whole = sample_whole::<IS_LAMBERTIAN>(&cone, at.facing_normal, u);
    LaneLightSample { is_missing: is_inside, ..whole }
}

/// As [`sample_in_lane`], but of an emitter that walls cut.
#[inline(always)]
pub fn sample_cut_in_lane<const IS_LAMBERTIAN: bool>(
    at: &LanePoint,
    emitter: &Sphere,
    cut: &EmitterCut,
    u: [f64; 2],
) -> LaneLightSample {
    let (cone, is_inside) = cone_in_lane(at, emitter);
    let whole = sample_whole::<IS_LAMBERTIAN>(&cone, at.facing_normal, u);
    let cap = exposed_cap(cut, at.id, at.side, at.point, emitter);
    let is_narrow = cap.is_narrower_than(&cone);
    LaneLightSample {
        sample: if is_narrow { cap.sample(u) } else { whole.sample },
        is_projected: whole.is_projected & !is_narrow,
        is_missing: is_inside,
        horizon: LaneHorizon { is_cut: whole.horizon.is_cut & !is_narrow, ..whole.horizon },
    }
}

/// Returns the cone that an emitter subtends, and whether the point is inside, where there is none.
#[inline(always)]
fn cone_in_lane(at: &LanePoint, emitter: &Sphere) -> (Cone, bool) {
    let to_center = emitter.center - at.point;
    let distance = to_center.length();
    let cone = Cone::from_axis(to_center, distance, emitter.radius);
    (cone, distance <= emitter.radius)
}

#[inline(always)]
fn sample_whole<const IS_LAMBERTIAN: bool>(
    cone: &Cone,
    normal: DVec3,
    u: [f64; 2],
) -> LaneLightSample {
    match IS_LAMBERTIAN {
        true => sample_projected(cone, normal, u),
        false => LaneLightSample {
            sample: cone.sample(u),
            is_projected: false,
            is_missing: false,
            horizon: LaneHorizon { is_cut: false, is_lune: false },
        },
    }
}

#[inline(always)]
fn sample_projected(cone: &Cone, normal: DVec3, u: [f64; 2]) -> LaneLightSample {
    let cap = ProjectedCap::above_horizon(cone, normal);
    let direction = cap.sample_whole(u);
    let pdf = if cap.is_above_horizon() { cap.pdf(direction) } else { 0.0 };
    LaneLightSample {
        sample: ConeSample { direction, distance: cone.distance_along(direction), pdf },
        is_projected: true,
        is_missing: false,
        horizon: LaneHorizon { is_cut: cap.is_cut_by_horizon(), is_lune: cap.is_lune() },
    }
}

/// Samples an emitter that the horizon of a Lambertian surface cuts, from a point outside the
/// emitter; as [`LaneHorizon`] tells, with the emitter's centre below the horizon (a lune) or not.
#[inline(always)]
pub fn sample_at_horizon<const IS_LUNE: bool>(
    point: DVec3,
    normal: DVec3,
    emitter: &Sphere,
    u: [f64; 2],
) -> ConeSample {
    let to_center = emitter.center - point;
    let cone = Cone::from_axis(to_center, to_center.length(), emitter.radius);
    let cap = ProjectedCap::at_horizon(&cone, normal);
    let direction = if IS_LUNE { cap.sample_lune(u) } else { cap.sample_cut(u) };
    let pdf = if cap.area() > 0.0 { cap.pdf(direction) } else { 0.0 };
    ConeSample { direction, distance: cone.distance_along(direction), pdf }
}

/// Returns 1 (above) or -1 (below) with equal probability, and remaps `u` to `[0, 1)`.
fn sample_side(u: &mut f64) -> f64 {
    let is_below = *u >= 0.5;
    *u = 2.0 * *u - f64::from(u8::from(is_below));
    if is_below { -1.0 } else { 1.0 }
}
