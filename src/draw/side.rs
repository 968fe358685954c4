//! Side views: orthographic projection onto a vertical plane.

use crate::math::{DVec2, DVec3};
use crate::sampling::sin_cos;

/// Maximum size of the drawing in pixels.
const LARGEST: DVec2 = DVec2::new(1000.0, 720.0);
/// Minimum height: a flat path needs space around it.
const LOWEST: f64 = 300.0;
const MARGIN: f64 = 48.0;
/// How far the middle of a label stays from the edges of the window.
const LABEL_EDGE: DVec2 = DVec2::new(50.0, 16.0);

/// A vertical plane and a window on it. Positions are pixels from the window's upper left corner.
#[derive(Clone, Debug)]
pub struct SideView {
    /// Unit vectors of the plane: right and up.
    right: DVec3,
    up: DVec3,
    /// The point in space at the center of the window.
    center: DVec3,
    /// Pixels per unit of length.
    pub scale: f64,
    /// Size of the window in pixels.
    pub window: DVec2,
}

impl SideView {
    /// Selects the plane through `up` on which the points spread most, and a window that contains
    /// them.
    pub fn of(points: &[DVec3], up: DVec3) -> Self {
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
            window: DVec2::new(LARGEST.x, (size.y * scale + 2.0 * MARGIN).max(LOWEST).round()),
        }
    }

    /// Projects a point to the drawing.
    pub fn project(&self, point: DVec3) -> DVec2 {
        0.5 * self.window + self.direction(point - self.center) * self.scale
    }

    /// Projects a direction to the drawing, whose y axis points down.
    pub fn direction(&self, direction: DVec3) -> DVec2 {
        DVec2::new(direction.dot(self.right), -direction.dot(self.up))
    }

    /// A length greater than the window's diagonal, in pixels.
    pub fn across(&self) -> f64 {
        self.window.x + self.window.y
    }

    /// Returns true if a circle is visible in the window.
    pub fn touches(&self, center: DVec2, radius: f64) -> bool {
        let nearest = center.clamp(DVec2::ZERO, self.window);
        (center - nearest).length() <= radius
    }

    /// Position of a circle's label: its center, or the part of the circle in view; above or below
    /// a small one.
    pub fn label_place(&self, center: DVec2, radius: f64) -> DVec2 {
        let inside = self.keep_in(center, 0.0);
        if radius < 12.0 {
            let above = inside.y - radius - 6.0;
            let y = if above < LABEL_EDGE.y { inside.y + radius + 16.0 } else { above };
            return DVec2::new(inside.x, y);
        }
        if (inside - center).length() < 0.98 * radius {
            return inside;
        }
        // The circle may miss the nearest corner of the window but reach its edge.
        let towards = (0.5 * self.window - center).normalize_or(DVec2::Y);
        self.keep_in(center + (radius - 14.0) * towards, 0.0)
    }

    /// Position of the label of a circle that the drawing looks at from inside, such as a wall of a
    /// room: behind the wall at the point `on_wall`.
    pub fn wall_label_place(&self, center: DVec2, on_wall: DVec2) -> DVec2 {
        on_wall + 22.0 * (on_wall - center).normalize_or(DVec2::Y) + DVec2::new(0.0, 4.0)
    }

    /// Moves the middle of a text that is `half` wide to either side into the window.
    pub fn keep_in(&self, position: DVec2, half: f64) -> DVec2 {
        let edge = LABEL_EDGE.max(DVec2::new(half + 4.0, 0.0)).min(0.5 * self.window);
        position.clamp(edge, self.window - edge.min(DVec2::new(f64::INFINITY, 10.0)))
    }

    /// A round length of about a tenth of the window's width.
    pub fn round_length(&self) -> f64 {
        let wanted = 0.12 * self.window.x / self.scale;
        let power = libm::exp10(libm::log10(wanted).floor());
        let steps = [5.0, 2.0, 1.0].map(|step| step * power);
        steps.into_iter().find(|length| *length <= wanted).unwrap_or(power)
    }
}

/// The horizontal unit vector along which the points spread most: the principal axis.
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
    // The angle of the principal axis of a 2 x 2 covariance matrix.
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
        let view = SideView::of(&points, DVec3::Y);
        assert!((view.right.dot(DVec3::new(0.6, 0.0, 0.8)).abs() - 1.0).abs() < 1e-3);
        for point in points {
            let p = view.project(point);
            assert!(p.cmpge(DVec2::ZERO).all() && p.cmple(view.window).all());
        }
        // Up in space is up in the drawing.
        assert!(view.project(points[1]).y < view.project(points[0]).y);
        let gap = view.project(points[2]) - view.project(points[0]);
        assert!((gap.x.abs() - 10.0 * view.scale).abs() < 0.1 * view.scale);
    }

    #[test]
    fn labels_stay_in_the_window_and_walls_have_theirs_behind_them() {
        let view = SideView::of(&[DVec3::ZERO, DVec3::new(6.0, 3.0, 0.0)], DVec3::Y);
        // A small lamp at the upper edge.
        let above = view.label_place(DVec2::new(300.0, 5.0), 4.0);
        assert!(above.y > 5.0 && above.y < 40.0, "{above}");
        let below = view.label_place(DVec2::new(300.0, 200.0), 4.0);
        assert!(below.y < 196.0, "{below}");
        // The wall on the left is an arc around a far point on the right.
        let on_wall = DVec2::new(90.0, 200.0);
        let label = view.wall_label_place(DVec2::new(5000.0, 200.0), on_wall);
        assert!(label.x < on_wall.x, "{label}");
        let moved = view.keep_in(DVec2::new(-30.0, 1e4), 80.0);
        assert!(moved.x == 84.0 && moved.y < view.window.y, "{moved}");
    }

    #[test]
    fn a_single_point_and_huge_circles_have_finite_numbers() {
        let view = SideView::of(&[DVec3::ONE], DVec3::Y);
        for radius in [1.0, 1e5, 1e12] {
            assert!(view.touches(0.5 * view.window + DVec2::new(0.0, radius), radius));
        }
        assert!(view.round_length().is_finite());
    }
}
