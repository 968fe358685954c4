//! From the scene's space to the drawing's plane.

use crate::math::{DVec2, DVec3};
use crate::sampling::sin_cos;

use super::put;

/// The drawing's size in pixels, at most.
const LARGEST: DVec2 = DVec2::new(1000.0, 720.0);
/// The smallest height: a flat path needs room around it.
const LOWEST: f64 = 300.0;
const MARGIN: f64 = 48.0;

/// An upright plane, and the window on it.
pub(super) struct View {
    /// Unit vectors of the plane: to the right, and up.
    right: DVec3,
    up: DVec3,
    /// What is drawn in the window's centre.
    center: DVec3,
    /// Pixels per unit of length.
    pub(super) scale: f64,
    pub(super) width: f64,
    pub(super) height: f64,
}

impl View {
    /// The plane through `up` on which the points spread most, and a window that holds them all.
    pub(super) fn of(points: &[DVec3], up: DVec3) -> Self {
        let up = up.normalize_or(DVec3::Y);
        let right = widest(points, up);
        let flat = |p: &DVec3| DVec2::new(p.dot(right), p.dot(up));
        let (mut low, mut high) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
        for point in points.iter().map(flat) {
            (low, high) = (low.min(point), high.max(point));
        }
        let size = (high - low).max(DVec2::splat(1e-9 * (1.0 + high.abs().max_element())));
        let scale = ((LARGEST - 2.0 * MARGIN) / size).min_element();
        let middle = 0.5 * (low + high);
        Self {
            right,
            up,
            center: middle.x * right + middle.y * up,
            scale,
            width: LARGEST.x,
            height: (size.y * scale + 2.0 * MARGIN).max(LOWEST).round(),
        }
    }

    pub(super) fn project(&self, point: DVec3) -> DVec2 {
        let flat = self.direction(point - self.center) * self.scale;
        DVec2::new(0.5 * self.width, 0.5 * self.height) + flat
    }

    /// A direction on the drawing, whose y axis points down.
    pub(super) fn direction(&self, direction: DVec3) -> DVec2 {
        DVec2::new(direction.dot(self.right), -direction.dot(self.up))
    }

    /// Farther than from corner to corner.
    pub(super) fn across(&self) -> f64 {
        self.width + self.height
    }

    /// Whether a circle is to be seen in the window.
    pub(super) fn touches(&self, center: DVec2, radius: f64) -> bool {
        let window = DVec2::new(self.width, self.height);
        let nearest = center.clamp(DVec2::ZERO, window);
        (center - nearest).length() <= radius
    }

    /// Draws a sphere's outline. Programs that show SVG count in f32, so of a huge circle only the
    /// part in view is drawn, as a polygon.
    pub(super) fn circle(&self, svg: &mut String, class: &str, center: DVec2, radius: f64) {
        if radius < 20.0 * self.across() {
            put(
                svg,
                format_args!(
                    "<circle class=\"{class}\" cx=\"{:.2}\" cy=\"{:.2}\" r=\"{:.2}\"/>\n",
                    center.x,
                    center.y,
                    radius.max(1.0)
                ),
            );
            return;
        }
        let to_view = 0.5 * DVec2::new(self.width, self.height) - center;
        let outward = to_view.normalize_or(DVec2::Y);
        let tangent = DVec2::new(-outward.y, outward.x);
        let half = self.across();
        // Seen from the point of the circle nearest to the window, without large numbers.
        let nearest = 0.5 * DVec2::new(self.width, self.height)
            + outward * (radius - to_view.length()).clamp(-3.0 * half, 3.0 * half);
        let mut outline = String::new();
        for i in -32..=32 {
            let (sin, cos) = sin_cos(f64::from(i) / 32.0 * half / radius);
            let point = nearest + radius * sin * tangent + radius * (cos - 1.0) * outward;
            put(&mut outline, format_args!("{:.2},{:.2} ", point.x, point.y));
        }
        for side in [1.0, -1.0] {
            let point = nearest + side * half * tangent - 8.0 * half * outward;
            put(&mut outline, format_args!("{:.2},{:.2} ", point.x, point.y));
        }
        put(svg, format_args!("<polygon class=\"{class}\" points=\"{}\"/>\n", outline.trim_end()));
    }

    /// Where a sphere's name stands: at its centre, or at the part of it that is in view.
    pub(super) fn label_place(&self, center: DVec2, radius: f64) -> DVec2 {
        let window = DVec2::new(self.width, self.height);
        let inside = center.clamp(DVec2::new(50.0, 16.0), window - DVec2::new(50.0, 10.0));
        if (inside - center).length() < 0.98 * radius || radius < 12.0 {
            return inside
                + if radius < 12.0 { DVec2::new(0.0, -radius - 6.0) } else { DVec2::ZERO };
        }
        // The window's corner may miss the circle where its edge does not.
        let towards = (0.5 * window - center).normalize_or(DVec2::Y);
        let edge = center + (radius - 14.0) * towards;
        edge.clamp(DVec2::new(50.0, 16.0), window - DVec2::new(50.0, 10.0))
    }

    /// A round length that takes about a tenth of the width.
    pub(super) fn round_length(&self) -> f64 {
        let wanted = 0.12 * self.width / self.scale;
        let power = libm::exp10(libm::log10(wanted).floor());
        let steps = [5.0, 2.0, 1.0].map(|step| step * power);
        steps.into_iter().find(|length| *length <= wanted).unwrap_or(power)
    }
}

/// The horizontal unit direction along which the points spread most: the long axis of their scatter.
fn widest(points: &[DVec3], up: DVec3) -> DVec3 {
    let a = up.any_orthonormal_vector();
    let b = up.cross(a);
    let mean = points.iter().sum::<DVec3>() / points.len().max(1) as f64;
    let mut moments = [0.0; 3];
    for point in points {
        let (x, y) = ((*point - mean).dot(a), (*point - mean).dot(b));
        moments[0] += x * x;
        moments[1] += x * y;
        moments[2] += y * y;
    }
    // The angle of the principal axis of a 2 x 2 covariance.
    let angle = 0.5 * crate::sampling::atan2(2.0 * moments[1], moments[0] - moments[2]);
    let (sin, cos) = sin_cos(angle);
    cos * a + sin * b
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_plane_is_upright_and_the_window_holds_all_points() {
        let points = [DVec3::ZERO, DVec3::new(3.0, 1.0, 4.0), DVec3::new(6.0, 0.5, 8.0)];
        let view = View::of(&points, DVec3::Y);
        assert!((view.right.dot(DVec3::new(0.6, 0.0, 0.8)).abs() - 1.0).abs() < 1e-3);
        for point in points {
            let p = view.project(point);
            assert!((0.0..=view.width).contains(&p.x) && (0.0..=view.height).contains(&p.y));
        }
        // Up is up.
        assert!(view.project(points[1]).y < view.project(points[0]).y);
        let gap = view.project(points[2]) - view.project(points[0]);
        assert!((gap.x.abs() - 10.0 * view.scale).abs() < 0.1 * view.scale);
    }

    #[test]
    fn one_point_and_huge_spheres_are_drawn_with_finite_numbers() {
        let view = View::of(&[DVec3::ONE], DVec3::Y);
        let mut svg = String::new();
        for radius in [1.0, 1e5, 1e12] {
            let center = DVec2::new(0.5 * view.width, 0.5 * view.height + radius);
            view.circle(&mut svg, "met", center, radius);
            assert!(view.touches(center, radius));
        }
        assert!(!svg.contains("NaN") && !svg.contains("inf") && !svg.contains("e+"), "{svg}");
        assert!(view.round_length().is_finite());
    }
}
