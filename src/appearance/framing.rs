//! Where a camera sees all spheres, as large as fits.
//!
//! For a given direction, the four sides of the picture are planes of known slope. Each sphere
//! pushes each plane outward; the outermost position of each plane gives the camera in closed form,
//! in one pass over the spheres.

use std::fmt;

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::math::DVec3;

/// The names of the axes.
const AXES: [&str; 3] = ["x", "y", "z"];

/// Direction in which the camera stands, seen from the spheres.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ViewDirection {
    /// This one, of any length but 0.
    Towards(DVec3),
    /// From an axis: its index, and true for its negative end.
    Axis(usize, bool),
    /// Degrees counterclockwise about the up direction, and degrees above the horizon. For z up,
    /// azimuth 0 is x, and 90 is y.
    Angles {
        /// Azimuth.
        azimuth: f64,
        /// Elevation.
        elevation: f64,
    },
}

/// How the picture projects space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Projection {
    /// With this vertical field of view in degrees.
    Perspective(f64),
    /// Parallel rays, with this height of the view.
    Orthographic(f64),
}

/// What the framing depends on besides the spheres.
#[derive(Clone, Copy, Debug)]
pub struct Framing {
    /// Where the camera stands.
    pub view: ViewDirection,
    /// The unit vector that points up.
    pub up: DVec3,
    /// Vertical field of view of a perspective, in degrees; `None` for parallel rays.
    pub vertical_fov_degrees: Option<f64>,
    /// Enlarges the picture about its centre.
    pub zoom: f64,
    /// Width of the picture divided by its height.
    pub aspect: f64,
    /// Shares of the width (left, right) and the height (top, bottom) that stay free.
    pub margins: [f64; 4],
}

/// A camera that sees all spheres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FramedCamera {
    /// Position.
    pub position: DVec3,
    /// The point in the middle of the picture, in the middle of the spheres' depth.
    pub look_at: DVec3,
    /// Up direction in the picture.
    pub up: DVec3,
    /// Projection.
    pub projection: Projection,
}

impl ViewDirection {
    /// Along a diagonal, as in isometric drawings.
    pub const ISO: Self = Self::Angles { azimuth: -45.0, elevation: 35.264_389_682_754_654 };

    /// Parses `iso`, an axis such as `x` or `-y`, or `AZIMUTH,ELEVATION`.
    pub fn parse(text: &str) -> Option<Self> {
        let (is_negative, axis) = match text.strip_prefix('-') {
            Some(rest) => (true, rest),
            None => (false, text.strip_prefix('+').unwrap_or(text)),
        };
        if text == "iso" {
            return Some(Self::ISO);
        }
        if let Some(index) = axis_named(axis) {
            return Some(Self::Axis(index, is_negative));
        }
        let (azimuth, elevation) = text.split_once(',')?;
        let number = |text: &str| text.trim().parse().ok().filter(|x: &f64| x.abs() <= 360.0);
        let (azimuth, elevation) = (number(azimuth)?, number(elevation)?);
        (elevation.abs() <= 90.0).then_some(Self::Angles { azimuth, elevation })
    }

    /// Unit vector from the spheres to the camera, for this unit vector that points up.
    pub fn towards(self, up: DVec3) -> DVec3 {
        self.axes(up).0
    }

    /// Unit vector from the spheres to the camera, and the up direction in the picture.
    fn axes(self, up: DVec3) -> (DVec3, DVec3) {
        let first = if up.z.abs() > 0.5 {
            DVec3::X
        } else if up.y.abs() > 0.5 {
            DVec3::Z
        } else {
            DVec3::Y
        };
        let first = (first - up * up.dot(first)).normalize();
        let second = up.cross(first);
        let towards = match self {
            Self::Towards(direction) => (direction / direction.abs().max_element()).normalize(),
            Self::Axis(axis, is_negative) => {
                DVec3::AXES[axis] * if is_negative { -1.0 } else { 1.0 }
            }
            Self::Angles { azimuth, elevation } => {
                let (sin_a, cos_a) = libm::sincos(azimuth.to_radians());
                let (sin_e, cos_e) = libm::sincos(elevation.to_radians());
                (first * cos_a + second * sin_a) * cos_e + up * sin_e
            }
        };
        let is_along_up = towards.dot(up).abs() > 1.0 - 1e-9;
        (towards, if is_along_up { second * towards.dot(up).signum() } else { up })
    }
}

/// As in the text that [`ViewDirection::parse`] reads; three numbers for any other direction.
impl fmt::Display for ViewDirection {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::ISO => f.write_str("iso"),
            Self::Axis(index, is_negative) => {
                let sign = if is_negative { "-" } else { "" };
                write!(f, "{sign}{}", AXES[index])
            }
            Self::Angles { azimuth, elevation } => write!(f, "{azimuth},{elevation}"),
            Self::Towards(DVec3 { x, y, z }) => write!(f, "[{x}, {y}, {z}]"),
        }
    }
}

