//! The equations of paths over a ball between two points outside of it.

use crate::geometry::Sphere;

use super::connection::Connection;
use super::deflection::{Deflection, Evaluation};
use super::phase::Phase;
use super::plane::{Plane, Target, are_outside};
use super::root::Branch;
use crate::math::DVec3;

/// The most values that `psi` may have to take.
pub(super) const MAX_TARGETS: usize = 3;
/// The most branches of `psi`.
pub(super) const MAX_BRANCHES: usize = 2;
/// The most roots: one per target and branch.
pub(super) const MAX_ROOTS: usize = MAX_TARGETS * MAX_BRANCHES;

/// The equation of a kind of paths, for a ball whose index of refraction over that of its
/// surroundings is `ior`.
pub(super) trait Equation {
    /// Returns the ratios of the angles at x and y, for these distances.
    fn ratios(distances: [f64; 2], ior: f64) -> [f64; 2];

    /// Returns the deflection with these ratios.
    fn deflection(ratios: [f64; 2], ior: f64) -> Deflection;

    /// Returns the half angle that the targets are made of.
    fn half_angle(cos_theta: f64, sin_theta: f64) -> Phase;

    /// Returns half of each target, negative; `None` if no branch reaches it.
    fn targets(half_angle: Phase, branches: &[Option<Branch>; 2]) -> [Option<Phase>; MAX_TARGETS];

    /// Returns the path of a root that `psi = target` has.
    fn connection(
        plane: &Plane,
        deflection: &Deflection,
        root: &Evaluation,
        target: usize,
    ) -> Connection;
}

/// Finds all paths between two points outside of a ball.
#[inline(always)]
pub(super) fn connect<E: Equation>(
    ball: &Sphere,
    ior: f64,
    (x, y): (DVec3, Target),
    mut found: impl FnMut(Connection),
) {
    let plane = Plane::new(*ball, x, y);
    if !are_outside(plane.distances) {
        return;
    }
    let deflection = E::deflection(E::ratios(plane.distances, ior), ior);
    let branches = deflection.branches();
    let half_angle = E::half_angle(plane.cos_theta, plane.sin_theta);
    for (target, half) in E::targets(half_angle, &branches).into_iter().enumerate() {
        let Some(half_target) = half else { continue };
        for branch in branches.iter().flatten() {
            if let Some(root) = deflection.root(branch, half_target) {
                found(E::connection(&plane, &deflection, &root, target));
            }
        }
    }
}

/// Returns the path of a root that was found already.
#[inline(always)]
pub(super) fn connection_of<E: Equation>(
    ball: &Sphere,
    ior: f64,
    (x, y): (DVec3, Target),
    (target, w): (usize, f64),
) -> Connection {
    let plane = Plane::new(*ball, x, y);
    let deflection = E::deflection(E::ratios(plane.distances, ior), ior);
    E::connection(&plane, &deflection, &deflection.eval(w), target)
}
