//! The cap of directions in which a sphere is seen, sampled in proportion to the cosine at a
//! surface: uniformly over its *projected* solid angle.
//!
//! Seen from above, directions over the horizon are the points of a unit disc, and the cosine
//! times solid angle is the area there. The cap's rim projects to an ellipse. With the angle a
//! between axis and rim and the angle t between normal and axis, its semi-axes are `sin a` and `sin
//! a cos t`, and its middle lies `cos a sin t` from that of the disc, in the direction of the axis:
//! x here. Three cases:
//!
//! - The rim is above the horizon: the cap projects to the whole ellipse.
//! - The horizon cuts the cap, with the axis above it: a part of the ellipse up to the chord where
//!   it touches the disc, and behind that the segment of the disc.
//! - The axis is below the horizon: the segment of the disc less that of the ellipse, a lune.
//!
//! Urena and Georgiev 2018, "Stratified Sampling of Projected Spherical Caps"; Peters and
//! Dachsbacher 2019, "Sampling Projected Spherical Caps in Real Time".

use std::f64::consts::PI;

use crate::fault::fault;
use crate::math::{DVec3, Frame, renormalize};
use crate::sampling::{DiskPoint, one_minus_cos_of_segment, sample_disk, segment_area};

use super::Cone;

/// Below this tilt of the axis against the normal, its azimuth has no digits left.
const MIN_TILT: f64 = 1e-8;
/// A lune whose chord is shorter than this part of the ellipse is left to BSDF sampling: less than
/// 1e-14 of the ellipse's area, without digits.
const MIN_CHORD: f64 = 1e-3;

/// The part above the horizon of the cap of directions in which a sphere is seen from a surface.
#[derive(Clone, Copy, Debug)]
pub struct ProjectedCap {
    /// The surface's normal, and the tangent towards the axis.
    normal: DVec3,
    tangent: DVec3,
    /// Middle of the ellipse.
    middle: DVec3,
    ellipse: Ellipse,
    /// Where the horizon cuts the cap; only then.
    chord: Chord,
    /// Areas of the part of the ellipse and of the segment behind it, or of the lune alone.
    areas: [f64; 2],
}

/// The angles of a cap, and what the horizon makes of it.
#[derive(Clone, Copy, Debug)]
struct Ellipse {
    /// Of the angle between axis and rim.
    sin_rim: f64,
    cos_rim: f64,
    /// Of the angle between normal and axis.
    sin_axis: f64,
    cos_axis: f64,
}

/// The chord between the points where the ellipse touches the disc.
#[derive(Clone, Copy, Debug, Default)]
struct Chord {
    /// Half-angle at the centre of the disc.
    sin_disc: f64,
    cos_disc: f64,
    /// Half-angle at the centre of the ellipse, scaled to a disc, on the horizon's side.
    sin_ellipse: f64,
    cos_ellipse: f64,
    /// Areas of the disc's segment behind the chord, and of the ellipse's, as a part of pi.
    disc_segment: f64,
    ellipse_segment: f64,
}

impl Ellipse {
    /// Returns true if the whole cap is above the horizon.
    #[inline(always)]
    fn is_above_horizon(&self) -> bool {
        self.cos_axis >= self.sin_rim
    }

    /// Area of the whole ellipse.
    #[inline(always)]
    fn area(&self) -> f64 {
        PI * self.sin_rim * self.sin_rim * self.cos_axis.abs()
    }

    /// Returns the chord; the horizon must cut the cap.
    #[inline(always)]
    fn chord(&self) -> Chord {
        let Self { sin_rim, cos_rim, sin_axis, cos_axis } = *self;
        let above = (sin_rim - cos_axis) * (sin_rim + cos_axis);
        let sin_disc = (above.max(0.0).sqrt() / sin_axis).min(1.0);
        let cos_disc = (cos_rim / sin_axis).min(1.0);
        let sin_ellipse = (sin_disc / sin_rim).min(1.0);
        let cos_ellipse = (cos_axis.abs() * cos_disc / sin_rim).min(1.0);
        Chord {
            sin_disc,
            cos_disc,
            sin_ellipse,
            cos_ellipse,
            disc_segment: segment_area(sin_disc, cos_disc),
            ellipse_segment: segment_area(sin_ellipse, cos_ellipse),
        }
    }
}