/// Index of the axis with this name.
pub(super) fn axis_named(name: &str) -> Option<usize> {
    AXES.iter().position(|axis| *axis == name)
}

/// Parses the direction that points up: an axis, such as `z` or `-y`.
pub fn parse_up(text: &str) -> Option<DVec3> {
    match text.strip_prefix('-') {
        Some(axis) => axis_named(axis).map(|index| -DVec3::AXES[index]),
        None => axis_named(text).map(|index| DVec3::AXES[index]),
    }
}

/// Frames spheres, each a centre with a radius; `None` if there are none, or a number is not
/// finite.
pub fn frame(
    framing: &Framing,
    count: usize,
    sphere: impl Fn(usize) -> (DVec3, f64) + Sync,
) -> Option<FramedCamera> {
    let Framing { view, up, vertical_fov_degrees, zoom, aspect, margins } = *framing;
    let (towards, picture_up) = view.axes(up);
    let forward = -towards;
    let right = forward.cross(picture_up).normalize();
    let above = right.cross(forward);
    let orthographic = vertical_fov_degrees.is_none();
    let tan = vertical_fov_degrees.map_or(0.0, |fov| libm::tan(0.5 * fov.to_radians()));
    // Slopes of the left, right, bottom and top planes; parallel rays have planes without slope.
    let [left, right_margin, top, bottom] = margins.map(|share| 1.0 - 2.0 * share);
    let slopes = [aspect * left, aspect * right_margin, bottom, top].map(|x| x * tan);
    let lengths = slopes.map(|slope| (1.0 + slope * slope).sqrt());
    let nothing = [f64::INFINITY; 6];
    let merge = |a: [f64; 6], b: [f64; 6]| std::array::from_fn(|i| a[i].min(b[i]));
    let bounds = |row: usize| {
        let (center, radius) = sphere(row);
        let (x, y, w) = (center.dot(right), center.dot(above), center.dot(forward));
        let side = |sign: f64, across: f64, plane: usize| {
            sign * across + slopes[plane] * w - radius * lengths[plane]
        };
        [
            side(1.0, x, 0),
            side(-1.0, x, 1),
            side(1.0, y, 2),
            side(-1.0, y, 3),
            w - radius,
            -w - radius,
        ]
    };
    let all = (0..count).into_par_iter().map(bounds).reduce(|| nothing, merge);
    if !all.iter().all(|bound| bound.is_finite()) {
        return None;
    }
    let [near, far] = [all[4], -all[5]];
    let depth = 0.5 * (near + far);
    let camera = match orthographic {
        true => {
            let [width, height] = [-(all[0] + all[1]), -(all[2] + all[3])];
            let [x, y] = [0.5 * (all[0] - all[1]), 0.5 * (all[2] - all[3])];
            let shares = [1.0 - margins[0] - margins[1], 1.0 - margins[2] - margins[3]];
            let view_height = (height / shares[1]).max(width / shares[0] / aspect);
            // The free margins move the centre.
            let x = x + 0.5 * (margins[1] - margins[0]) * view_height * aspect;
            let y = y + 0.5 * (margins[2] - margins[3]) * view_height;
            let distance = (far - near) + view_height;
            let at = |w: f64| right * x + above * y + forward * w;
            FramedCamera {
                position: at(near - distance),
                look_at: at(depth),
                up: picture_up,
                projection: Projection::Orthographic(view_height / zoom),
            }
        }
        false => {
            let farthest = |a: usize, b: usize| (all[a] + all[b]) / (slopes[a] + slopes[b]);
            let w = farthest(0, 1).min(farthest(2, 3));
            let middle =
                |a: usize, b: usize| 0.5 * ((all[a] - slopes[a] * w) + (slopes[b] * w - all[b]));
            let at = |w: f64| right * middle(0, 1) + above * middle(2, 3) + forward * w;
            let fov = 2.0 * libm::atan(tan / zoom).to_degrees();
            FramedCamera {
                position: at(w),
                look_at: at(depth),
                up: picture_up,
                projection: Projection::Perspective(fov),
            }
        }
    };
    Some(camera)
}

#[cfg(test)]
mod tests {
    use super::*;

    const VIEWS: [&str; 8] = ["iso", "x", "-x", "-y", "z", "-z", "-60,25", "200,-80"];

    /// Spheres of very different sizes around a centre far from the origin.
    fn spheres() -> Vec<(DVec3, f64)> {
        let mut state = 7u64;
        let mut random = move || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (state >> 40) as f64 / (1u64 << 24) as f64
        };
        let center = DVec3::new(1e4, -300.0, 55.0);
        (0..500)
            .map(|_| {
                let p = DVec3::new(random(), random() * 0.3, random() * 2.0);
                (center + p * 10.0, 0.01 + random() * random())
            })
            .collect()
    }

    /// Each sphere's extent in the picture, from -1 to 1: left, right, bottom, top.
    fn extents(camera: &FramedCamera, aspect: f64) -> [f64; 4] {
        let forward = (camera.look_at - camera.position).normalize();
        let right = forward.cross(camera.up).normalize();
        let above = right.cross(forward);
        let mut found = [f64::INFINITY, -f64::INFINITY, f64::INFINITY, -f64::INFINITY];
        for (center, radius) in spheres() {
            let from = center - camera.position;
            let w = from.dot(forward);
            for (axis, across) in [right, above].into_iter().enumerate() {
                let x = from.dot(across);
                let (low, high) = match camera.projection {
                    Projection::Orthographic(height) => {
                        (2.0 * (x - radius) / height, 2.0 * (x + radius) / height)
                    }
                    Projection::Perspective(fov) => {
                        assert!(w > radius, "a sphere is around or behind the camera");
                        // Tangents from the camera to the circle in this plane.
                        let (angle, half) = ((x / w).atan(), (radius / x.hypot(w)).asin());
                        let tan = (0.5 * fov.to_radians()).tan();
                        ((angle - half).tan() / tan, (angle + half).tan() / tan)
                    }
                };
                let scale = if axis == 0 { aspect } else { 1.0 };
                found[2 * axis] = found[2 * axis].min(low / scale);
                found[2 * axis + 1] = found[2 * axis + 1].max(high / scale);
            }
        }
        found
    }

    #[test]
    fn all_spheres_are_inside_and_touch_two_opposite_margins() {
        let all = spheres();
        for view in VIEWS {
            for orthographic in [false, true] {
                for (aspect, margins) in [(4.0 / 3.0, [0.05; 4]), (0.5, [0.02, 0.2, 0.1, 0.0])] {
                    let framing = Framing {
                        view: ViewDirection::parse(view).unwrap(),
                        up: DVec3::Z,
                        vertical_fov_degrees: (!orthographic).then_some(30.0),
                        zoom: 1.0,
                        aspect,
                        margins,
                    };
                    let camera = frame(&framing, all.len(), |row| all[row]).unwrap();
                    let [left, right, bottom, top] = extents(&camera, aspect);
                    let free = [
                        left - (2.0 * margins[0] - 1.0),
                        1.0 - 2.0 * margins[1] - right,
                        bottom - (2.0 * margins[3] - 1.0),
                        1.0 - 2.0 * margins[2] - top,
                    ];
                    let case = format!("{view} {orthographic} {aspect}: {free:?}");
                    assert!(free.iter().all(|gap| *gap > -1e-6), "{case}");
                    let touches = |a: usize| free[a].abs() < 1e-6 && free[a + 1].abs() < 1e-6;
                    assert!(touches(0) || touches(2), "{case}");
                }
            }
        }
    }

    #[test]
    fn views_are_axes_or_angles() {
        let towards = |text: &str, up: DVec3| ViewDirection::parse(text).unwrap().axes(up);
        assert_eq!(towards("x", DVec3::Z), (DVec3::X, DVec3::Z));
        assert_eq!(towards("-y", DVec3::Z), (DVec3::NEG_Y, DVec3::Z));
        assert_eq!(towards("z", DVec3::Z), (DVec3::Z, DVec3::Y));
        let (direction, up) = towards("90,0", DVec3::Y);
        assert!((direction - DVec3::X).length() < 1e-12 && up == DVec3::Y);
        let (direction, _) = towards("0,90", DVec3::Z);
        assert!((direction - DVec3::Z).length() < 1e-12);
        let slanted = DVec3::new(0.6, 0.0, 0.8);
        for view in [ViewDirection::ISO, ViewDirection::Towards(DVec3::new(3e200, 0.0, 0.0))] {
            let (direction, _) = view.axes(slanted);
            assert!((direction.length() - 1.0).abs() < 1e-12, "{view:?}");
        }
        let (direction, _) = ViewDirection::ISO.axes(slanted);
        assert!((direction.dot(slanted) - (1.0f64 / 3.0).sqrt()).abs() < 1e-12);
        for wrong in ["", "w", "1", "1,2,3", "0,91", "a,b", "nan,0"] {
            assert_eq!(ViewDirection::parse(wrong), None, "{wrong}");
        }
        assert_eq!(parse_up("-y"), Some(DVec3::NEG_Y));
        assert_eq!(parse_up("up"), None);
    }

    #[test]
    fn zoom_narrows_the_view_and_nothing_has_no_frame() {
        let framing = Framing {
            view: ViewDirection::ISO,
            up: DVec3::Z,
            vertical_fov_degrees: None,
            zoom: 2.0,
            aspect: 1.0,
            margins: [0.0; 4],
        };
        let unit = |_| (DVec3::ZERO, 1.0);
        let camera = frame(&framing, 1, unit).unwrap();
        assert!(
            matches!(camera.projection, Projection::Orthographic(h) if (h - 1.0).abs() < 1e-12)
        );
        assert_eq!(frame(&framing, 0, unit), None);
        assert_eq!(frame(&framing, 1, |_| (DVec3::NAN, 1.0)), None);
    }
}