impl ProjectedCap {
    /// Returns the projection of a cone on a surface with this normal; `None` if nothing of it, or
    /// hardly anything, is above the horizon.
    #[inline(always)]
    pub fn new(cone: &Cone, normal: DVec3) -> Option<Self> {
        let cap = Self::above_horizon(cone, normal);
        if cap.is_above_horizon() {
            return Some(cap);
        }
        if !cap.is_cut_by_horizon() {
            return None;
        }
        let cap = Self::at_horizon(cone, normal);
        (cap.area() > 0.0).then_some(cap)
    }

    /// Returns the projection of a cone that the horizon cuts; of area 0 if hardly anything of it
    /// is above.
    #[inline(always)]
    pub fn at_horizon(cone: &Cone, normal: DVec3) -> Self {
        let cap = Self::above_horizon(cone, normal);
        let Ellipse { sin_rim, cos_axis, .. } = cap.ellipse;
        let chord = cap.ellipse.chord();
        let of_ellipse = sin_rim * sin_rim * cos_axis.abs();
        let lune = chord.disc_segment - of_ellipse * chord.ellipse_segment;
        let lune = if chord.sin_ellipse >= MIN_CHORD { lune } else { 0.0 };
        let parts = [of_ellipse * (PI - chord.ellipse_segment), chord.disc_segment];
        Self { areas: if cap.is_lune() { [0.0, lune] } else { parts }, chord, ..cap }
    }

    /// Returns the projection of a cone if all of it is above the horizon, which
    /// [`Self::is_above_horizon`] tells.
    #[inline(always)]
    pub fn above_horizon(cone: &Cone, normal: DVec3) -> Self {
        let (axis, [sin_rim, cos_rim]) = (cone.axis(), cone.sin_cos_max());
        let cos_axis = axis.dot(normal);
        let along = axis - normal * cos_axis;
        let sin_axis = along.length();
        let is_tilted = sin_axis > MIN_TILT;
        let any = Frame::from_z(normal).x;
        let tangent = if is_tilted { along / sin_axis } else { any };
        let ellipse = Ellipse { sin_rim, cos_rim, sin_axis, cos_axis };
        let (middle, chord) = (along * cos_rim, Chord::default());
        Self { normal, tangent, middle, ellipse, chord, areas: [ellipse.area(), 0.0] }
    }

    /// Returns true if the horizon does not cut the cap.
    #[inline(always)]
    pub fn is_above_horizon(&self) -> bool {
        self.ellipse.is_above_horizon()
    }

    /// Returns true if a part of the cap is above the horizon and a part is below it.
    #[inline(always)]
    pub fn is_cut_by_horizon(&self) -> bool {
        let Ellipse { sin_rim, cos_axis, .. } = self.ellipse;
        cos_axis < sin_rim && cos_axis > -sin_rim
    }

    /// Returns true if the axis is below the horizon: of a cap that the horizon cuts, a lune
    /// remains.
    #[inline(always)]
    pub fn is_lune(&self) -> bool {
        self.ellipse.cos_axis <= 0.0
    }

    /// Projected solid angle of what is above the horizon.
    #[inline(always)]
    pub fn area(&self) -> f64 {
        self.areas[0] + self.areas[1]
    }

    /// Returns the pdf per solid angle of [`Self::sample`] for a direction in the cap: the cosine
    /// over the projected solid angle.
    #[inline(always)]
    pub fn pdf(&self, direction: DVec3) -> f64 {
        let cos = if fault!(ProjectedCapUniform) { 0.5 } else { direction.dot(self.normal) };
        cos.max(0.0) / self.area()
    }

    /// Samples a direction in proportion to its cosine, from `u` in `[0, 1)^2`.
    #[inline(always)]
    pub fn sample(&self, u: [f64; 2]) -> DVec3 {
        if self.is_above_horizon() {
            return self.sample_whole(u);
        }
        if self.is_lune() { self.sample_lune(u) } else { self.sample_cut(u) }
    }

    /// Samples a cap that is above the horizon.
    #[inline(always)]
    pub fn sample_whole(&self, u: [f64; 2]) -> DVec3 {
        let DiskPoint { point, inside, .. } = sample_disk(u);
        self.over_ellipse(point, inside)
    }

    /// Samples a cap that the horizon cuts, with the axis above it: in order along x, first the
    /// ellipse, then the segment behind the chord.
    #[inline(always)]
    pub fn sample_cut(&self, u: [f64; 2]) -> DVec3 {
        let (chord, [of_ellipse, of_segment]) = (&self.chord, self.areas);
        let area = u[0] * (of_ellipse + of_segment);
        let across = 2.0 * u[1] - 1.0;
        let flat = (1.0 - across * across).max(0.0);
        let is_in_ellipse = area < of_ellipse;
        let share = area / of_ellipse * (PI - chord.ellipse_segment);
        let behind = (1.0 - (area - of_ellipse) / of_segment).max(0.0) * chord.disc_segment;
        let from_end = one_minus_cos_of_segment(if is_in_ellipse { share } else { behind });
        let sin_squared = from_end * (2.0 - from_end);
        let sin = sin_squared.max(0.0).sqrt();
        let in_ellipse = self.over_ellipse([from_end - 1.0, across * sin], sin_squared * flat);
        let in_segment = self.to_world([1.0 - from_end, across * sin], sin * flat.sqrt());
        if is_in_ellipse { in_ellipse } else { in_segment }
    }

    /// Samples a lune: y from the area up to it, by Newton's method, then x.
    #[inline(always)]
    pub fn sample_lune(&self, u: [f64; 2]) -> DVec3 {
        let signed = 2.0 * u[0] - 1.0;
        let target = (1.0 - signed.abs()).sqrt();
        let mut y = self.chord.sin_disc * (1.0 - target);
        // Three steps, written out for loops over lanes: from this start, they reach 1e-6 of the
        // area for every lune, and 1e-8 for most.
        y = self.step_in_lune(y, target);
        y = self.step_in_lune(y, target);
        y = self.step_in_lune(y, target);
        let width = self.lune_up_to(y)[1].max(0.0);
        let right = ((1.0 - y) * (1.0 + y)).sqrt();
        let inward = u[1] * width;
        let z = (inward * (2.0 * right - inward)).max(0.0).sqrt();
        self.to_world([right - inward, y.copysign(signed)], z)
    }

    /// Returns a better y, beyond which the part `target^2` of a lune lies: by a step of Newton's
    /// method for the root of the area beyond y, which is nearly linear in y.
    #[inline(always)]
    fn step_in_lune(&self, y: f64, target: f64) -> f64 {
        let [area, width] = self.lune_up_to(y);
        let beyond = (1.0 - area / self.area()).max(0.0).sqrt();
        let slope = width / (beyond * self.area());
        let step = (beyond - target) / slope;
        let next = if slope > 0.0 { y + step } else { y };
        next.max(0.0).min(self.chord.sin_disc * (1.0 - 1e-12))
    }

    /// Returns the area of a lune between `-y` and `y`, and its width at `y`.
    #[inline(always)]
    fn lune_up_to(&self, y: f64) -> [f64; 2] {
        let (Ellipse { sin_rim, cos_axis, .. }, chord) = (self.ellipse, &self.chord);
        // The segment behind the chord at y and what is beside it; `cos - cos` without cancelling.
        let segment = |sin: f64, sin_end: f64, cos_end: f64| {
            let cos = ((1.0 - sin) * (1.0 + sin)).max(0.0).sqrt();
            let width = (sin_end - sin) * (sin_end + sin) / (cos + cos_end);
            [segment_area(sin, cos) + 2.0 * sin * width, width]
        };
        let disc = segment(y, chord.sin_disc, chord.cos_disc);
        let of_ellipse = (y / sin_rim).min(chord.sin_ellipse);
        let ellipse = segment(of_ellipse, chord.sin_ellipse, chord.cos_ellipse);
        let semi_axis = sin_rim * cos_axis.abs();
        [disc[0] - semi_axis * sin_rim * ellipse[0], disc[1] - semi_axis * ellipse[1]]
    }

    /// Returns the direction above a point of the ellipse, scaled to the unit disc; `inside` is 1
    /// less its squared distance from the middle.
    #[inline(always)]
    fn over_ellipse(&self, [x, y]: [f64; 2], inside: f64) -> DVec3 {
        let Ellipse { sin_rim, cos_rim, sin_axis, cos_axis } = self.ellipse;
        // The cap bulges out of the plane of its rim: `1 - x^2 - y^2` is a sum of squares.
        let of_rim = cos_axis * cos_rim - sin_axis * sin_rim * x;
        let z = (sin_rim * sin_rim * inside + of_rim * of_rim).sqrt();
        let bitangent = self.normal.cross(self.tangent);
        let offset = self.tangent * (cos_axis * sin_rim * x) + bitangent * (sin_rim * y);
        renormalize(self.middle + offset + self.normal * z)
    }

    #[inline(always)]
    fn to_world(self, [x, y]: [f64; 2], z: f64) -> DVec3 {
        let bitangent = self.normal.cross(self.tangent);
        renormalize(self.tangent * x + bitangent * y + self.normal * z)
    }
}
